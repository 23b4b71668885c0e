// The choice of the device, and the promise that all devices write the same bytes.
#include <catch2/catch.hpp>

#include "meshes.h"
#include "program.h"

using namespace vkmesh::test;
using Catch::Matchers::Contains;

namespace {

const std::string kDragon = std::string(VKMESH_DATA_DIR) + "/dragon/dragon_vrip.ply.gz";

}  // namespace

TEST_CASE("A device that is not there is refused with exit code 5, before the input is read") {
  const Scratch scratch;
  for (const std::string name : {"no such device", "4000000000"}) {
    const Outcome outcome =
        vkmesh_run({"normals", scratch.path("none.ply"), scratch.path("out.ply"), "--device", name});
    CAPTURE(outcome.err);
    CHECK(outcome.code == 5);
    CHECK_THAT(outcome.err, Contains(name));
    CHECK(scratch.names().empty());
  }
}

TEST_CASE("The CPU is reported as the device it is") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kTetrahedronOff);
  const auto object =
      vkmesh_run({"normals", in, scratch.path("out.ply"), "--device", "cpu", "--json"}).json();
  CHECK(object.at("device").at("name") == "cpu");
  CHECK(object.at("device").at("type") == "host");
  CHECK(object.at("timings_ms").at("compute").is_number());
  CHECK(object.at("timings_ms").at("device").is_null());
}

TEST_CASE("A subcommand of the host says that the device was not used") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kTetrahedronOff);
  const auto object = vkmesh_run({"info", in, "--device", "llvmpipe", "--json"}).json();
  CHECK(object.at("device").at("name") == "cpu");
  CHECK_THAT(object.at("notes").dump(), Contains("llvmpipe"));
}

#ifdef VKMESH_HAS_VULKAN

TEST_CASE("devices lists the software device", "[device]") {
  const auto devices = vkmesh_run({"devices", "--json"}).json().at("result").at("devices");
  bool found = false;
  for (const auto& device : devices) {
    CHECK(device.at("usable").get<bool>() == device.at("rejected").is_null());
    if (device.at("name").get<std::string>().find("llvmpipe") != std::string::npos) {
      found = true;
      CHECK(device.at("type") == "software");
      CHECK(device.at("usable") == true);
    }
  }
  CHECK(found);
}

TEST_CASE("auto takes no software device", "[device]") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kTetrahedronOff);
  const auto object = vkmesh_run({"normals", in, scratch.path("out.ply"), "--json"}).json();
  CHECK(object.at("device").at("type") != "software");
}

TEST_CASE("The CPU and the device write the same bytes, at every vector width", "[device]") {
  const std::vector<std::vector<std::string>> commands = {
      {"normals"},
      {"curvature"},
      {"smooth", "--iterations", "5"},
      {"smooth", "--iterations", "3", "--boundary", "free"},
      {"smooth", "--iterations", "3", "--mu", "-0.53", "--weights", "cotangent", "--boundary", "along"},
      {"normals", "--weights", "angle"}};
  for (const auto& command : commands) {
    CAPTURE(command);
    const Scratch scratch;
    const auto run = [&](const std::string& out, const std::string& device, const std::string& width) {
      std::vector<std::string> arguments = {command[0], kDragon, scratch.path(out),
                                            "--device", device,  "--json"};
      arguments.insert(arguments.end(), command.begin() + 1, command.end());
      RunOptions options;
      if (!width.empty()) options.environment = {{"LP_NATIVE_VECTOR_WIDTH", width}};
      const Outcome outcome = vkmesh_run(arguments, options);
      CAPTURE(outcome.err);
      REQUIRE(outcome.code == 0);
      return outcome.json();
    };
    CHECK(run("cpu.ply", "cpu", "").at("device").at("type") == "host");
    const auto wide = run("wide.ply", "llvmpipe", "");
    CHECK(wide.at("device").at("type") == "software");
    CHECK(wide.at("timings_ms").at("device") > 0.0);
    CHECK(wide.at("timings_ms").at("compute").is_null());
    const auto narrow = run("narrow.ply", "llvmpipe", "128");
    CHECK_THAT(narrow.at("device").at("name").get<std::string>(), Contains("128 bits"));
    // Compared as a whole: Catch would print megabytes.
    const std::string cpu = content_of(scratch.path("cpu.ply"));
    const bool wide_equal = content_of(scratch.path("wide.ply")) == cpu;
    const bool narrow_equal = content_of(scratch.path("narrow.ply")) == cpu;
    CHECK(wide_equal);
    CHECK(narrow_equal);
    CHECK(cpu.size() > 10'000'000);
  }
}

#endif
