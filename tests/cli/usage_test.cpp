// The command line itself: help, versions, and refusals before any work is done.
#include <filesystem>
#include <sstream>

#include <catch2/catch.hpp>

#include "meshes.h"
#include "program.h"

using namespace vkmesh::test;
using Catch::Matchers::Contains;

namespace {

const std::vector<std::string> kCommands = {"info",     "convert",  "normals",  "creases", "curvature",
                                            "smooth",   "optimize", "simplify", "lod",     "remesh",
                                            "delaunay", "voronoi",  "compare",  "digest",  "devices"};

/// The words of each line after "Example:" or "Examples:", the program's name aside.
std::vector<std::vector<std::string>> examples_of(const std::string& help) {
  const std::size_t at = help.find("\nExample");
  REQUIRE(at != std::string::npos);
  std::istringstream lines(help.substr(help.find('\n', at + 1) + 1));
  std::vector<std::vector<std::string>> examples;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::vector<std::string> arguments;
    for (std::string word; words >> word;) arguments.push_back(word);
    if (arguments.empty()) continue;
    REQUIRE(arguments.front() == "vkmesh");
    arguments.erase(arguments.begin());
    examples.push_back(arguments);
  }
  REQUIRE(!examples.empty());
  return examples;
}

}  // namespace

TEST_CASE("The version is that of the project") {
  const Outcome outcome = vkmesh_run({"--version"});
  CHECK(outcome.code == 0);
  CHECK(outcome.out == "vkmesh " VKMESH_VERSION "\n");
  CHECK(outcome.err.empty());
}

TEST_CASE("Help names every subcommand") {
  const Outcome outcome = vkmesh_run({"--help"});
  CHECK(outcome.code == 0);
  for (const std::string& command : kCommands) CHECK_THAT(outcome.out, Contains("  " + command));
}

TEST_CASE("The example in the help of every subcommand runs") {
  for (const std::string& command : kCommands) {
    CAPTURE(command);
    const Outcome help = vkmesh_run({command, "--help"});
    REQUIRE(help.code == 0);
    for (const std::vector<std::string>& arguments : examples_of(help.out)) {
      CHECK(arguments.front() == command);
      const Scratch scratch;
      std::filesystem::create_symlink(VKMESH_DATA_DIR, scratch.path("data"));
      RunOptions options;
      options.folder = scratch.path("");
      const Outcome outcome = vkmesh_run(arguments, options);
      CAPTURE(outcome.err);
      CHECK(outcome.code == 0);
      const bool writes =
          command != "info" && command != "compare" && command != "digest" && command != "devices";
      if (command == "lod")  // a file for each level, or one for all
        CHECK(scratch.names().size() >= 2);
      else
        CHECK(scratch.names().size() == (writes ? 2 : 1));
    }
  }
}

TEST_CASE("A wrong command line is refused with exit code 2 and a sentence") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kTetrahedronOff);
  const std::string out = scratch.path("out.ply");
  struct Case {
    std::vector<std::string> arguments;
    std::string says;
  };
  const std::vector<Case> cases = {
      {{}, "subcommand"},
      {{"explode", in}, "explode"},
      {{"info"}, "IN"},
      {{"normals", in}, "OUT"},
      {{"info", in, out}, out},
      {{"info", in, "--colour"}, "--colour"},
      {{"info", in, "--progress", "sometimes"}, "sometimes"},
      {{"convert", in, scratch.path("out.fbx")}, "ply"},
      {{"convert", in, scratch.path("out")}, "ply"},
      {{"smooth", in, out, "--lambda", "1.5"}, "--lambda"},
      {{"smooth", in, out, "--lambda", "nan"}, "--lambda"},
      {{"smooth", in, out, "--iterations", "-1"}, "--iterations"},
      {{"smooth", in, out, "--iterations", "ten"}, "--iterations"},
      {{"smooth", in, out, "--method", "other"}, "--method"},
      {{"smooth", in, out, "--mu", "0.1"}, "--mu"},
      {{"smooth", in, out, "--weights", "round"}, "'round' is none of cotangent, uniform"},
      {{"normals", in, out, "--weights", "0"}, "'0' is none of angle, area, uniform"},
      {{"smooth", in, out, "--method", "laplacian", "--mu", "-0.5"}, "--mu"},
      {{"smooth", in, out, "--method", "bilateral", "--mu", "-0.5"}, "--mu"},
      {{"smooth", in, out, "--method", "bilateral", "--lambda", "0.5"}, "--lambda"},
      {{"smooth", in, out, "--method", "bilateral", "--iterations", "5"}, "--iterations"},
      {{"smooth", in, out, "--method", "bilateral", "--weights", "uniform"}, "--weights"},
      {{"smooth", in, out, "--method", "bilateral", "--boundary", "free"}, "--boundary"},
      {{"smooth", in, out, "--spatial", "2"}, "--spatial"},
      {{"smooth", in, out, "--method", "laplacian", "--influence", "2"}, "--influence"},
      {{"smooth", in, out, "--method", "bilateral", "--spatial", "0"}, "--spatial"},
      {{"curvature", in, out, "--kind", "largest"}, "--kind"},
      {{"creases", in, scratch.path("out.obj"), "--sharp", "181"}, "--sharp"},
      {{"creases", in, scratch.path("out.obj"), "--soft", "-1"}, "--soft"},
      {{"creases", in, scratch.path("out.obj"), "--soft", "50"}, "--soft"},
      {{"creases", in, scratch.path("out.obj"), "--min-length", "-1"}, "--min-length"},
      {{"creases", in, scratch.path("out.obj"), "--kind", "round"},
       "'round' is none of both, concave, convex"},
      {{"creases", in, out}, ".obj"},
      {{"creases", in, scratch.path("out.obj.gz")}, ".obj"},
      {{"creases", in, "-", "--json"}, "--json"},
      {{"simplify", in, out}, "--ratio"},
      {{"simplify", in, out, "--ratio", "2"}, "--ratio"},
      {{"simplify", in, out, "--ratio", "nan"}, "--ratio"},
      {{"simplify", in, out, "--ratio", "0.5", "--faces", "2"}, "--ratio"},
      {{"simplify", in, out, "--faces", "-3"}, "--faces"},
      {{"simplify", in, out, "--error", "-1"}, "--error"},
      {{"simplify", in, out, "--ratio", "0.5", "--max-normal-deviation", "270"}, "--max-normal-deviation"},
      {{"simplify", in, out, "--ratio", "0.5", "--lock", "mark"}, "mark"},
      {{"simplify", in, out, "--ratio", "0.5", "--prune-size", "-1"}, "--prune-size"},
      {{"simplify", in, out, "--error", "1", "--relative-error", "0.1"}, "--relative-error"},
      {{"simplify", in, out, "--ratio", "0.5", "--max-distance", "1", "--max-relative-distance", "0.1"},
       "--max-distance"},
      {{"simplify", in, out, "--ratio", "0.5", "--criterion", "beauty"}, "beauty"},
      {{"simplify", in, out, "--ratio", "0.5", "--criterion", "density=-1"}, "density=-1"},
      {{"simplify", in, out, "--ratio", "0.5", "--criterion", "density=1x"}, "density=1x"},
      {{"simplify", in, out, "--ratio", "0.5", "--criterion", "quadric=0"}, "criterion"},
      {{"simplify", in, out, "--ratio", "0.5", "--max-valence", "2"}, "valence"},
      {{"simplify", in, out, "--ratio", "0.5", "--max-aspect-ratio", "0.5"}, "--max-aspect-ratio"},
      {{"simplify", in, out, "--ratio", "0.5", "--max-distance", "-1"}, "--max-distance"},
      {{"convert", in, "-", "--json"}, "--json"},
  };
  for (const Case& one : cases) {
    std::string line = "vkmesh";
    for (const std::string& argument : one.arguments) line += " " + argument;
    CAPTURE(line);
    const Outcome outcome = vkmesh_run(one.arguments);
    CHECK(outcome.code == 2);
    CHECK_THAT(outcome.err, Catch::StartsWith("vkmesh: ") && Contains(one.says));
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
    if (one.arguments.empty() || one.arguments.back() != "--json") CHECK(outcome.out.empty());
  }
  CHECK(scratch.names() == std::vector<std::string>{"in.off"});
}

TEST_CASE("With --json a wrong command line is an object as well") {
  const auto error = vkmesh_run({"info", "--json"}).json().at("error");
  CHECK(error.at("code") == 2);
  CHECK_THAT(error.at("message").get<std::string>(), Contains("IN"));
  CHECK(error.at("file").is_null());
  CHECK(error.at("line").is_null());
}

TEST_CASE("--quiet prints nothing") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kTetrahedronOff);
  const Outcome outcome = vkmesh_run({"normals", in, scratch.path("out.ply"), "--quiet", "--device", "cpu"});
  CHECK(outcome.code == 0);
  CHECK(outcome.out.empty());
  CHECK(outcome.err.empty());
}

TEST_CASE("Progress goes to standard error, and only when asked for where that is no terminal") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kTetrahedronOff);
  const std::string out = scratch.path("out.ply");
  const std::vector<std::string> smooth = {"smooth", in, out, "--device", "cpu", "--json"};
  const auto with = [&](const std::string& when) {
    auto arguments = smooth;
    arguments.insert(arguments.end(), {"--progress", when});
    return vkmesh_run(arguments);
  };
  CHECK(with("auto").err.empty());
  CHECK(with("never").err.empty());
  const Outcome always = with("always");
  CHECK_THAT(always.err, Contains(" %\n"));
  CHECK_THAT(always.err, !Contains("\x1b"));
  CHECK(always.json().at("command") == "smooth");
}
