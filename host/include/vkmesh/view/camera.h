// Where a mesh is looked at from.
#pragma once

#include <cstdint>
#include <span>

#include <vkmesh/base/api.h>
#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>

namespace vkmesh {

enum class Projection { kPerspective, kOrthographic };

/// A camera. Lengths are in units of the mesh.
struct Camera {
  DVec3 eye{0, 0, 1};
  DVec3 target{0, 0, 0};
  DVec3 up{0, 1, 0};
  Projection projection = Projection::kPerspective;
  double field_of_view = 30;  ///< Degrees, from the lower to the upper edge of the picture. Perspective.
  double visible_height = 1;  ///< From the lower to the upper edge of the picture. Orthographic.
  double near = 0, far = 0;   ///< Distances along the view; nothing outside of them is seen.
};

/// The unit vectors of a camera.
struct CameraAxes {
  DVec3 right, up, forward;
};

/// Errors: kUsage where eye, target and up span no such axes.
[[nodiscard]] VKMESH_API Result<CameraAxes> axes_of(const Camera& camera);

enum class UpAxis { kY, kZ };

struct FramingOptions {
  /// Degrees around the up axis, to the right as seen from above; 0 looks along -z (up axis y) or +y (z).
  double azimuth = 30;
  double elevation = 20;  ///< Degrees above the horizon, -90 to 90.
  UpAxis up = UpAxis::kY;
  Projection projection = Projection::kPerspective;
  double field_of_view = 30;  ///< Degrees, in (0, 170).
  double margin = 0.05;       ///< Share of the picture that stays free on each side, in [0, 0.45].
};

/// The camera in the given direction that just sees all points in a picture of the given width to height.
/// Without points it looks at the unit sphere. O(points). Errors: kUsage for options outside their ranges.
[[nodiscard]] VKMESH_API Result<Camera> frame_camera(std::span<const Vec3> points, double width_to_height,
                                                     const FramingOptions& options = {});

/// Sets near and far of a camera so that all points before it are seen. O(points).
[[nodiscard]] VKMESH_API Result<void> fit_depth(Camera& camera, std::span<const Vec3> points);

}  // namespace vkmesh
