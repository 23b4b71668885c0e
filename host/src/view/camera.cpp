#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>

#include <vkmesh/view/camera.h>

namespace vkmesh {
namespace {

using glm::cross;
using glm::dot;
using glm::length;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Extremes of the points along an axis, tilted by `slope` against the view: with 0 plain coordinates, with
/// the tangent of half the field of view those of the planes through the picture's edges.
struct Extent {
  double low = kInfinity, high = -kInfinity;
  void add(double x, double depth, double slope) {
    high = std::max(high, x - slope * depth);
    low = std::min(low, x + slope * depth);
  }
};

}  // namespace

Result<CameraAxes> axes_of(const Camera& camera) {
  const DVec3 view = camera.target - camera.eye;
  const double distance = length(view);
  if (!(distance > 0.0) || !std::isfinite(distance))
    return fail(ErrorCode::kUsage, "the camera stands where it looks at");
  const DVec3 forward = view / distance;
  const DVec3 right = cross(forward, camera.up);
  const double size = length(right);
  if (!(size > 1e-9 * length(camera.up)) || !std::isfinite(size))
    return fail(ErrorCode::kUsage, "the camera's up axis points along its view");
  return CameraAxes{right / size, cross(right / size, forward), forward};
}

Result<Camera> frame_camera(std::span<const Vec3> points, double width_to_height,
                            const FramingOptions& options) {
  if (!(options.field_of_view > 0.0) || !(options.field_of_view < 170.0))
    return fail(ErrorCode::kUsage, "a field of view lies between 0 and 170 degrees");
  if (!(options.elevation >= -90.0) || !(options.elevation <= 90.0) || !std::isfinite(options.azimuth))
    return fail(ErrorCode::kUsage, "an elevation lies between -90 and 90 degrees");
  if (!(options.margin >= 0.0) || !(options.margin <= 0.45) || !(width_to_height > 0.0))
    return fail(ErrorCode::kUsage, "a margin lies between 0 and 0.45, and a picture has width and height");

  const double azimuth = options.azimuth * std::numbers::pi / 180.0;
  const double elevation = options.elevation * std::numbers::pi / 180.0;
  const double s = std::sin(azimuth), c = std::cos(azimuth), se = std::sin(elevation),
               ce = std::cos(elevation);
  const bool y_up = options.up == UpAxis::kY;
  const DVec3 forward = y_up ? DVec3(-s * ce, -se, -c * ce) : DVec3(-s * ce, c * ce, -se);
  // From azimuth alone, so that looking straight down has a right side as well.
  const DVec3 right = y_up ? DVec3(c, 0, -s) : DVec3(c, s, 0);
  const DVec3 up = cross(right, forward);

  Extent x, y, plain_x, plain_y, depth;
  const double inside = 1.0 - 2.0 * options.margin;
  const double slope_y = std::tan(options.field_of_view * std::numbers::pi / 360.0) * inside;
  const double slope_x = slope_y * width_to_height;
  const auto add = [&](const DVec3& p) {
    const double along = dot(p, forward);
    const double px = dot(p, right), py = dot(p, up);
    x.add(px, along, slope_x);
    y.add(py, along, slope_y);
    plain_x.add(px, 0, 0);
    plain_y.add(py, 0, 0);
    depth.add(along, 0, 0);
  };
  for (const Vec3& p : points) add(DVec3(p));
  if (points.empty())
    for (const double corner : {-1.0, 1.0})
      for (const DVec3& p : {DVec3(corner, 0, 0), DVec3(0, corner, 0), DVec3(0, 0, corner)}) add(p);

  // A single point, or a flat one seen from its edge, is given some room.
  const double size = std::max({plain_x.high - plain_x.low, plain_y.high - plain_y.low,
                                depth.high - depth.low, std::abs(depth.high) * 1e-6, 1e-12});
  Camera camera;
  camera.up = up;
  camera.projection = options.projection;
  camera.field_of_view = options.field_of_view;
  camera.visible_height =
      std::max({plain_y.high - plain_y.low, (plain_x.high - plain_x.low) / width_to_height, 0.01 * size}) /
      inside;
  double distance = 2.0 * size;
  double center_x = (plain_x.low + plain_x.high) / 2, center_y = (plain_y.low + plain_y.high) / 2;
  const double middle = (depth.low + depth.high) / 2;
  if (options.projection == Projection::kPerspective) {
    // All points lie between the edges' planes where |p - center| <= slope * (depth - eye).
    center_x = (x.low + x.high) / 2;
    center_y = (y.low + y.high) / 2;
    const double eye = -std::max((x.high - x.low) / (2 * slope_x), (y.high - y.low) / (2 * slope_y));
    distance = std::max(middle - eye, 0.02 * size / slope_y);
  }
  camera.target = center_x * right + center_y * up + middle * forward;
  camera.eye = camera.target - distance * forward;
  VKMESH_CHECK(fit_depth(camera, points));
  return camera;
}

Result<void> fit_depth(Camera& camera, std::span<const Vec3> points) {
  VKMESH_TRY(const CameraAxes axes, axes_of(camera));
  Extent depth;
  for (const Vec3& p : points) depth.add(dot(DVec3(p) - camera.eye, axes.forward), 0, 0);
  const double distance = length(camera.target - camera.eye);
  if (points.empty()) depth = {0.0, 2 * distance};
  const double size = std::max(depth.high - depth.low, 1e-6 * distance);
  camera.far = std::max(depth.high, 0.0) + 0.01 * size;
  camera.near = depth.low - 0.01 * size;
  if (camera.projection == Projection::kPerspective) camera.near = std::max(camera.near, camera.far * 1e-4);
  return {};
}

}  // namespace vkmesh
