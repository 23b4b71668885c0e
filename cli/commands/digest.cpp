// vkmesh digest: 64-bit digests of what every pass computes, the same on every device.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <sys/utsname.h>

#include <vkmesh/mesh/triangulate.h>

#include "commands.h"
#include "passes/backend.h"

namespace vkmesh::cli {
namespace {

struct DigestOptions {
  std::vector<std::string> files;
  std::string check;
};

struct Line {
  std::string digest, pass, file;
  std::optional<Error> error;  ///< Why the pass has no digest.
};

/// What --check found of one pass.
struct Verdict {
  std::string pass;
  std::size_t meshes = 0, differing = 0;
  std::string first;  ///< The first of those that differ.
};

struct Input {
  HalfEdgeMesh mesh;
  std::vector<Vec3> positions;
};

std::string hexadecimal(std::uint64_t digest) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(digest));
  return text;
}

Result<Input> read_triangles(Job& job, const std::string& file) {
  VKMESH_TRY(MeshFile read, job.timed("read", [&] {
    return read_mesh(file, ReadOptions{job.progress("reading"), DVec3(0.0), true});
  }));
  return job.timed("consolidate", [&]() -> Result<Input> {
    VKMESH_TRY(const IndexedFaceSet polygons, to_indexed_face_set(std::move(read)));
    if (polygons.face_count() == 0)
      return fail(ErrorCode::kUnsuitable,
                  "a point cloud has no faces for the passes: give files of meshes to digest",
                  {file, {}, {}});
    VKMESH_TRY(Triangulated cut, triangulate(polygons));
    VKMESH_TRY(Consolidated made, consolidate(std::move(cut.mesh), job.options().consolidation));
    return Input{std::move(made.mesh), std::move(made.face_set.points)};
  });
}

Result<std::vector<Line>> digests_of(Job& job, Backend& backend, const std::string& file) {
  VKMESH_TRY(const Input read, read_triangles(job, file));
  const PassInput input(read.mesh, read.positions);
  std::vector<Line> lines;
  for (const PassRow& row : pass_table()) {
    if (row.name.empty()) continue;
    auto output = backend.run(row.pass(input), input);
    if (!output) {
      if (output.error().where.file.empty()) output.error().where.file = file;
      if (output.error().code == ErrorCode::kInterrupted) return tl::unexpected<Error>(output.error());
      lines.push_back({{}, row.name, file, output.error()});
      continue;
    }
    lines.push_back({hexadecimal(row.digest(*output)), row.name, file, {}});
  }
  return lines;
}

/// The lines of a list that begin with a digest; others are comments.
Result<std::vector<Line>> read_list(const std::string& path) {
  std::ifstream file(path);
  std::vector<Line> lines;
  for (std::string text; std::getline(file, text);) {
    const auto is_hexadecimal = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
    if (text.size() < 19 || text.substr(16, 2) != "  " ||
        !std::all_of(text.begin(), text.begin() + 16, is_hexadecimal))
      continue;
    const std::size_t space = text.find("  ", 18);
    if (space == std::string::npos) continue;
    const std::size_t name = text.find_first_not_of(' ', space);
    lines.push_back({text.substr(0, 16), text.substr(18, space - 18), text.substr(name), {}});
  }
  if (lines.empty())
    return fail(ErrorCode::kUnreadable, "holds no digests, or cannot be read", {path, {}, {}});
  return lines;
}

/// Reports a verdict for each pass, in a form to be pasted into an issue.
Result<void> check(Job& job, const std::string& list, const std::vector<Line>& expected,
                   const std::vector<Line>& lines) {
  std::vector<Verdict> verdicts;
  std::size_t differences = 0;
  std::string first;
  std::optional<Error> error;
  std::set<std::string> files;
  for (const Line& line : expected) {
    files.insert(line.file);
    auto verdict =
        std::find_if(verdicts.begin(), verdicts.end(), [&](const Verdict& v) { return v.pass == line.pass; });
    if (verdict == verdicts.end()) verdict = verdicts.insert(verdicts.end(), Verdict{line.pass, 0, 0, {}});
    ++verdict->meshes;
    const auto found = std::find_if(lines.begin(), lines.end(), [&](const Line& l) {
      return l.file == line.file && l.pass == line.pass;
    });
    if (found != lines.end() && found->digest == line.digest) continue;
    ++differences;
    std::string what = "no such pass";
    if (found != lines.end())
      what = found->error ? found->error->message : found->digest + " for " + line.digest;
    if (first.empty()) first = line.pass + " of " + line.file + ", " + what;
    if (!error && found != lines.end()) error = found->error;
    if (verdict->differing++ == 0) verdict->first = line.file + ", " + what;
  }
  Json& passes = job.json()["result"]["passes"] = Json::array();
  for (const Verdict& v : verdicts) {
    passes.push_back({{"pass", v.pass}, {"meshes", v.meshes}, {"differing", v.differing}});
    job.row(v.pass, v.differing == 0 ? "the same bytes, " + count_of(v.meshes, "mesh", "meshes")
                                     : "DIFFERS for " + grouped(v.differing) + " of " +
                                           count_of(v.meshes, "mesh", "meshes") + ", first " + v.first);
  }
  job.json()["result"]["differences"] = differences;
  job.row("digests", grouped(expected.size()) + " checked, " + grouped(files.size()) + " files");
  if (differences == 0) return {};
  // The report is wanted above all where something differs. (With --json the error alone is printed.)
  if (!job.options().json) VKMESH_CHECK(job.print());
  if (error) return tl::unexpected<Error>(*error);
  return fail(ErrorCode::kUnsuitable,
              count_of(differences, "digest") + " of " + grouped(expected.size()) +
                  (differences == 1 ? " differs: " : " differ, first ") + first,
              {list, {}, {}});
}

Result<void> run(Job& job, const DigestOptions& options) {
  if (options.files.empty() == options.check.empty())
    return fail(ErrorCode::kUsage, "name files, or a list to --check");
  std::vector<Line> expected;
  std::vector<std::string> files = options.files;
  if (!options.check.empty()) {
    VKMESH_TRY(expected, read_list(options.check));
    for (const Line& line : expected)
      if (std::find(files.begin(), files.end(), line.file) == files.end()) files.push_back(line.file);
  }
  VKMESH_TRY(Backend backend, open_backend(job));
  if (!options.check.empty()) {
    utsname system{};
    (void)uname(&system);
    job.row("program", std::string("vkmesh " VKMESH_VERSION "; ") + system.sysname + " " + system.release +
                           "; " + system.machine);
  }
  Json& list = job.json()["result"]["digests"] = Json::array();
  std::vector<Line> lines;
  for (const std::string& file : files) {
    VKMESH_TRY(std::vector<Line> some, digests_of(job, backend, file));
    std::move(some.begin(), some.end(), std::back_inserter(lines));
  }
  for (const Line& line : lines)
    if (!line.error) list.push_back({{"file", line.file}, {"pass", line.pass}, {"digest", line.digest}});
  if (!options.check.empty()) return check(job, options.check, expected, lines);

  std::size_t width = 0;
  for (const Line& line : lines) width = std::max(width, line.pass.size());
  for (const Line& line : lines) {
    if (line.error) return tl::unexpected<Error>(*line.error);
    job.row(line.digest, line.pass + std::string(width + 2 - line.pass.size(), ' ') + line.file);
  }
  return {};
}

}  // namespace

void add_digest(CLI::App& app, Program& program) {
  CLI::App* command = app.add_subcommand("digest", "Digests of what every pass computes of meshes");
  command->footer(
      "One line for each pass and file: 64 bits (FNV-1a) over the bytes of the result. They are the same on "
      "every device,\nwith every compiler and any number of threads; --check compares with a list of such "
      "lines "
      "and fails (exit code 4)\nwhere one differs. Polygons are cut into triangles, and what is no manifold "
      "is "
      "repaired first.\nFrom a checkout with its data, --check tests/digests.txt --device NAME says of any "
      "GPU "
      "whether it keeps the promise;\nits report, pasted into an issue, puts the device on the list of those "
      "that were seen to.\n\n"
      "Example:\n  vkmesh digest data/cgal/meshes/elephant.off --device cpu");
  add_common_options(*command, program.options, false, false);
  const auto options = std::make_shared<DigestOptions>();
  command->add_option("FILE", options->files, "Meshes")->type_name("");
  command->add_option("--check", options->check, "A list of digests to compare with, and the files it names")
      ->type_name("LIST");
  command->callback([&program, options] {
    program.command = "digest";
    program.action = [options](Job& job) { return run(job, *options); };
  });
}

}  // namespace vkmesh::cli
