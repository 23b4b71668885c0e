#include "decimation/setup/initial_quadrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "simd/target_clones.h"
#include "simd/transpose.h"

namespace vkmesh::detail {
namespace {

/// What a plane through a vertex adds to its quadric: its weight, and w n nᵀ. With a 0 more these are the
/// words of a VertexRecord from `weight` to `c`.
using PlaneWords = std::array<float, 8>;
static_assert(offsetof(VertexRecord, weight) == 16 && offsetof(VertexRecord, a) == 20 &&
              offsetof(VertexRecord, c) == 44);

[[gnu::always_inline]] inline PlaneWords words_of(float x, float y, float z, float w) {
  const float wx = w * x, wy = w * y, wz = w * z;
  return {w, wx * x, wx * y, wx * z, wy * y, wy * z, wz * z, 0.0f};
}

[[gnu::always_inline]] inline void add_words(VertexRecord& v, const PlaneWords& words) {
  char* const to = reinterpret_cast<char*>(&v) + offsetof(VertexRecord, weight);
  add_four(words.data(), to);
  add_four(words.data() + 4, to + 16);
}

/// Some faces, one a lane: their corners, and the planes in which they lie.
struct FaceBatch {
  static constexpr std::size_t kSize = 64;
  using Lanes = std::array<float, kSize>;
  alignas(64) std::array<std::array<Lanes, 4>, 3> corner;  // x, y, z and what follows it
  alignas(64) std::array<Lanes, 8> words;
  alignas(64) std::array<PlaneWords, kSize> planes;
};

/// The planes, weighted by half the area; nothing for a face of no area.
VKMESH_CLONES void find_planes(FaceBatch& batch) {
  const auto& [a, b, c] = batch.corner;
  for (std::size_t i = 0; i < FaceBatch::kSize; ++i) {
    const float sx = b[0][i] - a[0][i], sy = b[1][i] - a[1][i], sz = b[2][i] - a[2][i];
    const float rx = c[0][i] - b[0][i], ry = c[1][i] - b[1][i], rz = c[2][i] - b[2][i];
    const float nx = sy * rz - sz * ry, ny = sz * rx - sx * rz, nz = sx * ry - sy * rx;
    const float length = std::sqrt(nx * nx + ny * ny + nz * nz);
    const float by = length > 0 ? length : 1.0f;
    const PlaneWords words = words_of(nx / by, ny / by, nz / by, 0.5f * length);
    for (std::size_t k = 0; k < 8; ++k) batch.words[k][i] = words[k];
  }
}

void add_faces(CollapseMesh& mesh, const VertexRanges::Range& range) {
  constexpr std::uint32_t kAhead = 16;
  const auto last = static_cast<std::uint32_t>(mesh.face_count()) - 1;
  VertexRecord* const vertices = mesh.vertices.data();
  FaceBatch batch;
  range.for_each_range([&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t first = begin; first < end; first += FaceBatch::kSize) {
      const std::uint32_t count = std::min<std::uint32_t>(end - first, FaceBatch::kSize);
      for (std::uint32_t i = 0; i < count; i += 4) {
        std::array<std::array<const void*, 4>, 3> rows;
        for (std::uint32_t k = 0; k < 4; ++k) {
          const std::uint32_t f = first + std::min(i + k, count - 1);
          prefetch_stream(&mesh.face(4 * f));
          for (const std::uint32_t v : mesh.face(4 * std::min(f + kAhead, last)).origin)
            prefetch(&vertices[v]);
          for (std::size_t corner = 0; corner < 3; ++corner)
            rows[corner][k] = &vertices[mesh.face(4 * f).origin[corner]];
        }
        for (std::size_t corner = 0; corner < 3; ++corner) {
          auto& to = batch.corner[corner];
          turn_four(rows[corner], {&to[0][i], &to[1][i], &to[2][i], &to[3][i]});
        }
      }
      find_planes(batch);
      for (std::uint32_t i = 0; i < count; i += 4)
        for (std::size_t half = 0; half < 8; half += 4)
          turn_four({&batch.words[half][i], &batch.words[half + 1][i], &batch.words[half + 2][i],
                     &batch.words[half + 3][i]},
                    {&batch.planes[i][half], &batch.planes[i + 1][half], &batch.planes[i + 2][half],
                     &batch.planes[i + 3][half]});
      for (std::uint32_t i = 0; i < count; ++i)
        for (const std::uint32_t v : mesh.face(4 * (first + i)).origin)
          if (range.has(v)) add_words(vertices[v], batch.planes[i]);
    }
  });
}

struct AreaVector {
  std::array<float, 3> twice;
  float length;
};
AreaVector area_of(const CollapseMesh& mesh, const CollapseMesh::Face& face) {
  const auto &a = mesh.vertices[face.origin[0]].position, &b = mesh.vertices[face.origin[1]].position,
             &c = mesh.vertices[face.origin[2]].position;
  const std::array<float, 3> s = {b[0] - a[0], b[1] - a[1], b[2] - a[2]},
                             r = {c[0] - b[0], c[1] - b[1], c[2] - b[2]};
  const std::array<float, 3> n = {s[1] * r[2] - s[2] * r[1], s[2] * r[0] - s[0] * r[2],
                                  s[0] * r[1] - s[1] * r[0]};
  return {n, std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])};
}

/// Of the plane that stands on an edge between two faces; 0: none does.
float constraint(const CollapseMesh& mesh, std::uint32_t h, const ConstraintWeights& weights) {
  const float seam = weights.seam > 0 && weights.wedges->is_seam(mesh, h) ? weights.seam : 0.0f;
  if (!(weights.crease > 0)) return seam;
  const AreaVector one = area_of(mesh, mesh.face(h)), other = area_of(mesh, mesh.face(mesh.twin(h)));
  float along = 0;
  for (std::size_t k = 0; k < 3; ++k) along += one.twice[k] / one.length * other.twice[k];
  return along < weights.crease_cosine * other.length ? std::max(seam, weights.crease) : seam;
}

/// The plane that stands on a half-edge, perpendicular to its face.
void add_constraint(CollapseMesh& mesh, const VertexRanges::Range& range, std::uint32_t h, float weight) {
  const std::uint32_t from = mesh.origin(h), to = mesh.target(h);
  if (!(weight > 0) || (!range.has(from) && !range.has(to))) return;
  const AreaVector area = area_of(mesh, mesh.face(h));
  const auto &a = mesh.vertices[from].position, &b = mesh.vertices[to].position;
  const std::array<float, 3> e = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  const float squared = e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
  if (!(area.length > 0) || !(squared > 0)) return;
  std::array<float, 3> n = area.twice;
  for (float& x : n) x /= area.length;
  const float root = std::sqrt(squared);
  const PlaneWords words = words_of((e[1] * n[2] - e[2] * n[1]) / root, (e[2] * n[0] - e[0] * n[2]) / root,
                                    (e[0] * n[1] - e[1] * n[0]) / root, weight * squared);
  for (const std::uint32_t v : {from, to})
    if (range.has(v)) add_words(mesh.vertices[v], words);
}

}  // namespace

void sum_quadrics(CollapseMesh& mesh, const ConstraintWeights& weights) {
  mesh.vertex_ranges().for_each([&](const VertexRanges::Range& range) {
    add_faces(mesh, range);
    if (weights.boundary > 0)
      for (std::size_t g = 4 * mesh.face_count(); g < mesh.half_edge_bound(); g += 4)
        add_constraint(mesh, range, mesh.twin(static_cast<std::uint32_t>(g)), weights.boundary);
    if (weights.crease > 0 || weights.seam > 0)
      range.for_each_face([&](std::uint32_t f) {
        for (std::uint32_t h = 4 * f; h < 4 * f + 3; ++h)
          if (!mesh.is_ghost(mesh.twin(h))) add_constraint(mesh, range, h, constraint(mesh, h, weights));
      });
  });
}

}  // namespace vkmesh::detail
