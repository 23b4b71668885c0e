// Decimation in its plainest form: the page to read first. The rest of this folder does the same, faster.
//
// M. Garland, P. Heckbert, "Surface simplification using quadric error metrics", 1997.
// H. Hoppe et al., "Mesh optimization", 1993: the link condition.
// W. Schroeder, J. Zarge, W. Lorensen, "Decimation of triangle meshes", 1992: vertex removal.
// G. Klincsek, "Minimal triangulations of polygonal domains", 1980: the best triangulation of a hole.
//
// A step takes one vertex away. All steps lie in a heap, by cost; the cheapest is done if it is legal, and
// the steps around it are priced anew, until a target is met or no step is left.
#include "decimation/reference.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <queue>
#include <set>
#include <tuple>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace vkmesh::detail {
namespace {

using Vertex = std::uint32_t;
using Triangle = std::array<Vertex, 3>;

constexpr double kNone = std::numeric_limits<double>::infinity();
/// Closes each boundary loop with a fan of faces without area: every vertex has a whole ring of neighbours,
/// and the link condition needs no rule for boundaries. It lies nowhere.
constexpr Vertex kGhost = kInvalid;
constexpr double kDegenerate = 1e-6;  // of its squared sides: a triangle of less area has no reliable normal
constexpr double kSliver = 1e-4;      // the same: in a hole, one of less does not take the place of one
constexpr double kThinner = 10;       // that was so many times as wide
constexpr double kEar = 0.8660254037844386;  // cosine of the angle by which an ear may turn
constexpr double kSteepest =
    0.05;                          // cosine between a face in a hole and the direction along which it is seen
constexpr double kAgainst = -0.5;  // cosine of the angle at which neighbours stand against each other

bool contains(const auto& range, Vertex v) {
  return std::ranges::find(range, v) != std::ranges::end(range);
}

/// The squared distances of a point to planes, each times its weight: x·A x + 2 b·x + c.
struct Quadric {
  glm::dmat3 a{0.0};
  DVec3 b{0.0};
  double c = 0, weight = 0;  // the weight of all planes

  void add_plane(const DVec3& normal, const DVec3& point, double w) {
    const double d = -glm::dot(normal, point);
    add({glm::outerProduct(normal, normal), d * normal, d * d, 1}, w);
  }
  void add(const Quadric& q, double share = 1) {
    a += share * q.a;
    b += share * q.b;
    c += share * q.c;
    weight += share * q.weight;
  }
  [[nodiscard]] double at(const DVec3& x) const {
    return std::max(glm::dot(x, a * x) + 2 * glm::dot(b, x) + c, 0.0);
  }
  /// The point of least error. Directions in which the quadric is flatter than a millionth of its steepest
  /// are left to `middle`, and so is all if the minimum lies farther from it than `radius`.
  [[nodiscard]] DVec3 minimum_near(const DVec3& middle, double radius) const {
    const double flat = (a[0][0] + a[1][1] + a[2][2]) / (1 << 20) + 1e-36;
    const glm::dmat3 inverse = glm::inverse(a + glm::dmat3(flat));
    const DVec3 gradient = a * middle + b;
    DVec3 step = -(inverse * gradient);
    step -= inverse * (gradient + a * step);  // takes back what `flat` has shortened of steep directions
    return glm::dot(step, step) <= radius * radius ? middle + step : middle;
  }
};

/// Twice the area of a triangle over two of its sides squared.
double shape_of(const DVec3& p, const DVec3& q, const DVec3& r) {
  const DVec3 u = q - p, v = r - p;
  return glm::length(glm::cross(u, v)) / std::max(glm::dot(u, u) + glm::dot(v, v), 1e-300);
}
/// A face in the place of another has become a sliver.
bool thins(double before, double after) {
  return after <= kSliver && kThinner * after < before;
}
/// 0 of a triangle without area.
DVec3 unit_normal(const DVec3& p, const DVec3& q, const DVec3& r) {
  const DVec3 u = q - p, v = r - p, n = glm::cross(u, v);
  const double length = glm::length(n);
  return length > kDegenerate * (glm::dot(u, u) + glm::dot(v, v)) ? n / length : DVec3(0.0);
}
/// 1 where one has none.
double cosine(const DVec3& m, const DVec3& n) {
  return m != DVec3(0.0) && n != DVec3(0.0) ? glm::dot(m, n) : 1;
}

/// A face at the vertex that a collapse leaves, of those in order around it.
struct ChangedFace {
  DVec3 before, after;  // unit normals
  bool follows;         // the face before it was so before the collapse, too
};

/// A face turns by more than the angle, or loses its area; or two neighbours come to stand against each
/// other, more than any did before.
bool folds_over(const std::vector<ChangedFace>& faces, double cos_deviation) {
  double before = 1, after = 1;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const ChangedFace &face = faces[i], &next = faces[(i + 1) % faces.size()];
    const bool loses_area = face.before != DVec3(0.0) && face.after == DVec3(0.0);
    if (loses_area || cosine(face.before, face.after) < cos_deviation) return true;
    after = std::min(after, cosine(face.after, next.after));
    if (next.follows) before = std::min(before, cosine(face.before, next.before));
  }
  return after < kAgainst && after < before;
}

/// The hole that a vertex leaves, seen along the sum of its faces' area vectors: the old surface and the new
/// one are graphs over the same polygon. The error is the quadric of the vertex at the point of the new
/// surface below or above it, and for each crossing of an edge of the vertex, a spoke, with a new edge the
/// squared difference of their heights, times half the area of the faces at the spoke. That is a sum over
/// triangles and edges, so that the best triangulation is found part by part.
class Hole {
 public:
  static constexpr std::size_t kMostNeighbours = 16;

  /// `ring` goes counter-clockwise around the vertex at v, which has the quadric; `closed`: all around it.
  /// may_join(i, j): whether the edge between these neighbours may be made.
  Hole(const Quadric& quadric, const DVec3& v, std::vector<DVec3> ring, bool closed, double cos_deviation,
       const auto& may_join)
      : quadric_(quadric), v_(v), r_(std::move(ring)), n_(r_.size()), closed_(closed), cos_(cos_deviation) {
    for (DVec3& r : r_) r -= v;
    for (std::size_t i = 0; i + (closed ? 0 : 1) < n_; ++i) {
      const DVec3 twice = glm::cross(r_[i], r_[(i + 1) % n_]);
      up_ += twice;
      flat_ += 1e-7 * 0.5 * glm::length(twice);
      for (const std::size_t k : {i, (i + 1) % n_}) spoke_[k] += 0.25 * glm::length(twice);
    }
    up_ /= std::max(glm::length(up_), 1e-300);
    if (!is_graph()) return;
    for (std::size_t span = 1; span < n_; ++span)
      for (std::size_t a = 0; a + span < n_; ++a) fill(a, a + span, may_join);
    if (!(best_[0][n_ - 1].sum < kNone)) return;
    cost = best_[0][n_ - 1].error;
    collect(0, n_ - 1);
    if (closed) return;
    // On the boundary the quadric counts at the nearest point of the new edge, and below only by its rise.
    const DVec3 edge = r_.back() - r_.front();
    along_ = std::clamp(-glm::dot(r_.front(), edge) / std::max(glm::dot(edge, edge), 1e-300), 0.0, 1.0);
    cost += quadric_.at(v_ + r_.front() + along_ * edge);
  }

  double cost = kNone;                                // infinite when there is no triangulation
  std::vector<std::array<std::size_t, 3>> triangles;  // by numbers in the ring

  /// What each neighbour takes over of what the vertex stands for: the corners of the triangle that holds it,
  /// by its place there; on the boundary the ends of the new edge, by the point nearest to it.
  [[nodiscard]] std::map<std::size_t, double> shares() const {
    if (!closed_) return {{0, 1 - along_}, {n_ - 1, along_}};
    for (const auto& [a, b, c] : triangles) {
      const double x = left(b, c), y = -left(a, c), z = left(a, b), sum = x + y + z;
      if (std::min({x, y, z}) >= 0 && sum > 0) return {{a, x / sum}, {b, y / sum}, {c, z / sum}};
    }
    return {{0, 1.0}};
  }

 private:
  struct Best {
    double sum = kNone, error = kNone;  // what decides, and what of it is error
    std::size_t third = 0;
  };

  /// Twice the area of the triangle of the vertex and two neighbours, as seen: above 0 where the vertex lies
  /// left of the edge from i to j.
  [[nodiscard]] double left(std::size_t i, std::size_t j) const {
    const double x = glm::dot(up_, glm::cross(r_[i], r_[j]));
    if (j == i + 1) return std::max(x, 0.0);
    return i == 0 && j + 1 == n_ && closed_ ? std::min(x, 0.0) : x;
  }

  /// The faces look up, and go around the vertex once at most.
  [[nodiscard]] bool is_graph() const {
    double beyond = 0;
    for (std::size_t i = 0; i + (closed_ ? 0 : 1) < n_; ++i)
      if (glm::dot(up_, unit_normal(DVec3(0.0), r_[i], r_[(i + 1) % n_])) < 0) return false;
    for (std::size_t i = 1; i < n_; ++i) {
      if (left(0, i) > 0 && beyond > 0) return false;
      beyond = std::max(beyond, -left(0, i));
    }
    return true;
  }

  /// How far the surfaces lie apart where the triangle holds the vertex, or else where the spoke of one of
  /// its corners crosses the edge of the others.
  [[nodiscard]] double apart(std::size_t a, std::size_t b, std::size_t c) const {
    const double x = std::max(left(a, b), 0.0), y = std::max(left(b, c), 0.0), z = std::max(-left(a, c), 0.0);
    return x + y + z > 0 ? glm::dot(r_[a], glm::cross(r_[b], r_[c])) / (x + y + z) : 0;
  }

  /// The error of a new edge: it crosses the spokes that lie beyond it, seen from the vertex.
  [[nodiscard]] double crossings(std::size_t a, std::size_t c) const {
    double sum = 0;
    for (std::size_t b = 0; b < n_; ++b) {
      if (b == a || b == c || left(a, c) == 0 || (left(a, c) > 0) != (a < b && b < c)) continue;
      const double d = b < a ? apart(b, a, c) : b < c ? apart(a, b, c) : apart(a, c, b);
      sum += spoke_[b] * d * d;
    }
    return sum;
  }

  /// The error of a triangle, which is 0 unless it holds the vertex; infinite if it may not be made.
  [[nodiscard]] double error_of(std::size_t a, std::size_t b, std::size_t c) const {
    const bool is_last = a == 0 && c + 1 == n_;
    const DVec3 n = unit_normal(r_[b], r_[c], r_[a]);
    if (!(glm::dot(n, up_) >= kSteepest)) return kNone;
    const auto turns = [&](std::size_t i, std::size_t j) {  // too far from the old face between i and j
      return cosine(n, unit_normal(DVec3(0.0), r_[i], r_[j])) < cos_;
    };
    if ((a + 1 == b && turns(a, b)) || (b + 1 == c && turns(b, c)) || (is_last && closed_ && turns(c, a)))
      return kNone;
    const double shape = shape_of(r_[b], r_[c], r_[a]);
    const auto thins_from = [&](std::size_t i, std::size_t j) {
      return thins(shape_of(DVec3(0.0), r_[i], r_[j]), shape);
    };
    if (shape <= kSliver && (a + 1 != b || thins_from(a, b)) && (b + 1 != c || thins_from(b, c)) &&
        (!is_last || !closed_ || thins_from(c, a)))
      return kNone;
    const double side = -left(a, c);
    if (left(a, b) < 0 || left(b, c) < 0 || side < 0 || (side == 0 && !is_last)) return 0;
    const double d = apart(a, b, c);
    return closed_ ? quadric_.at(v_ + d * up_) : d * d * glm::dot(up_, quadric_.a * up_);
  }

  /// The best triangulation of the ring from a to c, of those of its parts.
  void fill(std::size_t a, std::size_t c, const auto& may_join) {
    Best& best = best_[a][c];
    if (a + 1 == c) best = {0, 0, 0};
    for (std::size_t b = a + 1; b < c; ++b) {
      const double error = error_of(a, b, c);
      const double sum = best_[a][b].sum + best_[b][c].sum + error;
      if (sum < best.sum) best = {sum, best_[a][b].error + best_[b][c].error + error, b};
    }
    if (a + 1 == c || (a == 0 && c + 1 == n_ && closed_)) return;  // an edge that was there
    if (!may_join(a, c)) best.sum = kNone;
    const double crossed = crossings(a, c);
    best.sum += crossed + flat_ * glm::dot(r_[c] - r_[a], r_[c] - r_[a]);  // short edges where all is flat
    best.error += crossed;
  }
  void collect(std::size_t a, std::size_t c) {
    if (a + 1 == c) return;
    const std::size_t b = best_[a][c].third;
    triangles.push_back({a, b, c});
    collect(a, b);
    collect(b, c);
  }

  const Quadric& quadric_;
  DVec3 v_;
  std::vector<DVec3> r_;  // relative to v
  std::size_t n_;
  bool closed_;
  double cos_, flat_ = 0, along_ = 0;
  DVec3 up_{0.0};
  std::array<double, kMostNeighbours> spoke_{};
  std::array<std::array<Best, kMostNeighbours>, kMostNeighbours> best_;
};

/// The best fan that fills a hole for which there is no good triangulation seen along its normal: v goes to
/// one of its neighbours, on the boundary to one along that, which is a half-edge collapse.
struct Fan {
  double cost = kNone;
  std::size_t heir = 0;
  std::vector<std::array<std::size_t, 3>> triangles;

  Fan(const Quadric& quadric, const DVec3& v, const std::vector<DVec3>& ring, bool closed,
      double cos_deviation, const auto& may_join) {
    const std::size_t n = ring.size();
    DVec3 up(0.0);
    for (std::size_t i = 0; i + (closed ? 0 : 1) < n; ++i)
      up += glm::cross(ring[i] - v, ring[(i + 1) % n] - v);
    for (std::size_t r = 0; r < n && n > 2; ++r) {
      if ((!closed && r > 0 && r + 1 < n) || !(quadric.at(ring[r]) < cost)) continue;
      std::vector<std::array<std::size_t, 3>> made;
      bool legal = true;
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t next = (i + 1) % n, away = std::max(i, r) - std::min(i, r);
        if (i == r) continue;
        if (away > 1 && !(closed && away + 1 == n)) legal = legal && may_join(i, r);
        if (next == r || (!closed && next == 0)) continue;
        const DVec3 before = unit_normal(v, ring[i], ring[next]),
                    after = unit_normal(ring[r], ring[i], ring[next]);
        const bool is_thin = thins(shape_of(v, ring[i], ring[next]), shape_of(ring[r], ring[i], ring[next]));
        if (before == DVec3(0.0))
          legal = legal && (after == DVec3(0.0) || glm::dot(after, up) > 0);
        else
          legal = legal && !is_thin && after != DVec3(0.0) && cosine(before, after) >= cos_deviation;
        made.push_back({r, i, next});
      }
      if (!legal) continue;
      cost = quadric.at(ring[r]);
      heir = r;
      triangles = std::move(made);
    }
  }
};

/// A way to take the vertex `gone` away: others take the place of its faces, and its quadric.
struct Step {
  double cost = kNone;
  Vertex gone = kGhost, kept = kGhost;  // which stands for it from now on
  DVec3 position{0.0};                  // of the vertex that is kept
  std::vector<Triangle> added;
  std::map<Vertex, double> shares;
  bool is_fan = false;  // that fills a hole
};

class Decimation {
 public:
  Decimation(const TriangleSurface& surface, const DecimateOptions& options)
      : options_(options),
        removes_vertices_(options.operation == DecimateOperation::kVertexRemoval),
        cos_deviation_(std::cos(options.bounds.normal_deviation)),
        max_error_(options.bounds.error.value_or(Length::absolute(kNone)).value),
        faces_at_(surface.points.size()),
        quadric_(surface.points.size()),
        locked_(surface.points.size(), false),
        version_(surface.points.size(), 0) {
    result_.positions.assign(surface.points.begin(), surface.points.end());
    for (Vertex v = 0; v < surface.points.size(); ++v) result_.vertex_map.push_back(v);
    for (std::size_t c = 0; c < surface.corners.size(); c += 3)
      add_face({surface.corners[c], surface.corners[c + 1], surface.corners[c + 2]});
    for (const Vertex v : options.locked.vertices) locked_[v] = true;
    for (const Triangle& face : faces_) sum_quadrics(face);
  }

  ReferenceResult run() {
    const auto share = std::llround(options_.target.ratio.value_or(0) * static_cast<double>(faces_left_));
    const std::size_t faces = std::max(options_.target.faces.value_or(0), static_cast<std::size_t>(share));
    std::set<Vertex> used;
    for (const Triangle& face : faces_) used.insert(face.begin(), face.end());
    std::size_t vertices = used.size();
    price_around(used);
    while (!queue_.empty() && faces_left_ > faces && vertices > options_.target.vertices.value_or(0)) {
      const auto [cost, p, q, version] = queue_.top();
      queue_.pop();
      if (version != version_[p] + version_[q]) continue;  // priced anew since
      const Step step = price(p, q);
      if (step.cost > cost) {  // an edge that it needs has been made elsewhere
        queue_.emplace(step.cost, p, q, version);
      } else if (is_legal(step, p, q)) {
        carry_out(step);
        --vertices;
      }
    }
    std::ranges::copy_if(faces_, std::back_inserter(result_.faces), [](auto& f) { return f[0] != kGhost; });
    for (Vertex& v : result_.vertex_map)
      while (result_.vertex_map[v] != v) v = result_.vertex_map[v];
    return std::move(result_);
  }

 private:
  /// Cost and version of the collapse of two vertices, or of the removal of one, which then stands twice.
  using Entry = std::tuple<double, Vertex, Vertex, std::size_t>;

  void add_face(const Triangle& face) {
    for (const Vertex v : face) faces_at_[v].push_back(faces_.size());
    faces_.push_back(face);
    ++faces_left_;
  }
  [[nodiscard]] DVec3 at(Vertex v) const { return v == kGhost ? DVec3(std::nan("")) : result_.positions[v]; }
  [[nodiscard]] auto faces_at_edge(Vertex p, Vertex q) const {
    return std::ranges::count_if(faces_at_[p], [&](std::size_t f) { return contains(faces_[f], q); });
  }

  /// The neighbours of v counter-clockwise; on the boundary the ghost is the last of them.
  [[nodiscard]] std::vector<Vertex> ring(Vertex v) const {
    std::map<Vertex, Vertex> next, previous;
    for (const std::size_t f : faces_at_[v]) {
      const auto i = static_cast<std::size_t>(std::ranges::find(faces_[f], v) - faces_[f].begin());
      const Vertex a = faces_[f][(i + 1) % 3], b = faces_[f][(i + 2) % 3];
      next[a] = b;
      previous[b] = a;
    }
    Vertex r = next.begin()->first;
    for (std::size_t i = 0; i < next.size() && previous.contains(r); ++i) r = previous[r];
    std::vector<Vertex> result = {r};
    while (next.contains(r) && next[r] != result.front()) result.push_back(r = next[r]);
    if (!next.contains(r)) result.push_back(kGhost);
    return result;
  }

  /// Planes of faces, weighted by area, and planes that stand on boundary edges, perpendicular to their face.
  void sum_quadrics(const Triangle& face) {
    const DVec3 n = glm::cross(at(face[1]) - at(face[0]), at(face[2]) - at(face[0]));
    const double twice = glm::length(n);
    const DecimateCurves& curves = options_.curves;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vertex p = face[i], q = face[(i + 1) % 3];
      if (twice > 0) quadric_[p].add_plane(n / twice, at(p), 0.5 * twice);
      if (faces_at_edge(p, q) > 1) continue;
      if (curves.boundary == DecimateBoundary::kKept) locked_[p] = locked_[q] = true;
      if (curves.boundary != DecimateBoundary::kInShape || !(twice > 0)) continue;
      const DVec3 edge = at(q) - at(p), outward = glm::normalize(glm::cross(edge, n));
      for (const Vertex v : {p, q})
        quadric_[v].add_plane(outward, at(v), curves.boundary_weight * glm::dot(edge, edge));
    }
  }

  void price_around(const std::set<Vertex>& changed) {
    for (const Vertex v : changed) ++version_[v];
    for (const Vertex p : changed)
      for (const Vertex q : removes_vertices_ ? std::vector{p} : ring(p)) {
        if (q == kGhost || (q < p && changed.contains(q))) continue;  // from its other end
        const double cost = price(p, q).cost;
        if (cost < kNone) queue_.emplace(cost, p, q, version_[p] + version_[q]);
      }
  }
  [[nodiscard]] Step price(Vertex p, Vertex q) const { return p == q ? removal_of(p) : collapse_of(p, q); }

  [[nodiscard]] Step collapse_of(Vertex p, Vertex q) const {
    if (locked_[p] && locked_[q]) return {};
    Quadric sum = quadric_[p];
    sum.add(quadric_[q]);
    const bool is_free = options_.operation == DecimateOperation::kEdgeCollapse && !locked_[p] && !locked_[q];
    const bool keeps_q = locked_[q] || (!locked_[p] && sum.at(at(q)) <= sum.at(at(p)));
    const auto [gone, kept] = keeps_q ? std::pair(p, q) : std::pair(q, p);
    Step step{0, gone, kept, at(kept), {}, {{kept, 1.0}}};
    if (is_free) step.position = sum.minimum_near(0.5 * (at(p) + at(q)), 2 * glm::distance(at(p), at(q)));
    step.cost = sum.at(step.position);
    for (const std::size_t f : faces_at_[gone]) {
      if (contains(faces_[f], kept)) continue;
      step.added.push_back(faces_[f]);
      std::ranges::replace(step.added.back(), gone, kept);
    }
    return step;
  }

  [[nodiscard]] Step removal_of(Vertex v) const {
    std::vector<Vertex> around = ring(v);
    const bool closed = around.back() != kGhost;
    if (!closed) around.pop_back();
    if (locked_[v] || around.size() > Hole::kMostNeighbours) return {};
    std::vector<DVec3> places;
    for (const Vertex r : around) places.push_back(at(r));
    const auto is_free = [&](auto i, auto j) {
      return faces_at_edge(around[i], around[j]) == 0 && !makes_ear(v, around, i, j);
    };
    if (closed && around.size() == 3 && makes_ear(v, around, 0, 2)) return {};
    const Hole hole(quadric_[v], at(v), places, closed, cos_deviation_, is_free);
    if (!(hole.cost < kNone)) {
      const Fan fan(quadric_[v], at(v), places, closed, cos_deviation_, is_free);
      return fan.cost < kNone ? fan_of(v, around, fan) : Step();
    }
    Step step{hole.cost, v, kGhost, {}, {}, {}};
    for (const auto& [a, b, c] : hole.triangles) step.added.push_back({around[a], around[b], around[c]});
    for (const auto& [i, share] : hole.shares()) step.shares[around[i]] = share;
    step.kept = std::ranges::max_element(step.shares, {}, &std::pair<const Vertex, double>::second)->first;
    step.position = at(step.kept);
    return step;
  }

  [[nodiscard]] Step fan_of(Vertex v, const std::vector<Vertex>& around, const Fan& fan) const {
    const Vertex kept = around[fan.heir];
    Step step{fan.cost, v, kept, at(kept), {}, {{kept, 1.0}}, true};
    for (const auto& [a, b, c] : fan.triangles) step.added.push_back({around[a], around[b], around[c]});
    return step;
  }

  /// The edge between two neighbours of v cuts off a face with two sides on a boundary that is kept, which
  /// turns far: the curve alone says where it looks.
  [[nodiscard]] bool makes_ear(Vertex v, const std::vector<Vertex>& around, std::size_t i,
                               std::size_t j) const {
    const std::size_t n = around.size();
    if (options_.curves.boundary != DecimateBoundary::kKept) return false;
    for (std::size_t first = 0; first < n; ++first) {
      const std::size_t last = (first + 2) % n;
      if (n > 3 && std::minmax(i, j) != std::minmax(first, last)) continue;
      const Vertex a = around[first], b = around[(first + 1) % n], c = around[last];
      if (faces_at_edge(a, b) > 1 || faces_at_edge(b, c) > 1) continue;
      const DVec3 ear = unit_normal(at(a), at(b), at(c));
      if (glm::dot(ear, unit_normal(at(v), at(a), at(b))) < kEar ||
          glm::dot(ear, unit_normal(at(v), at(b), at(c))) < kEar)
        return true;
    }
    return false;
  }

  [[nodiscard]] bool is_legal(const Step& step, Vertex p, Vertex q) const {
    const double weight = quadric_[p].weight + (removes_vertices_ ? 0 : quadric_[q].weight);
    if (step.cost > max_error_ * max_error_ * weight) return false;
    const std::vector<Vertex> at_p = ring(p), at_q = ring(removes_vertices_ ? at_p.front() : q);
    if (at_p.size() == 3 && at_q.size() == 3) return false;  // a tetrahedron, which would lie on itself
    if (step.is_fan)
      return !detail::folds_over(faces_around(step.gone, step.kept, step.position), cos_deviation_);
    if (removes_vertices_) return !folds_over(step);
    // The link condition: the ends share but the two neighbours across the faces of the edge.
    const auto shared = std::ranges::count_if(at_p, [&](Vertex v) { return contains(at_q, v); });
    return shared == 2 && !detail::folds_over(faces_around(p, q, step.position), cos_deviation_);
  }

  /// Those that stay when p and q become one at x: first those of p, then those of q.
  [[nodiscard]] std::vector<ChangedFace> faces_around(Vertex p, Vertex q, const DVec3& x) const {
    std::vector<ChangedFace> faces;
    for (const auto& [v, other] : {std::pair(p, q), std::pair(q, p)}) {
      std::vector<Vertex> around = ring(v);
      std::rotate(around.begin(), std::ranges::find(around, other), around.end());
      for (std::size_t i = 1; i + 1 < around.size(); ++i) {
        const DVec3 a = at(around[i]), b = at(around[i + 1]);
        faces.push_back({unit_normal(at(v), a, b), unit_normal(x, a, b), i > 1});
      }
    }
    return faces;
  }

  /// Two new triangles stand against each other, more than any faces did before.
  [[nodiscard]] bool folds_over(const Step& step) const {
    const std::vector<Vertex> around = ring(step.gone);
    const std::size_t n = around.size();
    const auto normal = [&](const Triangle& t) { return unit_normal(at(t[0]), at(t[1]), at(t[2])); };
    const auto old = [&](std::size_t i) { return normal({step.gone, around[i % n], around[(i + 1) % n]}); };
    double before = 1, after = 1;
    for (std::size_t i = 0; i < n; ++i) before = std::min(before, cosine(old(i), old(i + 1)));
    for (const Triangle& s : step.added)
      for (const Triangle& t : step.added)
        if (std::ranges::count_if(s, [&](Vertex v) { return contains(t, v); }) == 2)
          after = std::min(after, cosine(normal(s), normal(t)));
    return after < kAgainst && after < before;
  }

  void carry_out(const Step& step) {
    for (const std::size_t f : std::vector(faces_at_[step.gone])) {
      for (const Vertex v : std::exchange(faces_[f], {kGhost, kGhost, kGhost})) std::erase(faces_at_[v], f);
      --faces_left_;
    }
    for (const Triangle& face : step.added) add_face(face);
    for (const auto& [v, share] : step.shares) quadric_[v].add(quadric_[step.gone], share);
    result_.positions[step.kept] = step.position;
    result_.vertex_map[step.gone] = step.kept;
    ++result_.steps;
    const double weight = quadric_[removes_vertices_ ? step.gone : step.kept].weight;
    if (weight > 0) result_.error = std::max(result_.error, std::sqrt(step.cost / weight));
    std::set<Vertex> changed;
    for (const auto& [v, share] : step.shares) changed.insert(v);
    for (const Triangle& face : step.added) changed.insert(face.begin(), face.end());
    for (const Vertex v : ring(step.kept)) changed.insert(v);
    changed.erase(kGhost);
    price_around(changed);
  }

  const DecimateOptions& options_;
  bool removes_vertices_;
  double cos_deviation_, max_error_;
  std::vector<Triangle> faces_;
  std::vector<std::vector<std::size_t>> faces_at_;
  std::vector<Quadric> quadric_;
  std::vector<bool> locked_;
  std::vector<std::size_t> version_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
  std::size_t faces_left_ = 0;
  ReferenceResult result_;
};

}  // namespace

ReferenceResult decimate_by_reference(const TriangleSurface& surface, const DecimateOptions& options) {
  return Decimation(surface, options).run();
}

}  // namespace vkmesh::detail
