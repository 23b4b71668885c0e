// vkmesh info: counts, defects and topology of a mesh.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>

#include <vkmesh/analysis/topology.h>
#include <vkmesh/math/bounds.h>
#include <vkmesh/mesh/triangulate.h>

#include "commands.h"
#include "passes/backend.h"

namespace vkmesh::cli {
namespace {

/// Sum of the areas of the triangles. O(faces).
double surface_area(const IndexedFaceSet& triangles) {
  double sum = 0;
  for (std::size_t f = 0; f < triangles.face_count(); ++f) {
    const auto face = triangles.face(f);
    const DVec3 base(triangles.points[face[0]]);
    const DVec3 a = DVec3(triangles.points[face[1]]) - base, b = DVec3(triangles.points[face[2]]) - base;
    const DVec3 twice(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    sum += std::sqrt(twice.x * twice.x + twice.y * twice.y + twice.z * twice.z) / 2;
  }
  return sum;
}

/// The signed volume inside a closed, oriented surface of triangles. O(faces).
double enclosed_volume(const IndexedFaceSet& mesh) {
  if (mesh.points.empty()) return 0;
  const DVec3 origin(mesh.points[0]);
  double sum = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(f);
    const DVec3 a = DVec3(mesh.points[face[0]]) - origin;
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      const DVec3 b = DVec3(mesh.points[face[i]]) - origin, c = DVec3(mesh.points[face[i + 1]]) - origin;
      sum += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
    }
  }
  return sum / 6;
}

Json to_json(const Topology& t) {
  return {{"points", t.points},
          {"edges", t.edges},
          {"faces", t.faces},
          {"boundary_edges", t.boundary_edges},
          {"boundary_loops", t.boundary_loops},
          {"non_manifold_edges", t.non_manifold_edges},
          {"non_manifold_vertices", t.non_manifold_vertices},
          {"misoriented_edges", t.misoriented_edges},
          {"euler_characteristic", t.euler_characteristic()},
          {"genus", t.genus ? Json(*t.genus) : Json(nullptr)},
          {"orientable", t.orientable},
          {"oriented", t.oriented()},
          {"closed", t.closed()},
          {"manifold", t.manifold()}};
}

/// What a surface is, in a few words.
std::string described(const Topology& t) {
  return std::string(t.closed() ? "closed" : count_of(t.boundary_loops, "boundary loop")) + ", " +
         (t.manifold() ? "" : "not manifold, ") + (t.orientable ? "" : "not orientable, ") +
         "Euler characteristic " + std::to_string(t.euler_characteristic()) +
         (t.genus ? ", genus " + std::to_string(*t.genus) : "");
}

/// What makes the surface no manifold, or its faces disagree.
std::string defects_of(const Topology& t, const ElementDefects& d) {
  std::string text;
  const auto add = [&](std::size_t n, const char* one, const char* many) {
    if (n > 0) text += (text.empty() ? "" : ", ") + count_of(n, one, many);
  };
  add(d.degenerate_faces, "degenerate face", "degenerate faces");
  add(d.duplicate_faces, "duplicate face", "duplicate faces");
  add(t.non_manifold_edges, "edge with three or more faces", "edges with three or more faces");
  add(t.non_manifold_vertices, "point where separate fans of faces meet",
      "points where separate fans of faces meet");
  add(t.misoriented_edges, "edge whose two faces disagree in orientation",
      "edges whose two faces disagree in orientation");
  return text;
}

/// A corner of the bounds, with as many digits as tell a thousandth of their size.
std::string triple(const DVec3& p, double size) {
  std::string text;
  for (int axis = 0; axis < 3; ++axis) {
    const double larger = std::max(std::abs(p[axis]), size);
    int digits = 3;
    if (size > 0 && larger < HUGE_VAL)
      digits = std::clamp(4 + static_cast<int>(std::floor(std::log10(larger / size))), 3, 17);
    char number[64];
    std::snprintf(number, sizeof number, "%.*g", digits, p[axis]);
    text += (axis == 0 ? "(" : ", ") + (digits > 4 ? std::string(number) : brief(p[axis]));
  }
  return text + ")";
}

std::string listed(const std::vector<Channel>& channels, const char* of) {
  std::string text;
  for (const Channel& channel : channels) text += (text.empty() ? "" : ", ") + channel.name;
  return text.empty() ? text : text + " of " + of;
}

Result<void> print_info(Job& job) {
  use_host(job);
  VKMESH_TRY(const IndexedFaceSet mesh, job.read());
  VKMESH_TRY(const SurfaceTopology topology,
             job.timed("consolidate", [&] { return surface_topology(mesh); }));
  VKMESH_TRY(const ElementDefects defects, job.timed("consolidate", [&] { return element_defects(mesh); }));
  const Topology& whole = topology.whole;
  Json& result = job.json()["result"];

  std::size_t largest = 0, triangles = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    largest = std::max(largest, mesh.face(f).size());
    triangles += mesh.face(f).size() == 3 ? 1u : 0u;
  }
  if (mesh.face_count() == 0)
    job.row("faces", "none: a point cloud");
  else if (triangles == mesh.face_count())
    job.row("faces", "triangles");
  else
    job.row("faces", count_of(triangles, "triangle") + ", " + grouped(mesh.face_count() - triangles) +
                         " of other sizes, the largest of " + count_of(largest, "corner"));
  std::string attributes;
  for (const std::string& part :
       {listed(mesh.point_channels, "points"), listed(mesh.corner_channels, "corners"),
        listed(mesh.face_channels, "faces")})
    if (!part.empty()) attributes += (attributes.empty() ? "" : "; ") + part;
  job.row("attributes", attributes.empty() ? "none" : attributes);
  job.row("edges", grouped(whole.edges) + ", " + grouped(whole.boundary_edges) + " on the boundary");
  if (defects.isolated_points > 0)
    job.row("isolated", count_of(defects.isolated_points, "point") + " that no face uses");
  if (defects.duplicate_points > 0)
    job.row("duplicates", count_of(defects.duplicate_points, "point") +
                              " with the coordinates of another (convert --weld 0 joins them)");

  // The file as it was read: its faces all count, the surface is that of the sound ones.
  result = to_json(whole);
  result["points"] = mesh.points.size();
  result["faces"] = mesh.face_count();
  result["triangles"] = triangles;
  result["largest_face"] = largest;
  result["components"] = topology.components.size();
  const bool manifold = whole.manifold() && defects.degenerate_faces == 0;
  result["manifold"] = manifold;
  result["degenerate_faces"] = defects.degenerate_faces;
  result["duplicate_faces"] = defects.duplicate_faces;
  result["duplicate_points"] = defects.duplicate_points;
  result["isolated_points"] = defects.isolated_points;
  result["component_topology"] = Json::array();
  for (const Topology& t : topology.components) result["component_topology"].push_back(to_json(t));

  if (mesh.face_count() > 0) {
    const std::string odd = defects_of(whole, defects);
    job.row("manifold", std::string(manifold ? "yes" : "no") +
                            (whole.oriented() ? ", compatibly oriented" : "") +
                            (odd.empty() ? "" : ": " + odd));
    job.row("topology", count_of(topology.components.size(), "component") + ", " + described(whole) +
                            (defects.isolated_points > 0 ? " (isolated points aside)" : ""));
    constexpr std::size_t kShown = 8;
    if (topology.components.size() > 1)
      for (std::size_t i = 0; i < std::min(kShown, topology.components.size()); ++i)
        job.row("",
                count_of(topology.components[i].faces, "face") + ": " + described(topology.components[i]));
    if (topology.components.size() > kShown)
      job.row("", "and " + grouped(topology.components.size() - kShown) + " more (--json lists them)");
  }

  // Polygons that are not flat have the area of the triangles that every command cuts them into.
  IndexedFaceSet cut;
  if (!mesh.is_triangles()) {
    VKMESH_TRY(Triangulated triangulated, job.timed("compute", [&] { return triangulate(mesh); }));
    cut = std::move(triangulated.mesh);
  }
  const IndexedFaceSet& surface = mesh.is_triangles() ? mesh : cut;
  const double area = surface_area(surface);
  result["area"] = area;
  result["volume"] = nullptr;
  if (whole.closed() && whole.oriented() && defects.degenerate_faces == 0) {
    const double volume = enclosed_volume(surface);
    result["volume"] = volume;
    job.row("volume", brief(volume));
  }
  result["bounds"] = nullptr;
  if (!mesh.points.empty()) {
    const auto [low, high] = bounds_of(mesh.points);
    if (job.offset() == DVec3(0.0)) {
      result["bounds"] = {{"min", {low.x, low.y, low.z}}, {"max", {high.x, high.y, high.z}}};
    } else {
      const DVec3 exact_low = DVec3(low) + job.offset(), exact_high = DVec3(high) + job.offset();
      result["bounds"] = {{"min", {exact_low.x, exact_low.y, exact_low.z}},
                          {"max", {exact_high.x, exact_high.y, exact_high.z}}};
    }
    const DVec3 extent = DVec3(high) - DVec3(low);
    const double size = std::max({extent.x, extent.y, extent.z});
    job.row("bounds",
            triple(DVec3(low) + job.offset(), size) + " to " + triple(DVec3(high) + job.offset(), size));
  }
  job.row("area", brief(area));
  return {};
}

}  // namespace

void add_info(CLI::App& app, Program& program) {
  CLI::App* command = app.add_subcommand("info", "Counts, defects and topology of a mesh");
  command->footer(
      "Any mesh that can be read is described, a defective one too; the exit code is then still 0.\n"
      "Components are edge-connected faces. The Euler characteristic v - e + f leaves "
      "isolated points aside;\nthe genus of several components is the sum of theirs. STL has no shared "
      "points: "
      "equal corners are one.\n\n"
      "Example:\n  vkmesh info data/dragon/dragon_vrip.ply.gz");
  add_common_options(*command, program.options, true, false);
  command->callback([&program] {
    program.command = "info";
    program.action = print_info;
  });
}

}  // namespace vkmesh::cli
