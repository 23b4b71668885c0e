// What every subcommand shares: options, files, timings, progress, and the two ways to report (a table or
// JSON).
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <vkmesh/base/progress.h>
#include <vkmesh/base/result.h>
#include <vkmesh/io/mesh_io.h>
#include <vkmesh/io/svg.h>
#include <vkmesh/math/length.h>
#include <vkmesh/mesh/indexed_face_set.h>
#include <vkmesh/repair/consolidate.h>

namespace vkmesh::cli {

using Json = nlohmann::ordered_json;

/// Degrees in a radian.
inline constexpr double kDegrees = 180 / std::numbers::pi;

struct CommonOptions {
  std::string input;
  std::string output;
  std::string device = "auto";
  std::string progress = "auto";
  bool json = false;
  bool quiet = false;
  std::string on_loss = "note";
  ConsolidateOptions consolidation;
  bool keep_splits = false;
  bool planar = false;  // heights of points are not asked for
};

/// After this, interrupt and termination signals make interrupted() true, and a closed pipe is an ordinary
/// error. A step that has not looked within a second is ended with the program, which then says on standard
/// error, and with `json` on standard output, what it says of any interrupt.
void install_signal_handlers(bool json);
[[nodiscard]] bool interrupted();

/// While one lives that writes, the program is not ended in the middle of a step.
class WritingGuard {
 public:
  explicit WritingGuard(bool writes);
  ~WritingGuard();
  WritingGuard(const WritingGuard&) = delete;
  WritingGuard& operator=(const WritingGuard&) = delete;

 private:
  bool writes_;
};

/// The percentage line on standard error. On a terminal it overwrites and finally erases itself; elsewhere it
/// writes a line for each tenth done.
class ProgressLine {
 public:
  explicit ProgressLine(bool shown);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// The callback of a stage; it cancels when the program was interrupted.
  [[nodiscard]] Progress stage(std::string name);
  void erase();

 private:
  void draw(const std::string& name, int percent);

  bool shown_;
  bool terminal_;
  bool drawn_ = false;
  std::string last_name_;
  int last_percent_ = -1;
};

/// One run of a subcommand: does the steps that all share, and collects what is to be reported.
class Job {
 public:
  Job(std::string command, CommonOptions options);

  [[nodiscard]] const CommonOptions& options() const { return options_; }
  [[nodiscard]] Progress progress(std::string stage) { return progress_.stage(std::move(stage)); }

  /// Runs `step` and books its wall time under `name`. Cancels before it when the program was interrupted.
  template <class Step>
  auto timed(const char* name, Step&& step) -> decltype(step()) {
    if (interrupted()) return fail(ErrorCode::kInterrupted, "interrupted");
    const WritingGuard guard(std::string_view(name) == "write");
    const auto start = std::chrono::steady_clock::now();
    auto result = std::forward<Step>(step)();
    book(name, milliseconds_since(start));
    return result;
  }
  /// Adds to the time booked under one of the names in "timings_ms".
  void book(const char* name, double milliseconds);

  /// Reads the input, and reports its counts.
  [[nodiscard]] Result<IndexedFaceSet> read();
  /// Finds out whether the output can be written at all, before time is spent on it. No output given: no
  /// error.
  [[nodiscard]] Result<void> check_output();
  /// The same for a subcommand that draws, too: the output may be an SVG.
  [[nodiscard]] Result<void> check_output_or_picture();
  [[nodiscard]] bool draws() const { return draws_; }
  [[nodiscard]] FileFormat output_format() const { return write_options_.format; }
  /// Makes the mesh an oriented manifold, as the options of add_consolidate_options() say, and reports what
  /// was done. The half-edges are those of its faces.
  [[nodiscard]] Result<HalfEdgeMesh> consolidate(IndexedFaceSet& mesh);
  /// The same for work on a connected surface: points that the file repeats along seams are made one first,
  /// unless --keep-splits forbids it; write() repeats them again.
  [[nodiscard]] Result<HalfEdgeMesh> connect(IndexedFaceSet& mesh);
  /// The same, with the half-edges of the triangles into which polygons are cut; `mesh` keeps its polygons,
  /// unless their triangles need mending: then it becomes those. Begins as connect() does.
  [[nodiscard]] Result<HalfEdgeMesh> consolidate_triangles(IndexedFaceSet& mesh);
  /// Mends what cutting polygons left that is no oriented manifold; what was done is told beside the report.
  [[nodiscard]] Result<HalfEdgeMesh> consolidate_again(IndexedFaceSet& triangles);
  /// Writes the output, and reports its counts.
  [[nodiscard]] Result<void> write(const IndexedFaceSet& mesh, bool ascii = false);

  /// Writes the output as an SVG, and reports its counts.
  [[nodiscard]] Result<void> write(SvgPicture picture);
  /// Writes levels of detail, the finest first: into one glTF file, the output, or each into one of `files`.
  [[nodiscard]] Result<void> write_levels(std::vector<IndexedFaceSet> levels,
                                          const std::optional<LevelWriteOptions>& one_file,
                                          const std::vector<std::filesystem::path>& files);

  /// A sentence about something that was left out or not used.
  void note(std::string sentence) { notes_.push_back(std::move(sentence)); }
  /// Tells of the differences between a file and its mesh, as --on-loss says. Errors: kUnsuitable where it
  /// says that a loss fails the run.
  [[nodiscard]] Result<void> note_differences(const std::string& file, const std::vector<FileNote>& notes);
  /// The same of what the command itself does not keep of its input: the code is "dropped." and `what`.
  [[nodiscard]] Result<void> note_dropped(const std::string& what, std::string sentence) {
    return note_differences(options_.input, {{"dropped." + what, std::move(sentence)}});
  }
  /// What is to be added to the points of what was read.
  [[nodiscard]] const DVec3& offset() const { return offset_; }
  /// How all files of the run are read: relative to the first's offset.
  [[nodiscard]] ReadOptions read_options();
  /// A line of the table.
  void row(std::string label, std::string value) { rows_.emplace_back(std::move(label), std::move(value)); }
  /// The object that --json prints. Subcommands fill "device", "report" and "result".
  [[nodiscard]] Json& json() { return json_; }

  /// Prints the report to standard output, or to standard error when the mesh went to standard output.
  /// Errors: kNotWritable.
  [[nodiscard]] Result<void> print();
  /// Prints an error: the sentence on standard error, and the object with --json.
  void print_error(const Error& error);

 private:
  using Clock = std::chrono::steady_clock;
  static double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
  }

  /// Channels of corners for which the output has to repeat points.
  [[nodiscard]] std::vector<std::string> names_to_split(const IndexedFaceSet& mesh) const;

  CommonOptions options_;
  Clock::time_point start_ = Clock::now();
  WriteOptions write_options_;
  DVec3 offset_{0.0};
  std::vector<std::string> material_libraries_;
  std::vector<std::string>
      split_channels_;     ///< Belong to points in the file, to corners while it is worked on.
  bool has_read_ = false;  ///< The offset is settled.
  bool draws_ = false;     ///< The output is an SVG.
  std::vector<std::pair<std::string, std::string>> rows_;
  std::vector<std::string> notes_;
  Json json_;
  ProgressLine progress_;
};

/// Adds IN, and OUT when asked for, and the options that all subcommands have.
void add_common_options(CLI::App& command, CommonOptions& options, bool has_input, bool has_output);

/// Adds --weld, --strict and the like, for subcommands that consolidate what they read.
void add_consolidate_options(CLI::App& command, CommonOptions& options);

/// Adds --keep-splits, for subcommands that work on a connected surface.
void add_keep_splits(CLI::App& command, CommonOptions& options);

/// Finds out whether a file can be written there at all. "-" can. Errors: kNotWritable.
[[nodiscard]] Result<void> check_place(const std::string& file);

/// What NAME or NAME=WEIGHT says; errors name the option.
[[nodiscard]] Result<std::pair<std::string, double>> named_weight(const std::string& option,
                                                                  const std::string& text,
                                                                  double default_weight);

/// "1,2.5,-3" as so many numbers, separated by `separator`; errors name the option.
[[nodiscard]] Result<std::vector<double>> parse_numbers(const std::string& text, char separator,
                                                        std::size_t count, const std::string& option);

/// Turns a name into the value that it stands for, and refuses what is none of them.
template <class Enum>
[[nodiscard]] CLI::Validator one_of(const std::map<std::string, Enum>& values) {
  const auto transform = [values](std::string& text) {
    const auto found = values.find(text);
    if (found != values.end()) {
      text = std::to_string(static_cast<unsigned>(found->second));
      return std::string();
    }
    std::string names;
    for (const auto& [name, value] : values) names += (names.empty() ? "" : ", ") + name;
    return "'" + text + "' is none of " + names;
  };
  return CLI::Validator(transform, "");
}

/// What an option in units of the file says, or the one beside it in shares of the diagonal.
[[nodiscard]] std::optional<Length> length_of(const std::optional<double>& absolute,
                                              const std::optional<double>& relative);

/// For options: a number in [low, high], which "nan" is not; whole numbers of decimal digits, at most `high`
/// or in [low, high].
[[nodiscard]] CLI::Validator number_between(double low, double high);
[[nodiscard]] CLI::Validator count_up_to(std::uint64_t high);
[[nodiscard]] CLI::Validator count_between(std::uint64_t low, std::uint64_t high);

/// Prints an error that no Job stands for: the sentence on standard error, and the object on standard output.
void print_error(const Error& error, bool json);

/// 437645 as "437,645".
[[nodiscard]] std::string grouped(std::size_t n);
/// A number with few digits: "0.000312", "12.3", "1.2e-9".
[[nodiscard]] std::string brief(double x);
/// "1 face", "12 faces".
[[nodiscard]] std::string count_of(std::size_t n, const std::string& singular,
                                   const std::string& plural = {});

}  // namespace vkmesh::cli
