// Every kind of bad input: one sentence with its place, its exit code, and no output.
#include <csignal>
#include <filesystem>

#include <catch2/catch.hpp>

#include "meshes.h"
#include "program.h"
#include "support/shapes.h"

using namespace vkmesh::test;
using Catch::Matchers::Contains;

namespace {

struct Case {
  std::string name;  ///< The file's; its extension matters.
  std::string content;
  int code;
  std::string place;  ///< What follows the file's name in the sentence: ":3:", ": byte ", or "".
  std::string says;
};

const std::string kPlyHead =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kPlyFaces = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
const std::string kPlyPoints = "0 0 0\n1 0 0\n0 1 0\n";

std::vector<Case> cases() {
  const std::string binary_head =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
      "float z\n" +
      kPlyFaces;
  std::string garbage;
  for (unsigned i = 0; i < 4096; ++i) garbage += static_cast<char>((i * 2654435761u) >> 13);
  std::string stl(80, ' ');
  stl += std::string("\xff\xff\xff\x7f", 4);
  stl += std::string(50, '\0');
  return {
      {"truncated.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n", 3, ":2:", "promises 4 vertices"},
      {"truncated.ply", binary_head + std::string(20, '\0'), 3, ":3:", "promises 3"},
      {"half_a_header.ply", "ply\nformat ascii 1.0\nelement ver", 3, ":", ""},
      {"empty.ply", "", 3, ":", "empty"},
      {"empty.obj", "", 3, ":", "empty"},
      {"garbage.ply", garbage, 3, ":", ""},
      {"garbage.off", garbage, 3, ":", ""},
      {"garbage.obj", garbage, 3, ":", ""},
      {"garbage.gz", "\x1f\x8b\x08" + garbage, 3, ":", ""},
      {"fewer_points.off", "OFF\n5 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", 3, ":", ""},
      {"fewer_faces.ply",
       kPlyHead + "element face 2\nproperty list uchar int vertex_indices\nend_header\n" + kPlyPoints +
           "3 0 1 2\n",
       3, ":", "end"},
      {"range.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", 3, ":6:", "3"},
      {"negative.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", 3, ":6:", "-1"},
      {"range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", 3, ":4:", "4"},
      {"before_first.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -4\n", 3, ":4:", "-4"},
      {"zero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", 3, ":4:", "0"},
      {"range.ply", kPlyHead + kPlyFaces + kPlyPoints + "3 0 1 7\n", 3, ":13:", "7"},
      {"nan.off", "OFF\n3 1 0\n0 0 0\nnan 0 0\n0 1 0\n3 0 1 2\n", 3, ":4:", "finite"},
      {"infinite.obj", "v 0 0 0\nv 1 inf 0\nv 0 1 0\nf 1 2 3\n", 3, ":2:", "finite"},
      {"overflow.ply", kPlyHead + kPlyFaces + "0 0 0\n1e99 0 0\n0 1 0\n3 0 1 2\n", 3, ":11:", "1e99"},
      {"promises.ply",
       "ply\nformat ascii 1.0\nelement vertex 1000000000000\nproperty float x\nproperty float y\nproperty "
       "float z\nend_header\n0 0 0\n",
       3, ":", ""},
      {"promises_binary.ply",
       "ply\nformat binary_little_endian 1.0\nelement vertex 1000000000000\nproperty float x\nproperty float "
       "y\nproperty float z\nend_header\n0123",
       3, ":", ""},
      {"promises.off", "OFF\n1000000000000 0 0\n0 0 0\n", 3, ":", ""},
      {"promises.stl", stl, 3, ":", ""},
      {"repeated.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 1\n", 4, "", "degenerate"},
      {"repeated_in_quad.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 1\n", 4, "", "degenerate"},
      {"fin.off", kFinOff, 4, "", "three or more faces"},
      {"bow_tie.off", off_of(bow_tie()), 4, "", "fans"},
      {"mobius.off", off_of(mobius(8)), 4, "", "orient"},
  };
}

/// No part of an output is left: only what the test itself put there.
void check_only(const Scratch& scratch, const std::string& name) {
  CHECK(scratch.names() == std::vector<std::string>{name});
}

}  // namespace

TEST_CASE("Bad input is refused by every subcommand that must, with a place and a sentence") {
  for (const Case& one : cases()) {
    CAPTURE(one.name);
    const Scratch scratch;
    const std::string in = scratch.file(one.name, one.content);
    const std::string out = scratch.path("out.ply");
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"normals", in, out, "--device", "cpu", "--strict"},
          {"curvature", in, out, "--device", "cpu", "--strict"},
          {"smooth", in, out, "--device", "cpu", "--strict"},
          {"simplify", in, out, "--ratio", "0.5", "--strict"}}) {
      CAPTURE(arguments[0]);
      const Outcome outcome = vkmesh_run(arguments);
      CAPTURE(outcome.err);
      CHECK(outcome.code == one.code);
      CHECK(outcome.out.empty());
      CHECK_THAT(outcome.err, Catch::StartsWith("vkmesh: " + in + one.place) && Contains(one.says));
      CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
      check_only(scratch, one.name);
    }
    // What only a manifold is needed for does not trouble info and convert.
    const Outcome info = vkmesh_run({"info", in});
    const Outcome convert = vkmesh_run({"convert", in, out, "--as-is"});
    CHECK(info.code == (one.code == 3 ? 3 : 0));
    CHECK(convert.code == (one.code == 3 ? 3 : 0));
    CHECK(std::filesystem::exists(out) == (one.code != 3));
  }
}

TEST_CASE("With --json an error is one object that says where") {
  const Scratch scratch;
  const std::string in = scratch.file("range.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
  const Outcome outcome = vkmesh_run({"normals", in, scratch.path("out.ply"), "--json"});
  CHECK(outcome.code == 3);
  const auto error = outcome.json().at("error");
  CHECK(error.at("code") == 3);
  CHECK(error.at("file") == in);
  CHECK(error.at("line") == 4);
  CHECK(outcome.err == "vkmesh: " + in + ":4: " + error.at("message").get<std::string>() + "\n");
}

TEST_CASE("Input that is no file") {
  const Scratch scratch;
  const Outcome missing = vkmesh_run({"info", scratch.path("none.ply")});
  CHECK(missing.code == 3);
  CHECK_THAT(missing.err, Contains(scratch.path("none.ply")) && Contains("No such file"));
  std::filesystem::create_directory(scratch.path("folder.ply"));
  const Outcome folder = vkmesh_run({"info", scratch.path("folder.ply")});
  CHECK(folder.code == 3);
  CHECK_THAT(folder.err, Contains(scratch.path("folder.ply")) && Contains("directory"));
  const Outcome nothing = vkmesh_run({"info", "-"});
  CHECK(nothing.code == 3);
  CHECK_THAT(nothing.err, Contains("empty"));
}

TEST_CASE("Output that cannot be written gives exit code 7") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kTetrahedronOff);
  std::filesystem::create_directory(scratch.path("folder.ply"));
  for (const std::string& out : {scratch.path("none/out.ply"), in + "/out.ply", scratch.path("folder.ply"),
                                 std::string("/proc/out.ply")}) {
    CAPTURE(out);
    const Outcome outcome = vkmesh_run({"convert", in, out, "--as-is"});
    CHECK(outcome.code == 7);
    CHECK_THAT(outcome.err, Catch::StartsWith("vkmesh: " + out + ": "));
    CHECK(outcome.out.empty());
  }
  CHECK(scratch.names() == std::vector<std::string>{"folder.ply", "in.off"});
}

TEST_CASE("A disk that fills up leaves what was there before") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", off_of(icosphere(4)));
  const std::string out = scratch.file("out.ply", "older");
  RunOptions options;
  options.file_size_limit = 4096;
  const Outcome outcome = vkmesh_run({"convert", in, out}, options);
  CAPTURE(outcome.err);
  CHECK(outcome.code == 7);
  CHECK(content_of(out) == "older");
  CHECK(scratch.names() == std::vector<std::string>{"in.off", "out.ply"});
}

TEST_CASE("A full device behind standard output is noticed") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", off_of(icosphere(4)));
  RunOptions options;
  options.output_to = "/dev/full";
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"convert", in, "-"}, {"info", in}, {"info", in, "--json"}}) {
    const Outcome outcome = vkmesh_run(arguments, options);
    CHECK(outcome.code == 7);
    CHECK_THAT(outcome.err, Contains("No space left"));
  }
}

TEST_CASE("An interrupt or a termination ends the work with exit code 130 and leaves no file") {
  // The alarm is what an interrupt sets for steps that do not hear it.
  for (const int signal : {SIGINT, SIGTERM, SIGALRM}) {
    CAPTURE(signal);
    const Scratch scratch;
    RunOptions options;
    options.signal = signal;
    options.signal_after = "simplifying";
    const Outcome outcome =
        vkmesh_run({"simplify", std::string(VKMESH_DATA_DIR) + "/dragon/dragon_vrip.ply.gz",
                    scratch.path("out.ply"), "--ratio", "0.001", "--progress", "always"},
                   options);
    CHECK(outcome.code == 130);
    CHECK_THAT(outcome.err, Contains("vkmesh: interrupted"));
    CHECK(outcome.out.empty());
    CHECK(scratch.names().empty());
  }
}

TEST_CASE("An interrupt that a step does not hear is told in JSON like any other") {
  const Scratch scratch;
  for (const int signal : {SIGINT, SIGALRM}) {
    RunOptions options;
    options.signal = signal;
    options.signal_after = "simplifying";
    const Outcome outcome =
        vkmesh_run({"simplify", std::string(VKMESH_DATA_DIR) + "/dragon/dragon_vrip.ply.gz",
                    scratch.path("out.ply"), "--ratio", "0.001", "--progress", "always", "--json"},
                   options);
    CHECK(outcome.code == 130);
    CHECK(outcome.json().at("error").at("code") == 130);
    CHECK(outcome.json().at("error").at("message") == "interrupted");
  }
}
