#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <glm/geometric.hpp>

#include <vkmesh/decimation/addressable_heap.h>
#include <vkmesh/decimation/decimate.h>

#include "catching.h"
#include "decimation/collapse_mesh.h"
#include "decimation/quadric.h"

namespace vkmesh {
namespace {

using glm::cross;
using glm::dot;

using detail::CollapseMesh;
using detail::Quadric;

constexpr std::size_t kCollapsesBetweenReports = 4096;
/// A triangle of less area than this share of its squared sides has no reliable normal.
constexpr double kDegenerate = 1e-7;

enum class Legality { kLegal, kLink, kFoldOver, kError };

/// One run. Candidates: each vertex p stands in the heap once, with the half-edge p → q that costs least
/// among those not known to be illegal.
class Decimation {
 public:
  Decimation(const HalfEdgeMesh& mesh, std::span<const Vec3> positions, const DecimateOptions& options)
      : options_(options),
        cos_deviation_(std::cos(options.max_normal_deviation)),
        input_(mesh),
        mesh_(mesh, positions),
        positions_(positions),
        quadrics_(mesh.vertex_count()),
        candidates_(mesh.vertex_count()),
        marks_(mesh.vertex_count() + 1, 0),
        heap_(mesh.vertex_count()),
        faces_(mesh.face_count()) {}

  Result<Decimated> run(const Progress& progress) {
    sum_quadrics();
    for (std::uint32_t v = 0; v < positions_.size(); ++v) {
      candidates_[v] = cheapest(v);
      if (candidates_[v].half_edge != kInvalid) heap_.append(v, candidates_[v].cost);
    }
    heap_.heapify();

    const std::size_t first_faces = faces_;
    const std::size_t target = options_.target_faces.value_or(0);
    std::size_t steps = 0;
    while (faces_ > target && !heap_.empty()) {
      if (progress && ++steps % kCollapsesBetweenReports == 0) {
        const double done =
            static_cast<double>(first_faces - faces_) / static_cast<double>(first_faces - target);
        if (!progress(done)) return fail(ErrorCode::kInterrupted, "decimation was cancelled");
      }
      step();
    }
    if (progress && !progress(1.0)) return fail(ErrorCode::kInterrupted, "decimation was cancelled");
    return finish(target);
  }

 private:
  /// What the heap holds for a vertex.
  struct Candidate {
    std::uint32_t half_edge =
        kInvalid;  ///< Leaves the vertex; kInvalid: none, and the vertex is not in the heap.
    std::uint32_t towards = kInvalid;  ///< Its target.
    float cost = 0;
    bool held = false;           ///< A cheaper half-edge of this vertex was found illegal.
    bool held_by_error = false;  ///< One for its error.
  };
  [[nodiscard]] DVec3 offset(std::uint32_t from, std::uint32_t to) const {
    return DVec3(mesh_.position(to)) - DVec3(mesh_.position(from));
  }

  void sum_quadrics() {
    for (std::uint32_t f = 0; f < input_.face_count(); ++f) {
      const std::array<std::uint32_t, 3> v = {mesh_.origin(4 * f), mesh_.origin(4 * f + 1),
                                              mesh_.origin(4 * f + 2)};
      const std::array<DVec3, 3> edge = {offset(v[0], v[1]), offset(v[1], v[2]), offset(v[2], v[0])};
      DVec3 normal = cross(edge[0], edge[1]);
      const double length = std::sqrt(dot(normal, normal));
      if (!(length > 0)) continue;
      normal /= length;
      for (const std::uint32_t corner : v) quadrics_[corner].add_plane(normal, 0.5 * length);
      for (std::uint32_t i = 0; i < 3; ++i) {
        if (!mesh_.is_ghost(mesh_.twin(4 * f + i))) continue;
        const double area = dot(edge[i], edge[i]);
        if (!(area > 0)) continue;
        const DVec3 across = cross(edge[i] / std::sqrt(area), normal);
        quadrics_[v[i]].add_plane(across, options_.boundary_weight * area);
        quadrics_[v[(i + 1) % 3]].add_plane(across, options_.boundary_weight * area);
      }
    }
  }

  /// What p → q adds to the sum over all vertices of the quadric at its vertex: of p's planes alone, since q
  /// stays.
  [[nodiscard]] float cost(std::uint32_t p, std::uint32_t q) const {
    const Quadric& planes = quadrics_[p];
    return static_cast<float>(std::max(planes.at(offset(p, q)) - planes.constant, 0.0));
  }

  static bool cheaper(const Candidate& a, const Candidate& b) {
    return a.cost < b.cost || (a.cost == b.cost && a.half_edge < b.half_edge);
  }

  /// The cheapest half-edge that leaves v, legal or not.
  [[nodiscard]] Candidate cheapest(std::uint32_t v) const {
    Candidate best;
    best.cost = std::numeric_limits<float>::infinity();
    const std::uint32_t start = mesh_.leading(v);
    if (start == kInvalid) return best;
    std::uint32_t h = start;
    do {
      const std::uint32_t q = mesh_.target(h);
      if (q != mesh_.apex()) {
        const Candidate candidate{h, q, cost(v, q)};
        if (cheaper(candidate, best)) best = candidate;
      }
      h = mesh_.around_vertex(h);
    } while (h != start);
    return best;
  }

  void step() {
    const std::uint32_t p = heap_.top();
    // Most of the time goes on waiting for memory: what the next steps will read is asked for now.
    heap_.for_each_near_top([this](std::uint32_t v) {
      prefetch(v);
      mesh_.prefetch(candidates_[v].half_edge, v, candidates_[v].towards);
    });
    const std::uint32_t h = candidates_[p].half_edge;
    if (judge(h) == Legality::kLegal) {
      collapse(h);
    } else {
      choose_legal(p);
    }
  }

  /// Judges the candidates of p from the cheapest on and settles on the first that is legal, or on none.
  void choose_legal(std::uint32_t p) {
    choices_.clear();
    const std::uint32_t start = mesh_.leading(p);
    std::uint32_t h = start;
    do {
      const std::uint32_t q = mesh_.target(h);
      if (q != mesh_.apex()) choices_.push_back({h, q, cost(p, q)});
      h = mesh_.around_vertex(h);
    } while (h != start);
    std::sort(choices_.begin(), choices_.end(), cheaper);
    Candidate settled;
    settled.held = true;
    for (const Candidate& choice : choices_) {
      const Legality legality = judge(choice.half_edge);
      if (legality == Legality::kLegal) {
        settled.half_edge = choice.half_edge;
        settled.towards = choice.towards;
        settled.cost = choice.cost;
        break;
      }
      if (legality == Legality::kLink) ++rejected_link_;
      if (legality == Legality::kFoldOver) ++rejected_fold_over_;
      if (legality == Legality::kError) settled.held_by_error = true;
    }
    settle(p, settled);
  }

  void prefetch(std::uint32_t v) const {
    detail::prefetch(&quadrics_[v]);
    detail::prefetch(&quadrics_[v].constant);
    detail::prefetch(&candidates_[v]);
  }

  void settle(std::uint32_t v, const Candidate& candidate) {
    candidates_[v] = candidate;
    if (candidate.half_edge == kInvalid) {
      heap_.remove(v);
    } else {
      heap_.set(v, candidate.cost);
    }
  }

  [[nodiscard]] double error_of(std::uint32_t p, std::uint32_t q) const {
    const double weight = quadrics_[p].weight + quadrics_[q].weight;
    const double sum = quadrics_[p].at(offset(p, q)) + quadrics_[q].constant;
    return weight > 0 ? std::sqrt(sum / weight) : 0;
  }

  [[nodiscard]] Legality judge(std::uint32_t h) {
    const std::uint32_t t = mesh_.twin(h);
    const std::uint32_t p = mesh_.origin(h), q = mesh_.origin(t);
    if (options_.max_error && error_of(p, q) > *options_.max_error) return Legality::kError;

    // Link condition: p and q share two neighbours, those across the edge's faces, and the four are no
    // tetrahedron.
    ring_.clear();
    spokes_.clear();
    if (++stamp_ == 0) {
      std::fill(marks_.begin(), marks_.end(), 0u);
      stamp_ = 1;
    }
    for (std::uint32_t out = mesh_.around_vertex(h); out != h; out = mesh_.around_vertex(out)) {
      spokes_.push_back(out);
      ring_.push_back(mesh_.target(out));
      if (ring_.back() != mesh_.apex()) prefetch(ring_.back());
      marks_[ring_.back()] = stamp_;
    }
    std::size_t shared = 0, valence = 1;
    for (std::uint32_t out = mesh_.around_vertex(t); out != t; out = mesh_.around_vertex(out)) {
      shared += marks_[mesh_.target(out)] == stamp_ ? 1 : 0;
      ++valence;
    }
    if (shared != 2 || (ring_.size() == 2 && valence == 3)) return Legality::kLink;
    return folds_over(p, q) ? Legality::kFoldOver : Legality::kLegal;
  }

  /// The sum of the normals of the faces around p, each as long as twice its area.
  [[nodiscard]] DVec3 normal_at(std::uint32_t p) const {
    DVec3 sum(0.0);
    const std::uint32_t start = mesh_.leading(p);
    std::uint32_t h = start;
    do {
      const std::uint32_t x = mesh_.target(h), y = mesh_.origin(mesh_.previous(h));
      if (!mesh_.is_ghost(h)) sum += cross(offset(p, x), offset(p, y));
      h = mesh_.around_vertex(h);
    } while (h != start);
    return sum;
  }

  /// Whether a face (p, x, y) that remains turns too far, or loses its area, when p moves to q. A face that
  /// had none is held against the others around p. ring_ holds the neighbours of p but q.
  [[nodiscard]] bool folds_over(std::uint32_t p, std::uint32_t q) const {
    const DVec3 move = offset(p, q);
    std::uint32_t x = ring_[0];
    DVec3 to_x = x != mesh_.apex() ? offset(p, x) : DVec3(0.0);
    for (std::size_t i = 1; i < ring_.size(); ++i) {
      const std::uint32_t y = ring_[i];
      const DVec3 to_y = y != mesh_.apex() ? offset(p, y) : DVec3(0.0);
      if (x != mesh_.apex() && y != mesh_.apex()) {
        const DVec3 before = cross(to_x, to_y), after = cross(to_x - move, to_y - move);
        const bool had_area = has_area(before, to_x, to_y);
        if (!has_area(after, to_x - move, to_y - move)) {
          if (had_area) return true;
        } else if (!had_area) {
          if (!(dot(normal_at(p), after) > 0)) return true;
        } else if (dot(before, after) < cos_deviation_ * std::sqrt(dot(before, before) * dot(after, after))) {
          return true;
        }
      }
      x = y;
      to_x = to_y;
    }
    return false;
  }

  /// Of a triangle with sides a and b and their cross product.
  [[nodiscard]] static bool has_area(const DVec3& product, const DVec3& a, const DVec3& b) {
    const double least = kDegenerate * (dot(a, a) + dot(b, b));
    return dot(product, product) > least * least;
  }

  void collapse(std::uint32_t h) {
    const std::uint32_t p = mesh_.origin(h), q = mesh_.target(h);
    const std::uint32_t b_to_q = mesh_.previous(mesh_.twin(h)),
                        b_to_p = mesh_.twin(mesh_.next(mesh_.twin(h)));
    const std::uint32_t a = mesh_.origin(mesh_.previous(h)), b = mesh_.origin(b_to_q);
    error_ = std::max(error_, error_of(p, q));
    quadrics_[q].add(quadrics_[p], offset(p, q));
    faces_ -= mesh_.collapse(h);
    ++collapses_;
    settle(p, {});
    // judge() left the other half-edges of p in spokes_; they leave q now. The shape around their targets has
    // changed.
    for (std::size_t i = 0; i < ring_.size(); ++i) {
      const std::uint32_t r = ring_[i];
      if (r == mesh_.apex()) continue;
      Candidate& candidate = candidates_[r];
      if (candidate.held || candidate.towards == p) {
        settle(r, cheapest(r));
      } else if (candidate.half_edge == b_to_q) {
        candidate.half_edge = b_to_p;  // which took its place
      } else if (r != a && r != b) {
        const Candidate towards_q{mesh_.twin(spokes_[i]), q, cost(r, q)};
        if (cheaper(towards_q, candidate)) settle(r, towards_q);
      }
    }
    settle(q, cheapest(q));
  }

  [[nodiscard]] Result<Decimated> finish(std::size_t target) const {
    Decimated result;
    result.collapses = collapses_;
    result.rejected_link = rejected_link_;
    result.rejected_fold_over = rejected_fold_over_;
    result.error = error_;
    if (faces_ > target || !options_.target_faces) {
      const bool by_error = std::any_of(candidates_.begin(), candidates_.end(),
                                        [](const Candidate& c) { return c.held_by_error; });
      result.stop = by_error ? DecimateStop::kErrorBound : DecimateStop::kNoLegalCollapse;
    }

    std::vector<std::uint32_t> new_vertex(positions_.size(), kInvalid);
    for (std::uint32_t v = 0; v < positions_.size(); ++v) {
      if (mesh_.leading(v) == kInvalid) continue;
      new_vertex[v] = static_cast<std::uint32_t>(result.source_vertex.size());
      result.source_vertex.push_back(v);
      result.positions.push_back(positions_[v]);
    }
    std::vector<std::uint32_t> new_face(mesh_.face_count(), kInvalid);
    std::uint32_t count = 0;
    for (std::uint32_t f = 0; f < new_face.size(); ++f)
      if (mesh_.alive(f)) new_face[f] = count++;
    std::vector<std::uint32_t> origin(3 * std::size_t{count}), twin(origin.size()),
        leading(result.positions.size(), kInvalid);
    for (std::uint32_t f = 0; f < new_face.size(); ++f) {
      if (new_face[f] == kInvalid) continue;
      for (std::uint32_t i = 0; i < 3; ++i) {
        const std::uint32_t h = 3 * new_face[f] + i, v = new_vertex[mesh_.origin(4 * f + i)];
        const std::uint32_t t = mesh_.twin(4 * f + i);
        const bool boundary = mesh_.is_ghost(t);
        origin[h] = v;
        twin[h] = boundary ? kInvalid : 3 * new_face[t / 4] + t % 4;
        if (leading[v] == kInvalid || boundary) leading[v] = h;
      }
    }
    result.mesh = HalfEdgeMesh::from_arrays(std::move(origin), std::move(twin), std::move(leading));
    return result;
  }

  const DecimateOptions& options_;
  double cos_deviation_;
  const HalfEdgeMesh& input_;
  CollapseMesh mesh_;
  std::span<const Vec3> positions_;
  std::vector<Quadric> quadrics_;
  std::vector<Candidate> candidates_;
  std::vector<std::uint32_t> marks_;
  AddressableHeap<> heap_;
  std::size_t faces_;
  std::vector<std::uint32_t> ring_;
  std::vector<std::uint32_t> spokes_;
  std::vector<Candidate> choices_;
  std::uint32_t stamp_ = 0;
  std::size_t collapses_ = 0;
  std::size_t rejected_link_ = 0;
  std::size_t rejected_fold_over_ = 0;
  double error_ = 0;
};

}  // namespace

std::string name_of(DecimateStop stop) {
  switch (stop) {
    case DecimateStop::kTargetReached:
      return "target reached";
    case DecimateStop::kErrorBound:
      return "error bound";
    case DecimateStop::kNoLegalCollapse:
      break;
  }
  return "no legal collapse";
}

Result<Decimated> decimate(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                           const DecimateOptions& options, const Progress& progress) {
  if (!mesh.is_triangles())
    return fail(ErrorCode::kUnsuitable, "decimation takes triangles only: triangulate first");
  if (positions.size() != mesh.vertex_count())
    return fail(ErrorCode::kUsage, "decimation needs one position for each vertex");
  if (options.max_error && !(*options.max_error >= 0))
    return fail(ErrorCode::kUsage, "max_error must be at least 0");
  if (!(options.max_normal_deviation > 0 && options.max_normal_deviation < std::numbers::pi))
    return fail(ErrorCode::kUsage, "max_normal_deviation must lie between 0 and pi");
  if (!(options.boundary_weight >= 0 && std::isfinite(options.boundary_weight)))
    return fail(ErrorCode::kUsage, "boundary_weight must be at least 0 and finite");
  if (mesh.face_count() + mesh.boundary_half_edge_count() > CollapseMesh::kMaxFaces)
    return fail(ErrorCode::kUnsuitable, "decimation takes at most 2^30 faces and boundary edges");
  for (const Vec3& p : positions)
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      return fail(ErrorCode::kUnsuitable, "decimation needs finite positions");
  return detail::catching(
      [&]() -> Result<Decimated> { return Decimation(mesh, positions, options).run(progress); });
}

}  // namespace vkmesh
