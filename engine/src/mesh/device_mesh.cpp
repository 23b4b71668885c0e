#include <cstring>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/math/arithmetic.h>
#include <vkmesh/mesh/vertex_corners.h>

namespace vkmesh {
namespace {

/// Kernels load one element even of an empty list (of faces: its corners), and drop it.
constexpr std::uint64_t kOneElement = 1;

bool needs_neighbours(const MeshPasses& p) {
  return p.laplacian_smoothing || p.curvatures;
}
bool needs_vertex_corners(const MeshPasses& p) {
  return p.vertex_normals || p.dihedral_angles || p.collapse_costs;
}
bool needs_twins(const MeshPasses& p) {
  return p.dihedral_angles || p.collapse_costs || p.swap_scores;
}
bool needs_measures(const MeshPasses& p) {
  return p.surface_measures || p.restore_volume;
}
bool needs_corners(const MeshPasses& p) {
  return needs_vertex_corners(p) || needs_twins(p) || needs_measures(p) || p.triangle_normals ||
         p.bilateral_smoothing;
}

/// Bytes of each buffer of a DeviceMesh; 0 for those that no pass asks for.
struct Sizes {
  std::uint64_t positions = 0, smoothed_positions = 0, corners = 0, twins = 0, neighbour_offsets = 0,
                neighbour_ids = 0, boundary_bits = 0, locked_bits = 0, corner_offsets = 0,
                corner_half_edges = 0, face_vectors = 0, triangle_normals = 0, vertex_normals = 0,
                half_edge_angles = 0, vertex_maxima = 0, curvatures = 0, surface_measures = 0,
                volume_before = 0, quadrics = 0, collapse_costs = 0, swap_scores = 0, block_sums = 0,
                more_block_sums = 0;

  Sizes(const HalfEdgeMesh& mesh, const MeshPasses& passes, std::uint64_t directed_edges) {
    const std::uint64_t vertices = mesh.vertex_count(), half_edges = mesh.half_edge_count();
    const std::uint64_t faces = std::max<std::uint64_t>(mesh.face_count(), kOneElement);
    const std::uint64_t per_half_edge = 4 * std::max(half_edges, 3 * kOneElement);
    positions = 12 * vertices;
    if (needs_corners(passes)) corners = per_half_edge;
    if (needs_twins(passes)) twins = 4 * half_edges;
    if (needs_vertex_corners(passes)) {
      corner_offsets = 4 * (vertices + 1);
      corner_half_edges = 4 * std::max(half_edges, kOneElement);
    }
    if (needs_neighbours(passes)) {
      neighbour_offsets = 4 * (vertices + 1);
      neighbour_ids = 4 * std::max(directed_edges, kOneElement);
      boundary_bits = 4 * ((vertices + 31) / 32);
    }
    if (needs_measures(passes)) {
      surface_measures = sizeof(RawMeasures);
      // The larger of bounds and sums; the next level takes a 64th.
      const std::uint64_t blocks =
          std::max<std::uint64_t>(vertices, mesh.face_count()) / VKMESH_SUM_BLOCK + kOneElement;
      block_sums = 24 * blocks;
      more_block_sums = 24 * (blocks / VKMESH_SUM_BLOCK + kOneElement);
    }
    if (passes.laplacian_smoothing) {
      smoothed_positions = positions;
      locked_bits = 4 * ((vertices + 31) / 32);
    }
    if (passes.vertex_normals || passes.dihedral_angles) face_vectors = 12 * faces;
    if (passes.triangle_normals) triangle_normals = 12 * faces;
    if (passes.vertex_normals) vertex_normals = positions;
    if (passes.dihedral_angles) {
      half_edge_angles = per_half_edge;
      vertex_maxima = 4 * vertices;
    }
    if (passes.curvatures) curvatures = 16 * vertices;
    if (passes.restore_volume) volume_before = sizeof(RawMeasures);
    if (passes.collapse_costs) {
      quadrics = 24 * vertices;
      collapse_costs = per_half_edge;
    }
    if (passes.swap_scores) swap_scores = per_half_edge;
  }

  [[nodiscard]] std::uint64_t total() const {
    return positions + smoothed_positions + corners + twins + neighbour_offsets + neighbour_ids +
           boundary_bits + locked_bits + corner_offsets + corner_half_edges + face_vectors +
           triangle_normals + vertex_normals + half_edge_angles + vertex_maxima + curvatures +
           surface_measures + volume_before + quadrics + collapse_costs + swap_scores + block_sums +
           more_block_sums;
  }
};

/// Offsets of lists that a thread goes through, one for each vertex.
Result<void> require_short(const Context& context, const std::vector<std::uint32_t>& offsets) {
  for (std::size_t v = 0; v + 1 < offsets.size(); ++v)
    if (offsets[v + 1] - offsets[v] >= context.info().loop_rounds)
      return fail(ErrorCode::kUnsuitable, "vertex " + std::to_string(v) + " has " +
                                              std::to_string(offsets[v + 1] - offsets[v]) +
                                              " neighbours, too many for the loops of " +
                                              context.info().name + ": compute on the CPU");
  return {};
}

Result<void> make(Context& context, Buffer& buffer, std::uint64_t bytes, const char* name) {
  if (bytes == 0) return {};
  VKMESH_TRY(buffer, Buffer::create(context, bytes, BufferMemory::kDevice, name));
  return {};
}

Result<void> fill(Context& context, Buffer& buffer, std::uint64_t bytes, const char* name,
                  std::span<const std::uint32_t> values) {
  if (bytes == 0) return {};
  VKMESH_CHECK(make(context, buffer, bytes, name));
  if (!values.empty()) return buffer.upload_values(values);
  return buffer.upload_values<std::uint32_t>(std::vector<std::uint32_t>(bytes / 4, 0u));
}

template <class T>
Result<std::vector<T>> values_of(const Buffer& buffer, std::size_t count, bool made, const char* pass) {
  if (!made) return fail(ErrorCode::kUsage, std::string("the mesh was not made for the pass ") + pass);
  return detail::catching([&]() -> Result<std::vector<T>> {
    std::vector<T> values(count);
    VKMESH_CHECK(buffer.download_values<T>(values));
    return values;
  });
}

}  // namespace

std::uint64_t DeviceMesh::estimate_memory(const HalfEdgeMesh& mesh, const MeshPasses& passes) {
  // Each boundary half-edge stands for two directed edges.
  const std::uint64_t directed =
      needs_neighbours(passes) ? mesh.half_edge_count() + mesh.boundary_half_edge_count() : 0;
  return Sizes(mesh, passes, directed).total();
}

Result<DeviceMesh> DeviceMesh::create(Context& context, const HalfEdgeMesh& mesh,
                                      std::span<const Vec3> positions, const MeshPasses& passes) {
  return detail::catching([&]() -> Result<DeviceMesh> {
    if (!mesh.is_triangles())
      return fail(ErrorCode::kUnsuitable, "a device takes triangles only: triangulate the polygons first");
    DeviceMesh result;
    result.vertices_ = static_cast<std::uint32_t>(mesh.vertex_count());
    result.faces_ = static_cast<std::uint32_t>(mesh.face_count());
    result.closed_ = mesh.boundary_half_edge_count() == 0;
    result.passes_ = passes;

    NodeNeighbours neighbours;
    if (needs_neighbours(passes)) {
      VKMESH_TRY(neighbours, node_neighbours(mesh));
    }
    VertexCorners corners;
    if (needs_vertex_corners(passes)) {
      VKMESH_TRY(corners, vertex_corners(mesh));
    }
    VKMESH_CHECK(require_short(context, neighbours.offsets));
    VKMESH_CHECK(require_short(context, corners.offsets));
    const Sizes bytes(mesh, passes, neighbours.ids.size());
    VKMESH_CHECK(make(context, result.positions_, bytes.positions, "positions"));
    VKMESH_CHECK(result.upload_positions(positions));
    VKMESH_CHECK(make(context, result.smoothed_positions_, bytes.smoothed_positions, "smoothed positions"));
    VKMESH_CHECK(fill(context, result.corners_, bytes.corners, "corners", mesh.origins()));
    VKMESH_CHECK(fill(context, result.twins_, bytes.twins, "twins", mesh.twins()));
    VKMESH_CHECK(fill(context, result.neighbour_offsets_, bytes.neighbour_offsets, "neighbour offsets",
                      neighbours.offsets));
    VKMESH_CHECK(fill(context, result.neighbour_ids_, bytes.neighbour_ids, "neighbour ids", neighbours.ids));
    VKMESH_CHECK(
        fill(context, result.boundary_bits_, bytes.boundary_bits, "boundary bits", neighbours.boundary_bits));
    VKMESH_CHECK(fill(context, result.locked_bits_, bytes.locked_bits, "locked bits", {}));
    VKMESH_CHECK(
        fill(context, result.corner_offsets_, bytes.corner_offsets, "corner offsets", corners.offsets));
    VKMESH_CHECK(fill(context, result.corner_half_edges_, bytes.corner_half_edges, "corner half-edges",
                      corners.half_edges));
    VKMESH_CHECK(make(context, result.face_vectors_, bytes.face_vectors, "face vectors"));
    VKMESH_CHECK(make(context, result.triangle_normals_, bytes.triangle_normals, "triangle normals"));
    VKMESH_CHECK(make(context, result.vertex_normals_, bytes.vertex_normals, "vertex normals"));
    VKMESH_CHECK(make(context, result.half_edge_angles_, bytes.half_edge_angles, "half-edge angles"));
    VKMESH_CHECK(make(context, result.vertex_maxima_, bytes.vertex_maxima, "vertex maxima"));
    VKMESH_CHECK(make(context, result.curvatures_, bytes.curvatures, "curvatures"));
    VKMESH_CHECK(make(context, result.surface_measures_, bytes.surface_measures, "surface measures"));
    VKMESH_CHECK(make(context, result.volume_before_, bytes.volume_before, "volume before"));
    VKMESH_CHECK(make(context, result.quadrics_, bytes.quadrics, "quadrics"));
    VKMESH_CHECK(make(context, result.collapse_costs_, bytes.collapse_costs, "collapse costs"));
    VKMESH_CHECK(make(context, result.swap_scores_, bytes.swap_scores, "swap scores"));
    VKMESH_CHECK(make(context, result.block_sums_, bytes.block_sums, "block sums"));
    VKMESH_CHECK(make(context, result.more_block_sums_, bytes.more_block_sums, "more block sums"));
    return result;
  });
}

Result<void> DeviceMesh::upload_positions(std::span<const Vec3> positions) {
  return detail::catching([&]() -> Result<void> {
    if (positions.size() != vertices_)
      return fail(ErrorCode::kUsage, std::to_string(positions.size()) + " positions for " +
                                         std::to_string(vertices_) + " vertices");
    // Prepared apart, so that refused positions leave those of the device as they were.
    std::vector<Vec3> prepared(positions.size());
    VKMESH_CHECK(prepare_positions(positions, prepared));
    return positions_.upload_values<Vec3>(prepared);
  });
}

Result<void> DeviceMesh::upload_locks(std::span<const std::uint32_t> locked) {
  if (!passes_.laplacian_smoothing)
    return fail(ErrorCode::kUsage, "the mesh was not made for the pass laplacian_smoothing");
  if (locked.size_bytes() != locked_bits_.size())
    return fail(ErrorCode::kUsage, std::to_string(locked.size()) + " words of locked vertices, not " +
                                       std::to_string(locked_bits_.size() / 4));
  return locked_bits_.upload_values(locked);
}

Result<std::vector<Vec3>> DeviceMesh::download_positions() const {
  return values_of<Vec3>(positions_, vertices_, true, "");
}

Result<std::vector<Vec3>> DeviceMesh::download_vertex_normals() const {
  return values_of<Vec3>(vertex_normals_, vertices_, passes_.vertex_normals, "vertex_normals");
}

Result<std::vector<Vec3>> DeviceMesh::download_triangle_normals() const {
  return values_of<Vec3>(triangle_normals_, faces_, passes_.triangle_normals, "triangle_normals");
}

Result<std::vector<float>> DeviceMesh::download_half_edge_angles() const {
  return values_of<float>(half_edge_angles_, half_edge_count(), passes_.dihedral_angles, "dihedral_angles");
}

Result<std::vector<VertexCurvature>> DeviceMesh::download_curvatures() const {
  return values_of<VertexCurvature>(curvatures_, vertices_, passes_.curvatures, "curvatures");
}

Result<SurfaceMeasures> DeviceMesh::download_surface_measures() const {
  VKMESH_TRY(const std::vector<RawMeasures> raw,
             values_of<RawMeasures>(surface_measures_, 1, passes_.surface_measures, "surface_measures"));
  return to_surface_measures(raw[0]);
}

Result<std::vector<float>> DeviceMesh::download_vertex_maxima() const {
  return values_of<float>(vertex_maxima_, vertices_, passes_.dihedral_angles, "dihedral_angles");
}

Result<std::vector<VertexQuadric>> DeviceMesh::download_quadrics() const {
  return values_of<VertexQuadric>(quadrics_, vertices_, passes_.collapse_costs, "collapse_costs");
}

Result<std::vector<float>> DeviceMesh::download_collapse_costs() const {
  return values_of<float>(collapse_costs_, half_edge_count(), passes_.collapse_costs, "collapse_costs");
}

Result<std::vector<float>> DeviceMesh::download_swap_scores() const {
  return values_of<float>(swap_scores_, half_edge_count(), passes_.swap_scores, "swap_scores");
}

}  // namespace vkmesh
