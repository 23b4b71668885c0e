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
#include <functional>
#include <limits>
#include <map>
#include <queue>
#include <set>
#include <tuple>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "decimation/reference_target.h"

namespace vkmesh::detail {
namespace {

using Vertex = std::uint32_t;
using Triangle = std::array<Vertex, 3>;

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr Vertex kGhost = kInvalid;   // the last neighbour at boundaries: the link condition needs no rule
constexpr double kDegenerate = 1e-6;  // of its squared sides: a triangle of less area has no reliable normal
constexpr double kSliver = 1e-4;      // the same: in a hole, one of less does not take the place of one
constexpr double kThinner = 10;       // that was so many times as wide
constexpr double kEar = 0.8660254037844386;  // cosine of the angle by which an ear may turn
constexpr double kSteepest = 0.05;  // cosine between a face in a hole and the direction it is seen along
constexpr double kAgainst = -0.5;   // cosine of the angle at which neighbours stand against each other

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
  double at(const DVec3& x) const { return std::max(glm::dot(x, a * x) + 2 * glm::dot(b, x) + c, 0.0); }
  /// The point of least error. Directions in which the quadric is flatter than a millionth of its steepest
  /// are left to `middle`, and so is all if the minimum lies farther from it than `radius`.
  DVec3 minimum_near(const DVec3& middle, double radius) const {
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
/// A face of this normal loses its area, or turns by more than the angle.
bool turns(const DVec3& before, const DVec3& after, double cos_deviation) {
  return before != DVec3(0.0) && (after == DVec3(0.0) || glm::dot(before, after) < cos_deviation);
}

/// The least cosine between two faces of an edge.
double sharpest(const std::vector<Triangle>& faces, const std::vector<DVec3>& normals) {
  double least = 1;
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (std::ranges::count_if(faces[i], [&](Vertex v) { return contains(faces[k], v); }) == 2)
        least = std::min(least, glm::dot(normals[i], normals[k]));
  return least;
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
  /// may_add(i, j, k): whether the face of these neighbours may be made.
  Hole(const Quadric& quadric, const DVec3& v, std::vector<DVec3> ring, bool closed, double cos_deviation,
       const auto& may_add)
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
      for (std::size_t a = 0; a + span < n_; ++a) fill(a, a + span, may_add);
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
  std::map<std::size_t, double> shares() const {
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
  double left(std::size_t i, std::size_t j) const {
    const double x = glm::dot(up_, glm::cross(r_[i], r_[j]));
    if (j == i + 1) return std::max(x, 0.0);
    return i == 0 && j + 1 == n_ && closed_ ? std::min(x, 0.0) : x;
  }

  /// The faces look up, and go around the vertex once at most.
  bool is_graph() const {
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
  double apart(std::size_t a, std::size_t b, std::size_t c) const {
    const double x = std::max(left(a, b), 0.0), y = std::max(left(b, c), 0.0), z = std::max(-left(a, c), 0.0);
    return x + y + z > 0 ? glm::dot(r_[a], glm::cross(r_[b], r_[c])) / (x + y + z) : 0;
  }

  /// The error of a new edge: it crosses the spokes that lie beyond it, seen from the vertex.
  double crossings(std::size_t a, std::size_t c) const {
    double sum = 0;
    for (std::size_t b = 0; b < n_; ++b) {
      if (b == a || b == c || left(a, c) == 0 || (left(a, c) > 0) != (a < b && b < c)) continue;
      const double d = b < a ? apart(b, a, c) : b < c ? apart(a, b, c) : apart(a, c, b);
      sum += spoke_[b] * d * d;
    }
    return sum;
  }

  /// The error of a triangle, which is 0 unless it holds the vertex; infinite if it may not be made.
  double error_of(std::size_t a, std::size_t b, std::size_t c) const {
    const bool is_last = a == 0 && c + 1 == n_;
    const DVec3 n = unit_normal(r_[b], r_[c], r_[a]);
    if (!(glm::dot(n, up_) >= kSteepest)) return kNone;
    const double shape = shape_of(r_[b], r_[c], r_[a]);
    bool is_worse = shape <= kSliver;  // than each old face at its sides
    for (const auto& [i, j] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      if (j != (i + 1) % n_ || (j == 0 && !closed_)) continue;
      if (turns(unit_normal(DVec3(0.0), r_[i], r_[j]), n, cos_)) return kNone;
      is_worse = is_worse && thins(shape_of(DVec3(0.0), r_[i], r_[j]), shape);
    }
    if (is_worse) return kNone;
    const double side = -left(a, c);
    if (left(a, b) < 0 || left(b, c) < 0 || side < 0 || (side == 0 && !is_last)) return 0;
    const double d = apart(a, b, c);
    return closed_ ? quadric_.at(v_ + d * up_) : d * d * glm::dot(up_, quadric_.a * up_);
  }

  /// The best triangulation of the ring from a to c, of those of its parts.
  void fill(std::size_t a, std::size_t c, const auto& may_add) {
    Best& best = best_[a][c];
    if (a + 1 == c) best = {0, 0, 0};
    for (std::size_t b = a + 1; b < c; ++b) {
      const double error = may_add(a, b, c) ? error_of(a, b, c) : kNone;
      const double sum = best_[a][b].sum + best_[b][c].sum + error;
      if (sum < best.sum) best = {sum, best_[a][b].error + best_[b][c].error + error, b};
    }
    if (a + 1 == c || (a == 0 && c + 1 == n_ && closed_)) return;  // an edge that was there
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

/// A way to take the vertex `gone` away: faces take the place of others, and vertices its quadric.
struct Step {
  double cost = kNone;
  Vertex gone = kGhost, kept = kGhost;  // which stands for it from now on
  DVec3 position{0.0};                  // of the vertex that is kept
  std::map<Vertex, double> shares;
  std::vector<Triangle> before, after;
  bool is_collapse = false;  // each face before becomes the one after it
};

class Decimation {
 public:
  Decimation(const TriangleSurface& surface, const DecimateOptions& options)
      : surface_(surface),
        options_(options),
        removes_vertices_(options.operation == DecimateOperation::kVertexRemoval),
        cos_deviation_(std::cos(options.bounds.normal_deviation)),
        next_(surface.points.size()),
        quadric_(surface.points.size()),
        locked_(surface.points.size(), false),
        version_(surface.points.size(), 0) {
    result_.positions.assign(surface.points.begin(), surface.points.end());
    for (Vertex v = 0; v < surface.points.size(); ++v) result_.vertex_map.push_back(v);
    for (std::size_t c = 0; c < surface.corners.size(); c += 3)
      add_face({surface.corners[c], surface.corners[c + 1], surface.corners[c + 2]});
    for (const Vertex v : options.locked.vertices) locked_[v] = true;
    for (const Triangle& face : faces()) sum_quadrics(face);
  }

  ReferenceResult run() {
    const auto share = std::llround(options_.target.ratio.value_or(0) * static_cast<double>(faces_left_));
    const std::size_t target = std::max(options_.target.faces.value_or(0), static_cast<std::size_t>(share));
    std::set<Vertex> used;
    for (const Triangle& face : faces()) used.insert(face.begin(), face.end());
    const std::size_t least = least_vertices_by_reference(surface_, target, options_);
    price_around(used);
    while (!queue_.empty() && faces_left_ > target && used.size() > least + result_.steps) {
      const auto [cost, p, q, version] = queue_.top();
      queue_.pop();
      if (version != version_[p] + version_[q]) continue;  // priced anew since
      const Step step = price(p, q);
      if (step.cost > cost) {  // an edge that it needs has been made elsewhere
        if (step.cost < kNone) queue_.emplace(step.cost, p, q, version);
      } else if (is_legal(step, p, q)) {
        carry_out(step);
      }
    }
    result_.faces = faces();
    for (Vertex& v : result_.vertex_map)
      while (result_.vertex_map[v] != v) v = result_.vertex_map[v];
    return std::move(result_);
  }

 private:
  /// Cost and version of the collapse of two vertices, or of the removal of one, which then stands twice.
  using Entry = std::tuple<double, Vertex, Vertex, std::size_t>;

  void add_face(const Triangle& face) {
    faces_left_ += next_[face[0]].contains(face[1]) ? 0 : 1;
    for (std::size_t i = 0; i < 3; ++i) next_[face[i]][face[(i + 1) % 3]] = face[(i + 2) % 3];
  }
  std::vector<Triangle> faces_at(Vertex v) const {
    std::vector<Triangle> result;
    for (const auto& [a, b] : next_[v]) result.push_back({v, a, b});
    return result;
  }
  std::vector<Triangle> faces() const {
    std::vector<Triangle> result;
    for (Vertex v = 0; v < next_.size(); ++v)
      for (const auto& [a, b] : next_[v])
        if (v < a && v < b) result.push_back({v, a, b});
    return result;
  }
  const DVec3& at(Vertex v) const { return result_.positions[v]; }
  std::size_t faces_at_edge(Vertex p, Vertex q) const { return next_[p].count(q) + next_[q].count(p); }

  /// The neighbours of v counter-clockwise; on the boundary the ghost is the last of them.
  std::vector<Vertex> ring(Vertex v) const {
    Vertex r = next_[v].begin()->first;
    for (const auto& [a, b] : next_[v])
      if (!next_[a].contains(v)) r = a;  // where the boundary is
    std::vector<Vertex> result;
    for (std::size_t i = 0; i < next_[v].size(); ++i, r = next_[v].at(r)) result.push_back(r);
    if (r != result.front()) result.insert(result.end(), {r, kGhost});
    return result;
  }

  /// Planes of faces, weighted by area, and planes that stand on boundary edges, perpendicular to their face.
  void sum_quadrics(const Triangle& face) {
    const DVec3 n = glm::cross(at(face[1]) - at(face[0]), at(face[2]) - at(face[0]));
    for (std::size_t i = 0; i < 3; ++i) {
      const Vertex p = face[i], q = face[(i + 1) % 3];
      quadric_[p].add_plane(glm::normalize(n), at(p), 0.5 * glm::length(n));
      if (faces_at_edge(p, q) > 1) continue;
      if (options_.curves.boundary == DecimateBoundary::kKept) locked_[p] = locked_[q] = true;
      if (options_.curves.boundary != DecimateBoundary::kInShape) continue;
      const DVec3 edge = at(q) - at(p), outward = glm::normalize(glm::cross(edge, n));
      for (const Vertex v : {p, q})
        quadric_[v].add_plane(outward, at(v), options_.curves.boundary_weight * glm::dot(edge, edge));
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
  Step price(Vertex p, Vertex q) const { return p == q ? removal_of(p) : collapse_of(p, q); }

  Step collapse_of(Vertex p, Vertex q) const {
    if (locked_[p] && locked_[q]) return {};
    Quadric sum = quadric_[p];
    sum.add(quadric_[q]);
    const bool is_free = options_.operation == DecimateOperation::kEdgeCollapse && !locked_[p] && !locked_[q];
    const bool keeps_q = locked_[q] || (!locked_[p] && sum.at(at(q)) <= sum.at(at(p)));
    const auto [gone, kept] = keeps_q ? std::pair(p, q) : std::pair(q, p);
    const double twice = 2 * glm::distance(at(p), at(q));
    return collapse(gone, kept, sum, is_free ? sum.minimum_near(0.5 * (at(p) + at(q)), twice) : at(kept));
  }
  Step collapse(Vertex gone, Vertex kept, const Quadric& quadric, const DVec3& position) const {
    Step step{quadric.at(position), gone, kept, position, {{kept, 1.0}}, {}, {}, true};
    for (const Vertex v : {gone, kept})
      for (const Triangle& face : faces_at(v)) {
        if (contains(face, gone) && contains(face, kept)) continue;
        step.before.push_back(face);
        std::ranges::replace(step.after.emplace_back(face), gone, kept);
      }
    return step;
  }

  Step removal_of(Vertex v) const {
    std::vector<Vertex> around = ring(v);
    const bool closed = around.back() != kGhost;
    if (!closed) around.pop_back();
    if (locked_[v] || around.size() > Hole::kMostNeighbours) return {};
    std::vector<DVec3> places;
    for (const Vertex r : around) places.push_back(at(r));
    const Hole hole(quadric_[v], at(v), places, closed, cos_deviation_, [&](auto a, auto b, auto c) {
      return may_add({around[a], around[b], around[c]}, v, around);
    });
    if (!(hole.cost < kNone)) return fan_at(v, around, closed);
    Step step{hole.cost, v, kGhost, {}, {}, faces_at(v), {}, false};
    for (const auto& [a, b, c] : hole.triangles) step.after.push_back({around[a], around[b], around[c]});
    for (const auto& [i, share] : hole.shares()) step.shares[around[i]] = share;
    step.kept = std::ranges::max_element(step.shares, {}, &std::pair<const Vertex, double>::second)->first;
    step.position = at(step.kept);
    return step;
  }

  /// The best fan that fills a hole for which there is no good triangulation seen along its normal: v goes to
  /// one of its neighbours, on the boundary to one along that, which is a half-edge collapse.
  Step fan_at(Vertex v, const std::vector<Vertex>& around, bool closed) const {
    const auto shape = [&](const Triangle& t) { return shape_of(at(t[0]), at(t[1]), at(t[2])); };
    Step best;
    for (const Vertex r : closed ? around : std::vector{around.front(), around.back()}) {
      Step fan = collapse(v, r, quadric_[v], at(r));
      bool is_legal = around.size() > 2 && fan.cost < best.cost && !folds_over(fan);
      for (std::size_t i = 0; i < fan.before.size() && is_legal && contains(fan.before[i], v); ++i)
        is_legal = may_add(fan.after[i], v, around) && !thins(shape(fan.before[i]), shape(fan.after[i]));
      if (is_legal) best = std::move(fan);
    }
    return best;
  }

  /// A face of neighbours of v can be made when v goes: none of its new edges exists; and if two of its sides
  /// are on a boundary that is kept, it turns little, since the curve alone would say where it looks.
  bool may_add(const Triangle& face, Vertex v, const std::vector<Vertex>& around) const {
    const DVec3 normal = unit_normal(at(face[0]), at(face[1]), at(face[2]));
    std::size_t on_boundary = 0;
    bool turns_far = false;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vertex p = face[i], q = face[(i + 1) % 3];
      const bool is_old = next_[v].contains(p) && next_[v].at(p) == q;
      if (!is_old && faces_at_edge(p, q) > 0) return false;
      if (faces_at_edge(p, q) > 1 || !(is_old || (p == around.back() && q == around.front()))) continue;
      ++on_boundary;
      turns_far = turns_far || glm::dot(normal, unit_normal(at(v), at(p), at(q))) < kEar;
    }
    return options_.curves.boundary != DecimateBoundary::kKept || on_boundary < 2 || !turns_far;
  }

  bool is_legal(const Step& step, Vertex p, Vertex q) const {
    const double weight = quadric_[p].weight + (removes_vertices_ ? 0 : quadric_[q].weight);
    const double most = options_.bounds.error.value_or(Length::absolute(kNone)).value;
    if (step.cost > most * most * weight) return false;
    const std::vector<Vertex> at_p = ring(p), at_q = ring(removes_vertices_ ? at_p.front() : q);
    if (at_p.size() == 3 && at_q.size() == 3) return false;  // a tetrahedron, which would lie on itself
    // The link condition: the ends share but the two neighbours across the faces of the edge.
    const auto shared = std::ranges::count_if(at_p, [&](Vertex v) { return contains(at_q, v); });
    return (removes_vertices_ || shared == 2) && !folds_over(step);
  }

  /// A face of a collapse turns too far; or two neighbours come to stand against each other, more than any
  /// did before.
  bool folds_over(const Step& step) const {
    const auto normals = [&](const std::vector<Triangle>& faces, const DVec3& kept) {
      const auto place = [&](Vertex v) { return v == step.kept ? kept : at(v); };
      std::vector<DVec3> result;
      for (const auto& [a, b, c] : faces) result.push_back(unit_normal(place(a), place(b), place(c)));
      return result;
    };
    const auto before = normals(step.before, at(step.kept)), after = normals(step.after, step.position);
    for (std::size_t i = 0; i < before.size() && step.is_collapse; ++i)
      if (turns(before[i], after[i], cos_deviation_)) return true;
    const double least = sharpest(step.after, after);
    return least < kAgainst && least < sharpest(step.before, before);
  }

  void carry_out(const Step& step) {
    for (const Triangle& face : faces_at(step.gone)) {
      for (std::size_t i = 0; i < 3; ++i) next_[face[i]].erase(face[(i + 1) % 3]);
      --faces_left_;
    }
    for (const Triangle& face : step.after) add_face(face);
    for (const auto& [v, share] : step.shares) quadric_[v].add(quadric_[step.gone], share);
    result_.positions[step.kept] = step.position;
    result_.vertex_map[step.gone] = step.kept;
    ++result_.steps;
    const double weight = quadric_[removes_vertices_ ? step.gone : step.kept].weight;
    if (weight > 0) result_.error = std::max(result_.error, std::sqrt(step.cost / weight));
    std::set<Vertex> changed;
    for (const auto& [v, share] : step.shares) changed.insert(v);
    for (const Triangle& face : step.after) changed.insert(face.begin(), face.end());
    price_around(changed);
  }

  const TriangleSurface& surface_;
  const DecimateOptions& options_;
  bool removes_vertices_;
  double cos_deviation_;
  std::vector<std::map<Vertex, Vertex>> next_;  // [a][b] is c for a face of a, b and c
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
