// Who takes part in the benchmark, and what each measurement needs.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <vkmesh/half_edge_mesh.h>
#include <vkmesh/indexed_face_set.h>
#include <vkmesh/result.h>
#include <vkmesh/vec.h>

namespace vkmesh::bench {

inline constexpr unsigned kSmoothingSteps = 10;

/// What all contestants are given: triangles, and nothing built from them.
struct Input {
  IndexedFaceSet mesh;
  std::size_t decimation_target = 0;  ///< Faces.
};

/// A decimated surface.
struct Surface {
  std::vector<Vec3> points;
  std::vector<std::uint32_t> corners;
};

/// One way to do one step.
struct Contestant {
  std::string step;  ///< Steps of the same name are compared.
  std::string name;
  /// Does the step once and returns the milliseconds that count; preparation is its own affair.
  std::function<Result<double>()> run;
  /// Decimation: what the last run made.
  std::function<Surface()> surface = {};
  /// Takes tens of seconds.
  bool slow = false;
};

/// A peer and its version, for the report.
struct Library {
  std::string name;
  std::string version;
};

struct Programme {
  std::vector<Contestant> contestants;
  std::vector<Library> libraries;
};

namespace step {
inline const std::string kConstruction = "half-edge construction";
inline const std::string kNeighbours = "neighbour lists";
inline const std::string kNormals = "vertex normals";
inline const std::string kSmoothing = "ten smoothing steps";
inline const std::string kUpload = "upload";
inline const std::string kDecimation = "decimation";
}  // namespace step

// Each adds its rows. `input` must outlive the programme.
Result<void> add_host(Programme& programme, const Input& input);
Result<void> add_device(Programme& programme, const Input& input, const std::string& device);
void add_openmesh(Programme& programme, const Input& input);
void add_meshoptimizer(Programme& programme, const Input& input);

/// Milliseconds since it was made.
class Stopwatch {
 public:
  [[nodiscard]] double milliseconds() const {
    return std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

}  // namespace vkmesh::bench
