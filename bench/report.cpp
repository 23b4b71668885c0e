#include "bench/report.h"

#include <algorithm>
#include <array>
#include <cstdio>

namespace vkmesh::bench {
namespace {

template <class... Values>
std::string format(const char* pattern, Values... values) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), pattern, values...);
  return text.data();
}

using Cells = std::vector<std::string>;

/// The header, and a row of cells for each row; columns that no row fills are left out.
std::vector<Cells> table_of(const Report& report) {
  std::vector<Cells> table = {{"step", "by", "median ms", "min-max ms", "MB/s", "of meshoptimizer",
                               "peer takes", "mean error", "max error", "bytes a vertex",
                               "non-manifold edges", "vertices"}};
  for (const Row& row : report.rows) {
    const auto [least, most] = std::minmax_element(row.milliseconds.begin(), row.milliseconds.end());
    Cells cells(table[0].size());
    cells[0] = row.step;
    cells[1] = row.name;
    cells[2] = format("%.1f", row.median());
    cells[3] = format("%.1f-%.1f (%zu)", *least, *most, row.milliseconds.size());
    if (const auto rate = row.megabytes_per_second()) cells[4] = format("%.0f", *rate);
    if (const auto share = report.share_of_meshoptimizer(row)) cells[5] = format("%.2f x", *share);
    if (const auto speedup = report.speedup(row)) cells[6] = format("%.2f x", *speedup);
    if (row.quality) {
      cells[7] = format("%.3e", row.quality->mean);
      cells[8] = format("%.3e", row.quality->maximum);
      cells[10] = format("%zu", row.quality->non_manifold_edges);
      cells[11] = format("%zu", row.quality->non_manifold_vertices);
    }
    if (row.memory)
      cells[9] = format("%.0f", static_cast<double>(*row.memory) / static_cast<double>(report.vertices));
    table.push_back(std::move(cells));
  }
  for (std::size_t i = table[0].size(); i-- > 0;) {
    if (std::any_of(table.begin() + 1, table.end(), [&](const Cells& cells) { return !cells[i].empty(); }))
      continue;
    for (Cells& cells : table) cells.erase(cells.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return table;
}

bool has_step(const Report& report, const std::string& part) {
  return std::any_of(report.rows.begin(), report.rows.end(),
                     [&](const Row& row) { return row.step.find(part) != std::string::npos; });
}

std::vector<std::string> heading(const Report& report) {
  std::vector<std::string> lines = {
      format("%s: %zu vertices, %zu triangles", report.mesh.c_str(), report.vertices, report.faces),
      format("%s, %u cores, %s", report.machine.processor.c_str(), report.machine.cores,
             report.machine.system.c_str()),
      format("%s, %s build", report.machine.compiler.c_str(), report.machine.build_type.c_str())};
  std::string libraries;
  for (const Library& library : report.libraries)
    libraries += (libraries.empty() ? "" : "; ") + library.name + " " + library.version;
  lines.push_back(libraries);
  if (has_step(report, "decimation")) {
    lines.push_back(
        format("decimation: arrays to arrays, one thread unless said; errors are two-sided distances over "
               "%zu samples each "
               "way, over the bounding box's diagonal",
               report.samples));
    lines.push_back("memory that was freed stays with the process: no row waits to be given it again");
    lines.push_back(
        "bytes a vertex: what the process held at most in the first run beyond the input, the result "
        "included; "
        "of meshoptimizer: of the time of the first one");
    lines.push_back(
        "non-manifold edges: of more than two faces, or of two that run along it the same way; vertices: of "
        "several fans");
  }
  lines.push_back("the peer is OpenMesh, or the same kernels with built-ins");
  if (has_step(report, "read"))
    lines.push_back("reading: page cache warm; OpenMesh's reader also builds half-edges");
  return lines;
}

}  // namespace

double Row::median() const {
  std::vector<double> sorted = milliseconds;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t n = sorted.size();
  return n % 2 == 1 ? sorted[n / 2] : (sorted[n / 2 - 1] + sorted[n / 2]) / 2;
}

std::optional<double> Row::megabytes_per_second() const {
  if (bytes == 0) return std::nullopt;
  return static_cast<double>(bytes) / 1000 / median();
}

std::optional<double> Report::speedup(const Row& row) const {
  for (const Row& other : rows)
    if (other.step == row.step && (other.name == "OpenMesh" || other.name == kBuiltIns))
      return other.median() / row.median();
  return std::nullopt;
}

std::optional<double> Report::share_of_meshoptimizer(const Row& row) const {
  for (const Row& other : rows)
    if (other.step == row.step && other.name.starts_with("meshoptimizer"))
      return row.median() / other.median();
  return std::nullopt;
}

std::string to_text(const Report& report) {
  std::string text;
  for (const std::string& line : heading(report)) text += line + "\n";
  const std::vector<Cells> table = table_of(report);
  std::vector<std::size_t> width(table[0].size());
  for (const Cells& cells : table)
    for (std::size_t i = 0; i < cells.size(); ++i) width[i] = std::max(width[i], cells[i].size());
  for (const Cells& cells : table) {
    text += "\n";
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::string pad(width[i] - cells[i].size(), ' ');
      text += i < 2 ? cells[i] + pad + "  " : pad + cells[i] + "  ";
    }
  }
  return text + "\n";
}

std::string to_markdown(const Report& report) {
  std::string text;
  for (const std::string& line : heading(report)) text += "- " + line + "\n";
  const auto add_line = [&](const Cells& cells) {
    text += "|";
    for (const std::string& cell : cells) text += " " + cell + " |";
    text += "\n";
  };
  text += "\n";
  const std::vector<Cells> table = table_of(report);
  add_line(table[0]);
  text += "|---|---|";
  for (std::size_t i = 2; i < table[0].size(); ++i) text += "---:|";
  text += "\n";
  for (std::size_t i = 1; i < table.size(); ++i) add_line(table[i]);
  return text;
}

nlohmann::json to_json(const Report& report) {
  nlohmann::json json;
  json["mesh"] = {{"file", report.mesh}, {"vertices", report.vertices}, {"faces", report.faces}};
  json["machine"] = {{"processor", report.machine.processor},
                     {"cores", report.machine.cores},
                     {"system", report.machine.system},
                     {"compiler", report.machine.compiler},
                     {"build_type", report.machine.build_type}};
  for (const Library& library : report.libraries)
    json["libraries"].push_back({{"name", library.name}, {"version", library.version}});
  json["error_samples"] = report.samples;
  for (const Row& row : report.rows) {
    nlohmann::json entry = {{"step", row.step},
                            {"by", row.name},
                            {"median_ms", row.median()},
                            {"milliseconds", row.milliseconds}};
    const auto speedup = report.speedup(row);
    entry["peer_takes_times"] = speedup ? nlohmann::json(*speedup) : nlohmann::json();
    if (const auto rate = row.megabytes_per_second()) entry["megabytes_per_second"] = *rate;
    if (const auto share = report.share_of_meshoptimizer(row)) entry["of_meshoptimizer"] = *share;
    if (row.memory) entry["memory_bytes"] = *row.memory;
    if (row.quality)
      entry["result"] = {{"faces", row.quality->faces},
                         {"mean_error", row.quality->mean},
                         {"maximum_error", row.quality->maximum},
                         {"non_manifold_edges", row.quality->non_manifold_edges},
                         {"non_manifold_vertices", row.quality->non_manifold_vertices}};
    json["rows"].push_back(entry);
  }
  return json;
}

}  // namespace vkmesh::bench
