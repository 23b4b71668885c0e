// What the benchmark measured, and the forms it is shown in.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/contestants.h"
#include "bench/machine.h"

namespace vkmesh::bench {

/// What a decimation has made.
struct DecimationQuality {
  std::size_t faces = 0;
  /// Two-sided distance from the original, as fractions of the diagonal of its bounding box.
  double mean = 0, maximum = 0;
  std::size_t non_manifold_edges = 0;  ///< With more than two faces, or two that run the same way.
  std::size_t non_manifold_vertices = 0;
};

struct Row {
  std::string step;
  std::string name;
  std::vector<double> milliseconds;   ///< One for each repetition.
  std::optional<std::size_t> memory;  ///< Bytes allocated at most at once, the result among them.
  std::optional<DecimationQuality> quality;
  std::size_t bytes = 0;  ///< Size of the file that is read; 0 where none is.

  [[nodiscard]] double median() const;
  /// 10^6 bytes a second; unset where no file is read.
  [[nodiscard]] std::optional<double> megabytes_per_second() const;
};

struct Report {
  std::string mesh;
  std::size_t vertices = 0;
  std::size_t faces = 0;
  std::size_t samples = 0;
  Machine machine;
  std::vector<Library> libraries;
  std::vector<Row> rows;  ///< Those of one step stand together.

  /// How many times as long as this row the peer, OpenMesh or built-ins, takes for the same step; unset
  /// without one.
  [[nodiscard]] std::optional<double> speedup(const Row& row) const;
  /// The time of a decimation as a share of that of the first meshoptimizer for the same step.
  [[nodiscard]] std::optional<double> share_of_meshoptimizer(const Row& row) const;
};

[[nodiscard]] std::string to_text(const Report& report);
[[nodiscard]] std::string to_markdown(const Report& report);
[[nodiscard]] nlohmann::json to_json(const Report& report);

}  // namespace vkmesh::bench
