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

using Cells = std::array<std::string, 8>;

const Cells kHeader = {"step", "by",         "median ms",  "min-max ms",
                       "MB/s", "peer takes", "mean error", "max error"};

std::vector<Cells> cells_of(const Report& report) {
  std::vector<Cells> all;
  for (const Row& row : report.rows) {
    const auto [least, most] = std::minmax_element(row.milliseconds.begin(), row.milliseconds.end());
    Cells cells;
    cells[0] = row.step;
    cells[1] = row.name;
    cells[2] = format("%.1f", row.median());
    cells[3] = format("%.1f-%.1f (%zu)", *least, *most, row.milliseconds.size());
    if (const auto rate = row.megabytes_per_second()) cells[4] = format("%.0f", *rate);
    if (const auto speedup = report.speedup(row)) cells[5] = format("%.2f x", *speedup);
    if (row.error) {
      cells[6] = format("%.3e", row.error->mean);
      cells[7] = format("%.3e", row.error->maximum);
    }
    all.push_back(cells);
  }
  return all;
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
  lines.push_back(
      format("errors: two-sided distance over %zu samples each way, over the bounding box's diagonal",
             report.samples));
  lines.push_back("the peer is OpenMesh, or the same kernels with built-ins");
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

std::string to_text(const Report& report) {
  std::string text;
  for (const std::string& line : heading(report)) text += line + "\n";
  std::vector<Cells> table = cells_of(report);
  table.insert(table.begin(), kHeader);
  std::array<std::size_t, kHeader.size()> width{};
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
  add_line(kHeader);
  text += "|---|---|---:|---:|---:|---:|---:|---:|\n";
  for (const Cells& cells : cells_of(report)) add_line(cells);
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
    if (row.error)
      entry["error"] = {
          {"faces", row.error->faces}, {"mean", row.error->mean}, {"maximum", row.error->maximum}};
    json["rows"].push_back(entry);
  }
  return json;
}

}  // namespace vkmesh::bench
