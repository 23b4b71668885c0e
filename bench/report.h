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

/// Two-sided distance from the original, as fractions of the diagonal of its bounding box.
struct DecimationError {
  std::size_t faces = 0;
  double mean = 0;
  double maximum = 0;
};

struct Row {
  std::string step;
  std::string name;
  std::vector<double> milliseconds;  ///< One for each repetition.
  std::optional<DecimationError> error;
  std::size_t bytes = 0;  ///< Of the file that is read; 0 where none is.

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
};

[[nodiscard]] std::string to_text(const Report& report);
[[nodiscard]] std::string to_markdown(const Report& report);
[[nodiscard]] nlohmann::json to_json(const Report& report);

}  // namespace vkmesh::bench
