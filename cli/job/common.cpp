#include "job/common.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <optional>
#include <system_error>

#include <unistd.h>

#include <vkmesh/mesh/triangulate.h>

namespace vkmesh::cli {
namespace {

namespace fs = std::filesystem;

volatile std::sig_atomic_t g_interrupted = 0, g_writing = 0;
/// What is said on standard error and on standard output by a program that is ended where it is.
std::string g_last_words, g_last_object;
/// Seconds that a step may go on without looking at the flag.
constexpr unsigned kSecondsToHear = 1;

extern "C" void on_signal(int) {
  g_interrupted = 1;
  alarm(kSecondsToHear);
}

extern "C" void on_alarm(int) {
  if (g_writing != 0) {
    alarm(kSecondsToHear);  // what is half written has to go first
    return;
  }
  for (const auto& [stream, text] :
       {std::pair(STDERR_FILENO, &g_last_words), {STDOUT_FILENO, &g_last_object}})
    if (::write(stream, text->data(), text->size()) < 0) break;
  _exit(static_cast<int>(ErrorCode::kInterrupted));
}

constexpr const char* kTimings[] = {"read",    "consolidate", "open",  "upload", "device",
                                    "compute", "download",    "write", "total"};

/// Writes all of `text` and flushes, so that a full disk or a closed pipe is noticed.
Result<void> put(std::FILE* stream, const std::string& text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stream) != text.size() || std::fflush(stream) != 0)
    return fail(ErrorCode::kNotWritable, std::strerror(errno), {"standard output", {}, {}});
  return {};
}

/// nlohmann::json throws for bytes that are no UTF-8, which file names may hold: those become U+FFFD.
std::string text_of(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string milliseconds(double ms) {
  char text[32];
  std::snprintf(text, sizeof text, ms < 10 ? "%.1f ms" : "%.0f ms", ms);
  return text;
}

std::string sentence_of(const Error& error) {
  return "vkmesh: " + error.describe() + "\n";
}

Json object_of(const Error& error) {
  const auto or_null = [](const std::optional<std::uint64_t>& n) { return n ? Json(*n) : Json(nullptr); };
  return {{"error",
           {{"code", static_cast<int>(error.code)},
            {"message", error.message},
            {"file", error.where.file.empty() ? Json(nullptr) : Json(error.where.file)},
            {"line", or_null(error.where.line)},
            {"byte", or_null(error.where.byte)}}}};
}

Json names_of(const std::vector<Channel>& channels) {
  Json names = Json::array();
  for (const Channel& channel : channels) names.push_back(channel.name);
  return names;
}

/// Counts and attributes, the same for what was read and what was written.
Json counts_of(const IndexedFaceSet& mesh, const std::string& file, FileFormat format, FileEncoding encoding,
               bool gzip) {
  return {{"file", file},
          {"format", name_of(format)},
          {"encoding", name_of(encoding)},
          {"gzip", gzip},
          {"points", mesh.points.size()},
          {"faces", mesh.face_count()},
          {"corners", mesh.corners.size()},
          {"point_attributes", names_of(mesh.point_channels)},
          {"corner_attributes", names_of(mesh.corner_channels)},
          {"face_attributes", names_of(mesh.face_channels)}};
}

/// What consolidation found and did, as "report" holds it.
Json to_json(const ConsolidateReport& report) {
  return {{"points", report.points},
          {"faces", report.faces},
          {"edges", report.edges},
          {"boundary_edges", report.boundary_edges},
          {"isolated_points", report.isolated_points},
          {"degenerate_faces", report.degenerate_faces},
          {"non_manifold_edges", report.non_manifold_edges},
          {"misoriented_edges", report.misoriented_edges},
          {"non_manifold_vertices", report.non_manifold_vertices},
          {"manifold", report.manifold()},
          {"welded_points", report.welded_points},
          {"largest_weld_move", report.largest_weld_move},
          {"weld_seams", report.weld_seams},
          {"removed_degenerate_faces", report.removed_degenerate_faces},
          {"removed_duplicate_faces", report.removed_duplicate_faces},
          {"repaired_polygons", report.repaired_polygons},
          {"removed_points", report.removed_points},
          {"split_edges", report.split_edges},
          {"split_points", report.split_points},
          {"added_points", report.added_points},
          {"flipped_faces", report.flipped_faces},
          {"cut_components", report.cut_components},
          {"cut_edges", report.cut_edges}};
}

std::string file_row(const IndexedFaceSet& mesh, const std::string& file, FileFormat format,
                     FileEncoding encoding, bool gzip) {
  std::string kind = name_of(format);
  if (format == FileFormat::kPly || format == FileFormat::kStl)
    kind += encoding == FileEncoding::kAscii ? ", ascii" : ", binary";
  if (gzip) kind += ", gzip";
  return file + "  (" + count_of(mesh.points.size(), "point") + ", " + count_of(mesh.face_count(), "face") +
         "; " + kind + ")";
}

}  // namespace

void install_signal_handlers(bool json) {
  const Error interrupt{ErrorCode::kInterrupted, "interrupted", {}};
  g_last_words = (isatty(STDERR_FILENO) != 0 ? "\r\x1b[K" : "") + sentence_of(interrupt);
  if (json) g_last_object = text_of(object_of(interrupt));
  struct sigaction action = {};
  action.sa_handler = on_signal;
  // A second signal ends a program that does not get to look at the flag; without SA_RESTART reads return.
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGALRM, on_alarm);
  // A closed pipe and a limit on the size of files then fail the write, which says so.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

bool interrupted() {
  return g_interrupted != 0;
}

WritingGuard::WritingGuard(bool writes) : writes_(writes) {
  if (writes_) g_writing = 1;
}

WritingGuard::~WritingGuard() {
  if (writes_) g_writing = 0;
}

ProgressLine::ProgressLine(bool shown) : shown_(shown), terminal_(isatty(STDERR_FILENO) != 0) {}

ProgressLine::~ProgressLine() {
  erase();
}

Progress ProgressLine::stage(std::string name) {
  return [this, name = std::move(name)](double fraction) {
    if (shown_) draw(name, static_cast<int>(fraction * 100.0));
    return !interrupted();
  };
}

void ProgressLine::draw(const std::string& name, int percent) {
  if (!terminal_) percent = percent / 10 * 10;
  if (name == last_name_ && percent == last_percent_) return;
  last_name_ = name;
  last_percent_ = percent;
  std::fprintf(stderr, terminal_ ? "\r\x1b[K%s %d %%" : "%s %d %%\n", name.c_str(), percent);
  std::fflush(stderr);
  drawn_ = true;
}

void ProgressLine::erase() {
  if (drawn_ && terminal_) {
    std::fputs("\r\x1b[K", stderr);
    std::fflush(stderr);
  }
  drawn_ = false;
}

Job::Job(std::string command, CommonOptions options)
    : options_(std::move(options)),
      json_({{"command", std::move(command)},
             {"version", VKMESH_VERSION},
             {"device", nullptr},
             {"input", nullptr},
             {"output", nullptr},
             {"report", nullptr},
             {"timings_ms", Json::object()},
             {"result", Json::object()},
             {"notes", Json::array()},
             {"losses", Json::array()}}),
      progress_(options_.progress == "always" ||
                (options_.progress == "auto" && !options_.quiet && isatty(STDERR_FILENO) != 0)) {
  for (const char* name : kTimings) json_["timings_ms"][name] = nullptr;
}

void Job::book(const char* name, double ms) {
  Json& entry = json_["timings_ms"][name];
  entry = (entry.is_null() ? 0.0 : entry.get<double>()) + ms;
}

Result<IndexedFaceSet> Job::read() {
  return timed("read", [&]() -> Result<IndexedFaceSet> {
    VKMESH_TRY(MeshFile file, read_mesh(options_.input, read_options()));
    has_read_ = true;
    offset_ = file.offset;
    material_libraries_ = file.material_libraries;
    const FileFormat format = file.format;
    const FileEncoding encoding = file.encoding;
    const bool gzip = file.gzip;
    VKMESH_CHECK(note_differences(options_.input, file.notes));
    VKMESH_TRY(IndexedFaceSet mesh, to_indexed_face_set(std::move(file)));
    json_["input"] = counts_of(mesh, options_.input, format, encoding, gzip);
    row("input", file_row(mesh, options_.input, format, encoding, gzip));
    return mesh;
  });
}

ReadOptions Job::read_options() {
  return {progress("reading"), offset_, !has_read_, options_.planar};
}

Result<void> Job::note_differences(const std::string& file, const std::vector<FileNote>& notes) {
  for (const FileNote& difference : notes) {
    json_["losses"].push_back({{"file", file}, {"code", difference.code}, {"sentence", difference.sentence}});
    if (difference.is_loss() && options_.on_loss == "fail")
      return fail(ErrorCode::kUnsuitable,
                  difference.sentence + " (" + difference.code + "; --on-loss note goes on)", {file, {}, {}});
    if (!difference.is_loss() || options_.on_loss == "note") note(file + ": " + difference.sentence);
  }
  return {};
}

Result<void> Job::check_output() {
  if (options_.output.empty()) return {};
  VKMESH_TRY(write_options_, write_options_for(options_.output));
  write_options_.comment = "made by vkmesh " VKMESH_VERSION;
  return check_place(options_.output);
}

Result<void> Job::check_output_or_picture() {
  draws_ = fs::path(options_.output).extension() == ".svg";
  return draws_ ? check_place(options_.output) : check_output();
}

Result<void> check_place(const std::string& file) {
  if (file == "-") return {};
  const fs::path path = file;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code error;
  if (fs::is_directory(path, error)) return fail(ErrorCode::kNotWritable, "is a directory", {file, {}, {}});
  if (!fs::is_directory(folder, error))
    return fail(ErrorCode::kNotWritable, "the folder " + folder.string() + " does not exist", {file, {}, {}});
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    return fail(ErrorCode::kNotWritable, "the folder " + folder.string() + ": " + std::strerror(errno),
                {file, {}, {}});
  return {};
}

Result<HalfEdgeMesh> Job::consolidate(IndexedFaceSet& mesh) {
  return timed("consolidate", [&]() -> Result<HalfEdgeMesh> {
    auto result = vkmesh::consolidate(std::move(mesh), options_.consolidation, progress("consolidating"));
    if (!result) {
      if (result.error().where.file.empty()) result.error().where.file = options_.input;
      return tl::unexpected<Error>(std::move(result.error()));
    }
    json_["report"] = to_json(result->report);
    if (!options_.consolidation.weld) split_channels_ = result->report.weld_seams;
    for (std::string& sentence : result->report.repairs()) row("repaired", std::move(sentence));
    mesh = std::move(result->face_set);
    return std::move(result->mesh);
  });
}

Result<HalfEdgeMesh> Job::connect(IndexedFaceSet& mesh) {
  options_.consolidation.weld_boundary = !options_.keep_splits;
  return consolidate(mesh);
}

Result<HalfEdgeMesh> Job::consolidate_triangles(IndexedFaceSet& mesh) {
  VKMESH_TRY(HalfEdgeMesh half_edges, connect(mesh));
  if (mesh.is_triangles()) return half_edges;
  return timed("consolidate", [&]() -> Result<HalfEdgeMesh> {
    VKMESH_TRY(Triangulated cut, triangulate(mesh));
    auto triangles = to_half_edge_mesh(cut.mesh);
    if (triangles) return triangles;
    mesh = std::move(cut.mesh);
    note("the polygons share diagonals, so that they were cut into triangles and those repaired");
    return consolidate_again(mesh);
  });
}

Result<HalfEdgeMesh> Job::consolidate_again(IndexedFaceSet& triangles) {
  auto sound = to_half_edge_mesh(triangles);
  if (sound) return sound;
  ConsolidateOptions mending = options_.consolidation;
  mending.weld.reset();
  mending.weld_boundary = false;
  auto result = vkmesh::consolidate(std::move(triangles), mending, progress("consolidating"));
  if (!result) {
    result.error().where.file = options_.input;
    result.error().message = "cut into triangles, the polygons are " + result.error().message;
    return tl::unexpected<Error>(std::move(result.error()));
  }
  for (std::string& sentence : result->report.repairs()) row("repaired", "triangles: " + sentence);
  triangles = std::move(result->face_set);
  return std::move(result->mesh);
}

std::vector<std::string> Job::names_to_split(const IndexedFaceSet& mesh) const {
  const FileFormat format = write_options_.format;
  if (format == FileFormat::kObj || format == FileFormat::kInventor || format == FileFormat::kVrml1 ||
      format == FileFormat::kVrml2)
    return {};  // they have attributes of corners
  std::vector<std::string> names = split_channels_;
  // So that what is reported of the output counts the vertices of its buffers.
  if (format == FileFormat::kGltf) names.insert(names.end(), {"normal", "uv", "color"});
  std::erase_if(names,
                [&](const std::string& name) { return find_channel(mesh.corner_channels, name) == nullptr; });
  return names;
}

Result<void> Job::write(const IndexedFaceSet& mesh, bool ascii) {
  if (const std::vector<std::string> names = names_to_split(mesh); !names.empty()) {
    split_channels_ = {};
    VKMESH_TRY(const IndexedFaceSet split, timed("write", [&] { return split_at_seams(mesh, names); }));
    return write(split, ascii);
  }
  if (ascii) write_options_.encoding = FileEncoding::kAscii;
  write_options_.offset = offset_;
  write_options_.material_libraries = material_libraries_;
  if (options_.on_loss == "fail") {
    // Nothing is written where something would be lost.
    VKMESH_CHECK(timed("write", [&]() -> Result<void> {
      VKMESH_TRY(const std::vector<FileNote> losses, losses_of(mesh, write_options_));
      return note_differences(options_.output, losses);
    }));
  }
  VKMESH_TRY(const std::vector<FileNote> differences,
             timed("write", [&] { return write_mesh(options_.output, mesh, write_options_); }));
  VKMESH_CHECK(note_differences(options_.output, differences));
  const auto& w = write_options_;
  json_["output"] = counts_of(mesh, options_.output, w.format, w.encoding, w.gzip);
  row("output", file_row(mesh, options_.output, w.format, w.encoding, w.gzip));
  return {};
}

Result<void> Job::write(SvgPicture picture) {
  picture.offset = {offset_.x, offset_.y};
  picture.comment = "made by vkmesh " VKMESH_VERSION;
  VKMESH_CHECK(timed("write", [&] { return write_svg(options_.output, picture); }));
  const std::size_t faces =
      picture.face_offsets.empty() ? picture.corners.size() / 3 : picture.face_offsets.size() - 1;
  json_["output"] = {{"file", options_.output},           {"format", "svg"},
                     {"points", picture.points.size()},   {"faces", faces},
                     {"corners", picture.corners.size()}, {"circles", picture.circles.size()},
                     {"dots", picture.dots.size()}};
  row("output", options_.output + "  (" + count_of(picture.points.size(), "point") + ", " +
                    count_of(faces, "face") + "; svg)");
  return {};
}

Result<void> Job::write_levels(std::vector<IndexedFaceSet> levels,
                               const std::optional<LevelWriteOptions>& one_file,
                               const std::vector<std::filesystem::path>& files) {
  write_options_.offset = offset_;
  write_options_.material_libraries = material_libraries_;
  std::optional<LevelWriteOptions> level_options = one_file;
  std::vector<std::string> names = names_to_split(levels.front());
  // The writer of levels splits what glTF has names for itself, so that levels share vertices.
  if (one_file)
    std::erase_if(names, [](const std::string& n) { return n == "normal" || n == "uv" || n == "color"; });
  if (!names.empty()) {
    if (level_options) level_options->shared_points = false;
    for (IndexedFaceSet& level : levels) {
      VKMESH_TRY(level, timed("write", [&] { return split_at_seams(std::move(level), names); }));
    }
  }
  const auto write = [&](bool for_the_notes) -> Result<std::vector<FileNote>> {
    return timed("write", [&]() -> Result<std::vector<FileNote>> {
      const fs::path nowhere = "/dev/null";
      if (level_options)
        return vkmesh::write_levels(for_the_notes ? nowhere : fs::path(options_.output), levels,
                                    *level_options, write_options_);
      return write_meshes(for_the_notes ? std::vector<fs::path>(files.size(), nowhere) : files, levels,
                          write_options_);
    });
  };
  if (options_.on_loss == "fail") {
    VKMESH_TRY(const std::vector<FileNote> losses, write(true));
    VKMESH_CHECK(note_differences(options_.output, losses));
  }
  VKMESH_TRY(const std::vector<FileNote> differences, write(false));
  VKMESH_CHECK(note_differences(options_.output, differences));
  const auto& w = write_options_;
  const std::vector<fs::path> written = one_file ? std::vector<fs::path>{options_.output} : files;
  json_["output"] = {{"files", Json::array()},
                     {"format", name_of(w.format)},
                     {"encoding", name_of(w.encoding)},
                     {"gzip", w.gzip}};
  std::string list;
  for (const fs::path& file : written) {
    json_["output"]["files"].push_back(file.string());
    list += (list.empty() ? "" : ", ") + file.string();
  }
  row("output", list + "  (" + count_of(levels.size(), "level") + ")");
  return {};
}

Result<void> Job::print() {
  progress_.erase();
  book("total", milliseconds_since(start_));
  json_["notes"] = notes_;
  if (options_.json) return put(stdout, text_of(json_));
  if (options_.quiet) return {};

  std::string times;
  for (const char* name : kTimings)
    if (const Json& ms = json_["timings_ms"][name]; !ms.is_null())
      times += std::string(times.empty() ? "" : ", ") + name + " " + milliseconds(ms.get<double>());
  if (!json_["input"].is_null()) row("time", times);
  for (const std::string& sentence : notes_) row("note", sentence);

  std::size_t width = 0;
  for (const auto& [label, value] : rows_) width = std::max(width, label.size());
  std::string text;
  for (const auto& [label, value] : rows_)
    text += label + std::string(width + 2 - label.size(), ' ') + value + "\n";
  return put(options_.output == "-" ? stderr : stdout, text);
}

void Job::print_error(const Error& error) {
  alarm(0);
  progress_.erase();
  cli::print_error(error, options_.json);
}

void add_common_options(CLI::App& command, CommonOptions& options, bool has_input, bool has_output) {
  if (has_input)
    command
        .add_option("IN", options.input,
                    "Mesh to read: PLY, OBJ, OFF, STL, glTF (.gltf, .glb), OpenInventor, VRML or XYZ,\n"
                    "also gzipped; - for standard input")
        ->type_name("")
        ->required();
  if (has_output)
    command
        .add_option("OUT", options.output,
                    "Mesh to write: .ply, .obj, .off, .stl, .gltf, .glb, .iv, .wrl (VRML 2), .vrml1, .xyz,\n"
                    "also with .gz; - for a PLY on standard output")
        ->type_name("")
        ->required();
  command
      .add_option("--device", options.device,
                  "Where compute passes run: auto (default; a GPU, else the CPU), cpu, or\n"
                  "the index or a part of the name of a Vulkan device (see vkmesh devices)")
      ->type_name("DEVICE");
  command
      .add_option("--progress", options.progress,
                  "Progress on standard error: auto (default; on a terminal), always, never")
      ->type_name("WHEN")
      ->check(CLI::IsMember({"auto", "always", "never"}).description(""));
  command.add_flag("--json", options.json,
                   "Print one JSON object on standard output, and nothing else there");
  if (has_input)
    command
        .add_option("--on-loss", options.on_loss,
                    "What a file holds and is not passed on is noted (note, default), passed over in\n"
                    "silence (ignore), or ends the run before anything is written (fail; exit code 4)")
        ->type_name("WHAT")
        ->check(CLI::IsMember({"ignore", "note", "fail"}).description(""));
  command.add_flag("--quiet", options.quiet, "Print nothing but errors");
}

void add_consolidate_options(CLI::App& command, CommonOptions& options) {
  ConsolidateOptions& consolidation = options.consolidation;
  const auto weld = [&consolidation](const std::string& text) {
    const bool relative = text.ends_with('%');
    double value = 0;
    const char* const to = text.data() + text.size() - (relative ? 1 : 0);
    const auto [end, error] = std::from_chars(text.data(), to, value);
    if (error != std::errc() || end != to || !(value >= 0) || value > std::numeric_limits<double>::max())
      throw CLI::ValidationError("--weld",
                                 "'" + text + "' is no length, nor a share of the diagonal like 0.01%");
    consolidation.weld = WeldOptions{relative ? Length::relative(value / 100) : Length::absolute(value)};
  };
  command
      .add_option_function<std::string>(
          "--weld", weld,
          "First make points at most this far apart one: a length in units of the file, or a\n"
          "share of the bounding box's diagonal like 0.01%; 0 joins equal coordinates only")
      ->type_name("T");
  command.add_flag("--strict", consolidation.strict,
                   "Refuse a mesh that is no oriented manifold (exit code 4), instead of repairing it");
  command.add_flag_callback(
      "--drop-isolated", [&consolidation] { consolidation.keep_isolated_points = false; },
      "Leave out points that no face uses");
  command.add_flag_callback(
      "--refuse-non-orientable", [&consolidation] { consolidation.cut_non_orientable = false; },
      "Refuse a surface like the Moebius strip, instead of cutting it open along a seam");
}

void add_keep_splits(CLI::App& command, CommonOptions& options) {
  command
      .add_flag("--keep-splits", options.keep_splits,
                "Leave points apart that the file repeats at one place, as for texture coordinates.\n"
                "Else they are one while the surface is worked on, and are repeated again in OUT\n"
                "where attributes differ")
      ->excludes(command.get_option("--weld"));
}

Result<std::pair<std::string, double>> named_weight(const std::string& option, const std::string& text,
                                                    double default_weight) {
  const std::size_t equals = text.rfind('=');
  if (equals == std::string::npos) return std::pair(text, default_weight);
  double weight = 0;
  const auto [end, error] = std::from_chars(text.data() + equals + 1, text.data() + text.size(), weight);
  if (error != std::errc() || end != text.data() + text.size() || !(weight >= 0 && std::isfinite(weight)))
    return fail(ErrorCode::kUsage, option + " " + text + ": the weight must be a number of at least 0");
  return std::pair(text.substr(0, equals), weight);
}

Result<std::vector<double>> parse_numbers(const std::string& text, char separator, std::size_t count,
                                          const std::string& option) {
  std::vector<double> values;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (values.size() < count) {
    double value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !std::isfinite(value)) break;
    values.push_back(value);
    at = next;
    if (values.size() == count || at == end || *at != separator) break;
    ++at;
  }
  if (values.size() == count && at == end) return values;
  return fail(ErrorCode::kUsage, option + ": '" + text + "' is not " + std::to_string(count) +
                                     " numbers with '" + separator + "' between them");
}

std::optional<Length> length_of(const std::optional<double>& absolute,
                                const std::optional<double>& relative) {
  if (absolute) return Length::absolute(*absolute);
  if (relative) return Length::relative(*relative);
  return std::nullopt;
}

CLI::Validator number_between(double low, double high) {
  const auto check = [low, high](std::string& text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool good =
        error == std::errc() && end == text.data() + text.size() && value >= low && value <= high;
    return good ? std::string() : "'" + text + "' is no number between " + brief(low) + " and " + brief(high);
  };
  return CLI::Validator(check, "");
}

CLI::Validator count_up_to(std::uint64_t high) {
  return count_between(0, high);
}

CLI::Validator count_between(std::uint64_t low, std::uint64_t high) {
  const auto check = [low, high](std::string& text) {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool good =
        error == std::errc() && end == text.data() + text.size() && value >= low && value <= high;
    return good ? std::string()
                : "'" + text + "' is no whole number between " + std::to_string(low) + " and " +
                      std::to_string(high);
  };
  return CLI::Validator(check, "");
}

void print_error(const Error& error, bool json) {
  std::fputs(sentence_of(error).c_str(), stderr);
  if (json) static_cast<void>(put(stdout, text_of(object_of(error))));
}

std::string grouped(std::size_t n) {
  std::string text = std::to_string(n);
  for (std::size_t at = text.size(); at > 3; at -= 3) text.insert(at - 3, 1, ',');
  return text;
}

std::string brief(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", x);
  return text;
}

std::string count_of(std::size_t n, const std::string& singular, const std::string& plural) {
  return grouped(n) + " " + (n == 1 ? singular : plural.empty() ? singular + "s" : plural);
}

}  // namespace vkmesh::cli
