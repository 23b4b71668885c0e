#include <string>
#include <vector>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/engine/mesh/device_mesh.h>
#include <vkmesh/math/arithmetic.h>
#include <vkmesh/mesh/node_neighbours.h>
#include <vkmesh/mesh/vertex_corners.h>

namespace vkmesh {
namespace {

using Array = DeviceArray<std::uint32_t>;

Result<void> fill(Context& context, Array& array, std::span<const std::uint32_t> values, const char* name) {
  // Kernels load one element even of an empty list (of faces: its corners), and drop it.
  static constexpr std::uint32_t kNothing[3] = {};
  return array.upload(context, values.empty() ? kNothing : values, name);
}

/// The array, after `upload` where it is not there yet.
template <class Upload>
DeviceMesh::Indices once(const Context& context, const Array& array, Upload&& upload) {
  if (!array.exists_in(context)) VKMESH_CHECK(detail::catching(upload));
  return &array;
}

/// Offsets of lists that a thread goes through, one for each vertex.
Result<void> require_short(const Context& context, std::span<const std::uint32_t> offsets) {
  for (std::size_t v = 0; v + 1 < offsets.size(); ++v)
    if (offsets[v + 1] - offsets[v] >= context.info().loop_rounds)
      return fail(ErrorCode::kUnsuitable, "vertex " + std::to_string(v) + " has " +
                                              std::to_string(offsets[v + 1] - offsets[v]) +
                                              " neighbours, too many for the loops of " +
                                              context.info().name + ": compute on the CPU");
  return {};
}

}  // namespace

Result<DeviceMesh> DeviceMesh::create(Context& context, const HalfEdgeMesh& mesh,
                                      std::span<const Vec3> positions) {
  if (!mesh.is_triangles())
    return fail(ErrorCode::kUnsuitable, "a device takes triangles only: triangulate the polygons first");
  return detail::catching([&]() -> Result<DeviceMesh> {
    DeviceMesh result;
    result.context_ = std::make_shared<Context>(context.shared_device());
    result.mesh_ = &mesh;
    result.vertices_ = static_cast<std::uint32_t>(mesh.vertex_count());
    result.faces_ = static_cast<std::uint32_t>(mesh.face_count());
    result.closed_ = mesh.boundary_half_edge_count() == 0;
    VKMESH_CHECK(result.upload_positions(positions));
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
    return positions_.upload(*context_, prepared, "positions");
  });
}

DeviceMesh::Indices DeviceMesh::corners() {
  return once(*context_, corners_, [&] { return fill(*context_, corners_, mesh_->origins(), "corners"); });
}

DeviceMesh::Indices DeviceMesh::twins() {
  return once(*context_, twins_, [&] { return fill(*context_, twins_, mesh_->twins(), "twins"); });
}

DeviceMesh::Indices DeviceMesh::leading() {
  return once(*context_, leading_,
              [&] { return fill(*context_, leading_, mesh_->leadings(), "leading half-edges"); });
}

Result<void> DeviceMesh::upload_corners_of_vertices() {
  VKMESH_TRY(const VertexCorners corners, vertex_corners(*mesh_));
  VKMESH_CHECK(require_short(*context_, corners.offsets));
  VKMESH_CHECK(fill(*context_, corner_offsets_, corners.offsets, "corner offsets"));
  return fill(*context_, corner_half_edges_, corners.half_edges, "corner half-edges");
}

DeviceMesh::Indices DeviceMesh::corner_offsets() {
  return once(*context_, corner_offsets_, [&] { return upload_corners_of_vertices(); });
}

DeviceMesh::Indices DeviceMesh::corner_half_edges() {
  return once(*context_, corner_half_edges_, [&] { return upload_corners_of_vertices(); });
}

Result<void> DeviceMesh::upload_neighbours() {
  VKMESH_TRY(const NodeNeighbours neighbours, node_neighbours(*mesh_));
  VKMESH_CHECK(require_short(*context_, neighbours.offsets));
  VKMESH_CHECK(fill(*context_, neighbour_offsets_, neighbours.offsets, "neighbour offsets"));
  VKMESH_CHECK(fill(*context_, neighbour_ids_, neighbours.ids, "neighbour ids"));
  return fill(*context_, boundary_bits_, neighbours.boundary_bits, "boundary bits");
}

DeviceMesh::Indices DeviceMesh::neighbour_offsets() {
  return once(*context_, neighbour_offsets_, [&] { return upload_neighbours(); });
}

DeviceMesh::Indices DeviceMesh::neighbour_ids() {
  return once(*context_, neighbour_ids_, [&] { return upload_neighbours(); });
}

DeviceMesh::Indices DeviceMesh::boundary_bits() {
  return once(*context_, boundary_bits_, [&] { return upload_neighbours(); });
}

}  // namespace vkmesh
