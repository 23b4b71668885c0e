// The choice of the device, and the promise that all devices write the same bytes.
#include <algorithm>

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

TEST_CASE("a driver that makes no device, or crashes, takes neither devices nor auto down", "[device]") {
  const Scratch scratch;
  const std::string in = scratch.file("in.off", kTetrahedronOff);
  struct Case {
    std::string fails, why;
    bool listed = true;
  };
  for (const Case& c :
       {Case{"no-device", "VK_ERROR_INITIALIZATION_FAILED"},
        Case{"crash-opening", "crashes (Illegal instruction) while it is opened"},
        Case{"crash-listing", "a Vulkan driver crashes (Segmentation fault) while devices are listed",
             false}}) {
    CAPTURE(c.fails);
    // The fake's GPU stands before those of the system's drivers.
    RunOptions fake;
    fake.environment = {{"VK_ADD_DRIVER_FILES", VKMESH_FAKE_ICD_MANIFEST}, {"VKMESH_FAKE_ICD", c.fails}};
    const Outcome outcome = vkmesh_run({"devices", "--json"}, fake);
    REQUIRE(outcome.code == 0);
    const auto devices = outcome.json().at("result").at("devices");
    if (c.listed) {
      const auto gpu = std::find_if(devices.begin(), devices.end(),
                                    [](const auto& d) { return d.at("name") == "Fake GPU"; });
      REQUIRE(gpu != devices.end());
      CHECK(gpu->at("usable") == false);
      CHECK_THAT(gpu->at("rejected").template get<std::string>(), Contains(c.why));
      CHECK(
          std::any_of(devices.begin(), devices.end(), [](const auto& d) { return d.at("usable") == true; }));
    } else {
      CHECK(devices.empty());
      CHECK_THAT(outcome.json().at("notes").dump(), Contains(c.why));
    }
    const Outcome automatic = vkmesh_run({"normals", in, scratch.path("out.ply"), "--json"}, fake);
    REQUIRE(automatic.code == 0);
    CHECK(automatic.json().at("device").at("type") == "host");
    CHECK_THAT(automatic.json().at("notes").dump(), Contains("no GPU serves") && Contains(c.why));
  }
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
