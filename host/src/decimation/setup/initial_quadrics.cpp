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
static_assert(offsetof(VertexRecord, weight) == 16 && offsetof(VertexRecord, quadric.a) == 20 &&
              offsetof(VertexRecord, quadric.c) == 44);

[[gnu::always_inline]] inline PlaneWords words_of(const Vector3& normal, float w) {
  const Symmetric3 a = plane_quadric<HostArithmetic>(normal, w);
  return {w, a[0], a[1], a[2], a[3], a[4], a[5], 0.0f};
}

[[gnu::always_inline]] inline void add_words(VertexRecord& v, const PlaneWords& words) {
  char* const to = reinterpret_cast<char*>(&v) + offsetof(VertexRecord, weight);
  add_4(words.data(), to);
  add_4(words.data() + 4, to + 16);
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
  const auto at = [&](std::size_t corner, std::size_t i) __attribute__((always_inline)) {
    const auto& [x, y, z, rest] = batch.corner[corner];
    return Vector3{x[i], y[i], z[i]};
  };
  for (std::size_t i = 0; i < FaceBatch::kSize; ++i) {
    const Vector3 a = at(0, i), b = at(1, i), c = at(2, i);
    const Vector3 n = cross(minus(b, a), minus(c, b));
    const float length = std::sqrt(dot(n, n));
    const float by = length > 0 ? length : 1.0f;
    const PlaneWords words = words_of({n[0] / by, n[1] / by, n[2] / by}, 0.5f * length);
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
          transpose_4x4(rows[corner], {&to[0][i], &to[1][i], &to[2][i], &to[3][i]});
        }
      }
      find_planes(batch);
      for (std::uint32_t i = 0; i < count; i += 4)
        for (std::size_t half = 0; half < 8; half += 4)
          transpose_4x4({&batch.words[half][i], &batch.words[half + 1][i], &batch.words[half + 2][i],
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
  Vector3 twice;
  float length;
};
AreaVector area_of(const CollapseMesh& mesh, const CollapseMesh::Face& face) {
  const auto at = [&](std::size_t i) { return mesh.vertices[face.origin[i]].position; };
  const Vector3 n = cross(minus(at(1), at(0)), minus(at(2), at(1)));
  return {n, std::sqrt(dot(n, n))};
}

/// The weight of the plane that stands on an edge between two faces; 0 where none does.
float constraint(const CollapseMesh& mesh, std::uint32_t h, const ConstraintWeights& weights) {
  const float seam = weights.seam > 0 && weights.wedges->holds_shape(mesh, h) ? weights.seam : 0.0f;
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
  const Vector3 e = minus(mesh.vertices[to].position, mesh.vertices[from].position);
  const float squared = dot(e, e);
  if (!(area.length > 0) || !(squared > 0)) return;
  Vector3 n = area.twice;
  for (float& x : n) x /= area.length;
  const float root = std::sqrt(squared);
  n = cross(e, n);
  for (float& x : n) x /= root;
  const PlaneWords words = words_of(n, weight * squared);
  for (const std::uint32_t v : {from, to})
    if (range.has(v)) add_words(mesh.vertices[v], words);
}

}  // namespace

void sum_quadrics(CollapseMesh& mesh, const ConstraintWeights& weights, Stop* stop) {
  mesh.vertex_ranges().for_each(
      [&](const VertexRanges::Range& range) {
        add_faces(mesh, range);
        if (weights.boundary > 0)
          for (std::size_t g = 4 * mesh.face_count(); g < mesh.half_edge_bound(); g += 4)
            add_constraint(mesh, range, mesh.twin(static_cast<std::uint32_t>(g)), weights.boundary);
        if (weights.crease > 0 || weights.seam > 0)
          range.for_each_face([&](std::uint32_t f) {
            for (std::uint32_t h = 4 * f; h < 4 * f + 3; ++h)
              if (!mesh.is_ghost(mesh.twin(h))) add_constraint(mesh, range, h, constraint(mesh, h, weights));
          });
      },
      stop);
}

}  // namespace vkmesh::detail
