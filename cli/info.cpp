// vkmesh info: counts, defects and topology of a mesh.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>

#include "backend.h"
#include "commands.h"

namespace vkmesh::cli {
namespace {

/// Pieces of the surface: sets of faces that are joined through shared points. O(corners · α).
std::size_t component_count(const IndexedFaceSet& mesh) {
  std::vector<std::uint32_t> parent(mesh.points.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t p) {
    while (parent[p] != p) p = parent[p] = parent[parent[p]];
    return p;
  };
  std::vector<bool> used(mesh.points.size(), false);
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    for (const std::uint32_t corner : mesh.face(f)) {
      used[corner] = true;
      parent[root(corner)] = root(mesh.face(f)[0]);
    }
  std::size_t count = 0;
  for (std::uint32_t p = 0; p < parent.size(); ++p) count += used[p] && parent[p] == p ? 1u : 0u;
  return count;
}

/// Sum of the areas of the faces, each by its Newell vector. O(corners).
double surface_area(const IndexedFaceSet& mesh) {
  double sum = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(f);
    if (face.size() < 3) continue;
    const DVec3 base(mesh.points[face[0]]);
    DVec3 twice(0.0);
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      const DVec3 a = DVec3(mesh.points[face[i]]) - base;
      const DVec3 b = DVec3(mesh.points[face[i + 1]]) - base;
      twice += DVec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    }
    sum += std::sqrt(twice.x * twice.x + twice.y * twice.y + twice.z * twice.z) / 2;
  }
  return sum;
}

struct Topology {
  std::size_t components = 0;
  std::size_t boundary_loops = 0;
  std::int64_t euler = 0;
  std::optional<std::int64_t> genus;
};

Result<Topology> topology_of(const IndexedFaceSet& mesh, const ConsolidateReport& report) {
  VKMESH_TRY(const Consolidated consolidated, consolidate(mesh));
  Topology t;
  t.components = component_count(mesh);
  t.boundary_loops = consolidated.mesh.boundary_loops().size();
  t.euler = static_cast<std::int64_t>(report.points - report.isolated_points) -
            static_cast<std::int64_t>(report.edges) + static_cast<std::int64_t>(report.faces);
  if (t.components == 1 && t.boundary_loops == 0) t.genus = (2 - t.euler) / 2;
  return t;
}

std::string triple(const Vec3& p) {
  return "(" + brief(static_cast<double>(p.x)) + ", " + brief(static_cast<double>(p.y)) + ", " +
         brief(static_cast<double>(p.z)) + ")";
}

std::string listed(const std::vector<Channel>& channels, const char* of) {
  std::string text;
  for (const Channel& channel : channels) text += (text.empty() ? "" : ", ") + channel.name;
  return text.empty() ? text : text + " of " + of;
}

Result<void> run(Job& job) {
  use_host(job);
  VKMESH_TRY(const IndexedFaceSet mesh, job.read());
  VKMESH_TRY(const ConsolidateReport report, job.timed("consolidate", [&] { return survey(mesh); }));
  job.json()["report"] = to_json(report);
  Json& result = job.json()["result"];

  std::size_t largest = 0, triangles = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    largest = std::max(largest, mesh.face(f).size());
    triangles += mesh.face(f).size() == 3 ? 1u : 0u;
  }
  result["triangles"] = triangles;
  result["largest_face"] = largest;
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
  job.row("edges", grouped(report.edges) + ", " + grouped(report.boundary_edges) + " on the boundary");
  if (report.isolated_points > 0)
    job.row("isolated", count_of(report.isolated_points, "point") + " that no face uses");

  for (const char* name : {"components", "boundary_loops", "euler_characteristic", "genus"})
    result[name] = nullptr;
  if (report.manifold()) {
    VKMESH_TRY(const Topology t, job.timed("consolidate", [&] { return topology_of(mesh, report); }));
    result["components"] = t.components;
    result["boundary_loops"] = t.boundary_loops;
    result["euler_characteristic"] = t.euler;
    if (t.genus) result["genus"] = *t.genus;
    job.row("manifold", "yes, compatibly oriented");
    job.row("topology", count_of(t.components, "component") + ", " +
                            count_of(t.boundary_loops, "boundary loop") + ", Euler characteristic " +
                            std::to_string(t.euler) +
                            (report.isolated_points > 0 ? " (isolated points aside)" : "") +
                            (t.genus ? ", genus " + std::to_string(*t.genus) : ""));
  } else {
    job.row("manifold", "no: " + report.defects);
  }

  const double area = surface_area(mesh);
  result["area"] = area;
  result["bounds"] = nullptr;
  if (!mesh.points.empty()) {
    Vec3 low = mesh.points[0], high = mesh.points[0];
    for (const Vec3& p : mesh.points) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    result["bounds"] = {{"min", {low.x, low.y, low.z}}, {"max", {high.x, high.y, high.z}}};
    job.row("bounds", triple(low) + " to " + triple(high));
  }
  job.row("area", brief(area));
  return {};
}

}  // namespace

void add_info(CLI::App& app, Program& program) {
  CLI::App* command = app.add_subcommand("info", "Counts, defects and topology of a mesh");
  command->footer(
      "Any mesh that can be read is described, a defective one too; the exit code is then still 0.\n"
      "The Euler characteristic v - e + f leaves isolated points aside; the genus is that of a closed mesh "
      "of one "
      "component.\n\n"
      "Example:\n  vkmesh info data/dragon/dragon_vrip.ply.gz");
  add_common_options(*command, program.options, true, false);
  command->callback([&program] {
    program.command = "info";
    program.action = run;
  });
}

}  // namespace vkmesh::cli
