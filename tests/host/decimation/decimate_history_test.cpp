#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/decimation/decimate.h>

#include "decimation/decimate_support.h"
#include "decimation/decimation_state.h"
#include "support/data.h"
#include "support/shapes.h"

namespace vkmesh {
namespace {

using test::run, test::ways;

/// A mesh with attributes, and what options borrow of it.
struct Input {
  IndexedFaceSet mesh;
  std::vector<float> normals, uv;            // one for each point; one for each value that a corner names
  std::vector<std::uint32_t> uv_of, groups;  // by corner

  void add_to(DecimateOptions& options) const {
    options.attributes = {{3, normals, {}, 0.05, AttributeKind::kNormal},
                          {2, uv, uv_of, 0.02, AttributeKind::kPlain}};
    options.corner_groups = groups;
  }
};

/// Charts about random faces; values differ from chart to chart or only groups do.
Input with_random_seams(IndexedFaceSet mesh, std::uint32_t seed) {
  Input input;
  std::mt19937 random(seed);
  const std::size_t charts = 2 + random() % 4;
  std::vector<Vec3> middle;
  for (std::size_t i = 0; i < charts; ++i) middle.push_back(mesh.points[random() % mesh.points.size()]);
  std::map<std::pair<std::uint32_t, std::size_t>, std::uint32_t> number;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(f);
    const Vec3 at = (mesh.points[face[0]] + mesh.points[face[1]] + mesh.points[face[2]]) / 3.0f;
    std::size_t chart = 0;
    for (std::size_t i = 1; i < charts; ++i) {
      const Vec3 a = at - middle[i], b = at - middle[chart];
      if (a.x * a.x + a.y * a.y + a.z * a.z < b.x * b.x + b.y * b.y + b.z * b.z) chart = i;
    }
    for (const std::uint32_t v : face) {
      const auto next = static_cast<std::uint32_t>(input.uv.size() / 2);
      const auto [place, is_new] = number.try_emplace({v, chart / 2}, next);
      if (is_new)
        input.uv.insert(input.uv.end(), {mesh.points[v].x + static_cast<float>(chart / 2),
                                         mesh.points[v].y * mesh.points[v].z});
      input.uv_of.push_back(place->second);
      input.groups.push_back(static_cast<std::uint32_t>(chart));
    }
  }
  for (const Vec3& p : mesh.points) {
    const float length = std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
    input.normals.insert(input.normals.end(), {p.x / length, p.y / length, p.z / length});
  }
  input.mesh = std::move(mesh);
  return input;
}

/// Does a history over again with what a result says of it, and nothing else.
class Player {
 public:
  Player(const IndexedFaceSet& mesh, const DecimateOptions& options, const Decimated& result)
      : result_(result),
        places(mesh.points),
        corners(mesh.corners),
        wedges(result.changes.corners),
        there(mesh.face_count(), true) {
    values.resize(options.attributes.size());
    for (std::size_t a = 0; a < values.size(); ++a) {
      const DecimateAttribute& attribute = options.attributes[a];
      for (std::size_t c = 0; c < corners.size(); ++c) {
        const std::size_t i = attribute.corners.empty() ? corners[c] : attribute.corners[c];
        const auto value = attribute.values.subspan(i * attribute.components, attribute.components);
        values[a].emplace_back(value.begin(), value.end());  // by wedge: a corner of the input
      }
    }
  }

  void step() {
    const Collapse<Vec3>& c = result_.history[step_];
    const DecimationChanges& changes = result_.changes;
    places[c.kept] = c.position;
    for (const std::uint32_t f : c.faces)
      if (f != kInvalid) there[f] = false;
    std::replace(corners.begin(), corners.end(), c.removed, c.kept);
    for (; wedge_ < changes.wedges.size() && changes.wedges[wedge_].step == step_; ++wedge_) {
      const auto& change = changes.wedges[wedge_];
      std::replace(wedges.begin(), wedges.end(), change.wedge, change.into);
      for (std::size_t a = 0; a < values.size(); ++a) {
        const std::size_t n = values[a][0].size();
        const auto value = std::span(changes.values[a]).subspan(n * wedge_, n);
        values[a][change.into].assign(value.begin(), value.end());
      }
    }
    for (; face_ < changes.faces.size() && changes.faces[face_].step == step_; ++face_)
      for (std::size_t i = 0; i < 3; ++i) {
        const auto& change = changes.faces[face_];
        corners[3 * change.face + i] = change.vertices[i];
        if (!wedges.empty()) wedges[3 * change.face + i] = change.wedges[i];
      }
    ++step_;
  }
  [[nodiscard]] bool at_end() const {
    return step_ == result_.history.size() && wedge_ == result_.changes.wedges.size() &&
           face_ == result_.changes.faces.size();
  }

 private:
  const Decimated& result_;
  std::size_t step_ = 0, wedge_ = 0, face_ = 0;

 public:
  std::vector<Vec3> places;                             // by vertex
  std::vector<std::uint32_t> corners, wedges;           // by corner
  std::vector<bool> there;                              // by face
  std::vector<std::vector<std::vector<float>>> values;  // by attribute and wedge
};

/// Bit for bit, corner by corner.
void check_same(const Player& player, const Decimated& result) {
  REQUIRE(static_cast<std::size_t>(std::count(player.there.begin(), player.there.end(), true)) ==
          result.mesh.face_count());
  std::size_t wrong = 0;
  for (std::size_t f = 0; f < result.mesh.face_count(); ++f) {
    const std::size_t from = result.source_face[f];
    wrong += player.there[from] ? 0 : 1;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t v = result.mesh.origins()[3 * f + i];
      const std::uint32_t source = player.corners[3 * from + i];
      wrong += result.source_vertex[v] == source ? 0 : 1;
      wrong += std::memcmp(&player.places[source], &result.positions[v], sizeof(Vec3)) == 0 ? 0 : 1;
      if (result.attributes.corners.empty()) continue;
      const std::uint32_t w = result.attributes.corners[3 * f + i];
      const std::uint32_t wedge = player.wedges[3 * from + i];
      wrong += result.attributes.source_corner[w] == wedge ? 0 : 1;
      for (std::size_t a = 0; a < player.values.size(); ++a) {
        const std::vector<float>& value = player.values[a][wedge];
        const float* const expected = &result.attributes.values[a][value.size() * w];
        wrong += std::memcmp(value.data(), expected, sizeof(float) * value.size()) == 0 ? 0 : 1;
      }
    }
  }
  CHECK(wrong == 0);
}

IndexedFaceSet shape(std::uint32_t seed) {
  IndexedFaceSet mesh = seed % 3 == 0   ? test::icosphere(2)
                        : seed % 3 == 1 ? test::torus(14, 10)
                                        : test::grid(12, 10);
  test::jitter(mesh, 0.03f, seed);
  return mesh;
}

}  // namespace

TEST_CASE("decimation: a history leads to each state on the way, with attributes, bit for bit",
          "[decimate]") {
  for (std::uint32_t seed = 0; seed < (test::kSanitized ? 3u : 9u); ++seed) {
    const Input input = with_random_seams(shape(seed), seed + 1);
    for (DecimateOptions options : ways())
      for (const bool with_attributes : {false, true}) {
        CAPTURE(seed, static_cast<int>(options.operation), with_attributes);
        options.keep_history = true;
        options.bounds.normal_deviation = 2.0;
        if (with_attributes) input.add_to(options);
        const Decimated whole = run(input.mesh, options);
        REQUIRE(whole.history.size() > 20);
        REQUIRE(whole.changes.values.size() == options.attributes.size());
        CHECK(whole.changes.faces.empty() == (options.operation != DecimateOperation::kVertexRemoval));
        CHECK(whole.changes.wedges.empty() ==
              (!with_attributes || options.operation == DecimateOperation::kVertexRemoval));
        Player player(input.mesh, options, whole);
        for (std::size_t done = 1; done <= whole.history.size(); ++done) {
          player.step();
          if (done % 16 != 1) continue;
          DecimateOptions until = options;
          until.target.vertices = input.mesh.points.size() - done;
          const Decimated part = run(input.mesh, until);
          REQUIRE(part.collapses == done);
          check_same(player, part);
        }
        CHECK(player.at_end());
        check_same(player, whole);
      }
  }
}

TEST_CASE("decimation: a point that has moved keeps its values where another joins it", "[decimate]") {
  // Tilted, so that points move by roundings; a corner is where it is whatever joins it.
  IndexedFaceSet mesh = test::fine_cube(10);
  for (Vec3& p : mesh.points)
    p = {0.48f * p.x - 0.6f * p.y + 0.64f * p.z, 0.8f * p.y + 0.36f * p.x + 0.48f * p.z,
         0.6f * p.z - 0.8f * p.x};
  std::mt19937 random(1);
  std::vector<float> values;
  for (std::size_t v = 0; v < mesh.points.size(); ++v) values.push_back(static_cast<float>(random() % 100));
  DecimateOptions options;
  options.keep_history = true;
  options.attributes = {{1, values, {}, 0.0, AttributeKind::kPlain}};
  const Decimated whole = run(mesh, options);
  Player player(mesh, options, whole);
  std::size_t joined = 0;
  for (std::size_t done = 1; done <= whole.history.size(); ++done) {
    const Collapse<Vec3>& c = whole.history[done - 1];
    const bool stays = player.places[c.kept] == c.position && c.position != mesh.points[c.kept];
    player.step();
    if (!stays) continue;
    ++joined;
    options.target.vertices = mesh.points.size() - done;
    check_same(player, run(mesh, options));
  }
  CHECK(joined > 3);
}

}  // namespace vkmesh
