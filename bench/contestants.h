// Who takes part in the benchmark, and what each measurement needs.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <vkmesh/base/result.h>
#include <vkmesh/math/vec.h>
#include <vkmesh/mesh/half_edge_mesh.h>
#include <vkmesh/mesh/indexed_face_set.h>

namespace vkmesh::bench {

inline constexpr unsigned kSmoothingSteps = 10;
/// The name of what the exact kernels are compared with.
inline const std::string kBuiltIns = "built-ins";

/// What all contestants are given: triangles, and nothing built from them.
struct Input {
  IndexedFaceSet mesh;
  IndexedFaceSet shuffled;     ///< The same with its points and faces in random order.
  std::vector<double> ratios;  ///< Shares of the faces that decimation leaves.
};

/// A decimated surface.
struct Surface {
  std::vector<Vec3> points;
  std::vector<std::uint32_t> corners;
};

/// One comparison of decimations.
struct DecimationCase {
  std::string step;
  const IndexedFaceSet& mesh;  ///< The input.
  bool shuffled = false;
  std::size_t target = 0;  ///< Faces.
};

/// Each ratio, of the mesh as it is and shuffled.
[[nodiscard]] std::vector<DecimationCase> decimation_cases(const Input& input);
/// The same points and faces in an order that `seed` gives, the same everywhere.
[[nodiscard]] IndexedFaceSet shuffled(const IndexedFaceSet& mesh, std::uint32_t seed);

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
  /// The size of the file that is read; 0 where none is.
  std::size_t bytes = 0;
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

/// The mesh of the benchmark as files, text and binary, in a folder that goes away with this.
class ReadingFiles {
 public:
  struct File {
    std::string step;
    std::filesystem::path path;
    std::size_t size = 0;
  };

  static Result<ReadingFiles> write(const IndexedFaceSet& mesh);
  ReadingFiles(ReadingFiles&& other) noexcept;
  ReadingFiles& operator=(ReadingFiles&&) = delete;
  ~ReadingFiles();

  [[nodiscard]] const std::vector<File>& all() const { return all_; }

 private:
  ReadingFiles() = default;

  std::filesystem::path folder_;
  std::vector<File> all_;
};

namespace step {
inline const std::string kReadAscii = "read ascii PLY";
inline const std::string kReadBinary = "read binary PLY";
inline const std::string kSoup = "soup to half-edges";
inline const std::string kConstruction = "half-edge construction";
inline const std::string kNeighbours = "neighbour lists";
inline const std::string kNormals = "vertex normals";
inline const std::string kSmoothing = "ten smoothing steps";
inline const std::string kUpload = "upload";
}  // namespace step

// Each adds its rows. `input` and `files` must outlive the programme.
void add_reading(Programme& programme, const ReadingFiles& files);
void add_soup(Programme& programme, const Input& input);
Result<void> add_host(Programme& programme, const Input& input);
Result<void> add_device(Programme& programme, const Input& input, const std::string& device);
Result<void> add_built_ins(Programme& programme, const Input& input, const std::string& device);
void add_host_built_ins(Programme& programme, const Input& input);
void add_openmesh(Programme& programme, const Input& input, const ReadingFiles& files);
void add_meshoptimizer(Programme& programme, const Input& input);

/// Adds one way to decimate, which fills the surface and returns the milliseconds that count.
void add_decimation(Programme& programme, const DecimationCase& wanted, const std::string& name,
                    std::function<Result<double>(Surface&)> run, bool slow = false);

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
