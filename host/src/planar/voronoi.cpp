#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/planar/delaunay.h>
#include <vkmesh/planar/voronoi.h>

#include "base/disjoint_sets.h"
#include "base/huge_pages.h"
#include "base/large_array.h"
#include "base/parallel.h"
#include "base/stop.h"
#include "math/circumcentre.h"
#include "planar/clip_polygon.h"

namespace vkmesh {
namespace detail {
namespace {

constexpr std::size_t kGrain = 1 << 13;

/// A Voronoi edge within the polygon. It runs where the site it is seen from lies to its left.
struct VoronoiEdge {
  std::uint32_t start, end;   // vertices
  std::uint32_t entry, exit;  // the sides of the polygon it comes from and goes to, or kInvalid
  std::uint32_t neighbour;    // the site beyond

  [[nodiscard]] VoronoiEdge seen_from_beyond(std::uint32_t site) const {
    return {end, start, exit, entry, site};
  }
};

/// The dual of a Delaunay triangulation within a polygon.
///
/// All is decided as if each side of the polygon were moved inward by an infinitesimal amount, infinitely
/// more than all sides after it (H. Edelsbrunner, E. P. Mücke, "Simulation of simplicity", 1990): no
/// circumcentre lies on a side then, and no bisector runs through a corner. Vertices that are one where
/// nothing is moved are made one.
class ClippedDual {
 public:
  ClippedDual(const HalfEdgeMesh& mesh, std::span<const DVec2> sites, const ClipPolygon& polygon)
      : mesh_(mesh),
        sites_(sites),
        polygon_(polygon),
        sites_in_range_(all_in_filter_range(sites)),
        polygon_in_range_(all_in_filter_range(polygon.corners)),
        tolerance_(0x1p-50 * std::max({std::fabs(polygon.low.x), std::fabs(polygon.low.y),
                                       std::fabs(polygon.high.x), std::fabs(polygon.high.y)})) {}

  /// Fills all but the sites of the diagram. Errors: kInterrupted.
  Result<void> make(VoronoiDiagram& diagram, Stop& stop) {
    locate_vertices(stop);
    VKMESH_CHECK(stop.check());
    std::vector<std::uint32_t> to_clip = find_edges(stop);
    VKMESH_CHECK(stop.check());
    number_vertices();
    if (mesh_.face_count() > 0)
      clip_edges(to_clip);
    else
      clip_bisectors_in_line();
    centres_ = {};
    VKMESH_CHECK(stop.check());
    join_cells(diagram, stop);
    VKMESH_CHECK(stop.check());
    diagram.vertices = std::move(vertices_);
    return {};
  }

 private:
  // Where the circumcentre of a triangle is: within the polygon; on a side or a corner; or beyond the sides
  // of its bounds that the low bits say, or of the polygon.
  static constexpr std::uint8_t kWithin = 0, kOn = 16, kOutside = 32, kBeyondBounds = 15;
  static constexpr std::uint32_t kInfinity = kInvalid;  // of the triangle beyond an edge of the hull

  [[nodiscard]] std::array<DVec2, 3> corners_of(std::uint32_t t) const {
    const std::uint32_t* const v = mesh_.origins().data() + 3 * std::size_t{t};
    return {sites_[v[0]], sites_[v[1]], sites_[v[2]]};
  }
  /// Whether bounds of rounding errors hold for these sites and the polygon.
  [[nodiscard]] bool in_range(std::span<const DVec2> sites) const {
    return polygon_in_range_ && (sites_in_range_ || all_in_filter_range(sites));
  }
  [[nodiscard]] RoundedCircumcentre rounded(const std::array<DVec2, 3>& p) const {
    if (!in_range(p)) return {DVec2(0, 0), std::numeric_limits<double>::infinity(), 0};
    return rounded_circumcentre(p[0], p[1], p[2]);
  }

  /// Where a circumcentre lies of side s: 1 left of it, which is inside, 0 on its line, -1 right.
  [[nodiscard]] int side_of(const std::array<DVec2, 3>& p, const RoundedCircumcentre& c,
                            std::uint32_t s) const {
    const DVec2 k = polygon_.corners[s], l = polygon_.corners[polygon_.next(s)];
    const double ex = l.x - k.x, ey = l.y - k.y, x = c.place.x - k.x, y = c.place.y - k.y;
    const double left = ex * y, right = ey * x;
    const double bound =
        1.01 * c.error * (std::fabs(ex) + std::fabs(ey)) + 0x1p-50 * (std::fabs(left) + std::fabs(right));
    if (left - right > bound) return 1;
    if (left - right < -bound) return -1;
    return exact_circumcentre_side(p[0], p[1], p[2], k, l);
  }
  [[nodiscard]] int side_of(std::uint32_t t, std::uint32_t s) const {
    const auto p = corners_of(t);
    return side_of(p, rounded(p), s);
  }

  /// Circumcentres that are within the polygon or on it, and for all where they are.
  void locate_vertices(Stop& stop) {
    const std::size_t count = mesh_.face_count();
    centres_ = LargeArray<DVec2>(count);
    where_ = LargeArray<std::uint8_t>(count);
    parallel_ranges(count, kGrain, [&](std::size_t begin, std::size_t end) {
      if (!goes_on(&stop)) return;
      for (std::size_t t = begin; t < end; ++t) locate(static_cast<std::uint32_t>(t));
    });
  }
  void locate(std::uint32_t t) {
    const auto p = corners_of(t);
    const RoundedCircumcentre c = rounded(p);
    const DVec2 low = polygon_.low, high = polygon_.high;
    const double margin = 2 * tolerance_;
    centres_[t] = c.place;
    const double tolerance = std::min(tolerance_, c.tolerance);
    if (c.error <= tolerance && polygon_.is_box && c.place.x - low.x > margin && c.place.y - low.y > margin &&
        high.x - c.place.x > margin && high.y - c.place.y > margin) {
      where_[t] = kWithin;
      return;
    }
    const double error = 1.01 * c.error;
    const int beyond = (low.x - c.place.x > error ? 1 : 0) | (c.place.x - high.x > error ? 2 : 0) |
                       (low.y - c.place.y > error ? 4 : 0) | (c.place.y - high.y > error ? 8 : 0);
    if (beyond != 0) {
      where_[t] = static_cast<std::uint8_t>(kOutside | beyond);
      return;
    }
    where_[t] = kWithin;
    for (std::uint32_t s = 0; s < polygon_.size(); ++s) {
      const int side = side_of(p, c, s);
      if (side == 0) where_[t] = kOn;
      if (side >= 0) continue;
      where_[t] = kOutside;
      return;
    }
    if (where_[t] == kOn || !(c.error <= tolerance)) centres_[t] = exact_circumcentre(p[0], p[1], p[2]);
  }

  /// Edges of which an end is not within the polygon and which may cross it; makes one what is the same
  /// vertex.
  [[nodiscard]] std::vector<std::uint32_t> find_edges(Stop& stop) {
    struct Found {
      std::vector<std::uint32_t> same, to_clip;
    };
    std::vector<std::uint32_t> same, to_clip;
    const std::span<const std::uint32_t> twins = mesh_.twins();
    parallel_in_order<Found>(
        twins.size(), 4 * kGrain,
        [&](std::size_t begin, std::size_t end, Found& found) {
          found.same.clear();
          found.to_clip.clear();
          if (!goes_on(&stop)) return;
          for (std::size_t i = begin; i < end; ++i) {
            const auto h = static_cast<std::uint32_t>(i);
            const std::uint32_t twin = twins[h];
            if (twin < h) continue;  // kInvalid is the greatest number
            const std::uint8_t here = where_[h / 3], there = twin == kInvalid ? kOutside : where_[twin / 3];
            if (here != kWithin || there != kWithin) {
              if ((here & there & kBeyondBounds) == 0) found.to_clip.push_back(h);
              if (((here | there) & kOutside) != 0) continue;
            }
            if (is_of_no_length(h, twin)) found.same.push_back(h);
          }
        },
        [&](std::size_t, std::size_t, Found& found) {
          same.insert(same.end(), found.same.begin(), found.same.end());
          to_clip.insert(to_clip.end(), found.to_clip.begin(), found.to_clip.end());
        });
    if (!same.empty()) {
      first_of_vertex_.emplace(mesh_.face_count());
      for (const std::uint32_t h : same) first_of_vertex_->unite(h / 3, twins[h] / 3);
    }
    return to_clip;
  }
  /// Whether the sites of the two triangles are cocircular. Asked exactly where the vertices are near.
  [[nodiscard]] bool is_of_no_length(std::uint32_t h, std::uint32_t twin) const {
    const DVec2 a = centres_[h / 3], b = centres_[twin / 3];
    if (std::fabs(a.x - b.x) > 3 * tolerance_ || std::fabs(a.y - b.y) > 3 * tolerance_) return false;
    const auto p = corners_of(h / 3);
    const DVec2 across = sites_[mesh_.origin(mesh_.previous(HalfEdgeId(twin))).index];
    return FilteredPredicates(sites_in_range_).in_circle(p[0], p[1], p[2], across) == 0;
  }
  [[nodiscard]] std::uint32_t first_triangle(std::uint32_t t) {
    return first_of_vertex_ ? first_of_vertex_->find(t) : t;
  }

  /// Vertices within the polygon in the order of triangles, then the corners of the polygon.
  void number_vertices() {
    const auto count = static_cast<std::uint32_t>(mesh_.face_count());
    vertex_of_ = LargeArray<std::uint32_t>(count);
    std::size_t within = 0;
    for (std::uint32_t t = 0; t < count; ++t) within += where_[t] == kWithin ? 1 : 0;
    vertices_.reserve(within + within / 64 + polygon_.size());
    prefer_large_pages(vertices_.data(), vertices_.capacity() * sizeof(DVec2));
    for (std::uint32_t t = 0; t < count; ++t) {
      vertex_of_[t] = kInvalid;
      if (where_[t] != kWithin) continue;
      const std::uint32_t first = first_triangle(t);
      vertex_of_[t] = first == t ? add_vertex(centres_[t]) : vertex_of_[first];
    }
    first_corner_ = static_cast<std::uint32_t>(vertices_.size());
    vertices_.insert(vertices_.end(), polygon_.corners.begin(), polygon_.corners.end());
  }
  std::uint32_t add_vertex(DVec2 place) {
    vertices_.push_back(place);
    return static_cast<std::uint32_t>(vertices_.size() - 1);
  }

  /// The vertex at the circumcentre of a triangle on the polygon's boundary.
  std::uint32_t vertex_on_boundary(std::uint32_t t) {
    const std::uint32_t first = first_triangle(t);
    if (vertex_of_[first] == kInvalid) vertex_of_[first] = add_vertex(centres_[first]);
    return vertex_of_[first];
  }

  /// Where a corner lies of the bisector of p and q: 1 nearer to q, 0 on it, -1 nearer to p.
  [[nodiscard]] int bisector_side(DVec2 p, DVec2 q, std::uint32_t corner) const {
    const DVec2 k = polygon_.corners[corner];
    if (in_range(std::array{p, q})) {
      const RoundedDifference difference = rounded_bisector_side(p, q, k);
      if (difference.value > difference.error) return 1;
      if (difference.value < -difference.error) return -1;
    }
    return exact_bisector_side(p, q, k);
  }
  /// The same with moved sides, when the corner lies on none. A corner goes first where the earlier one of
  /// its two sides moves it, along the other.
  [[nodiscard]] bool is_nearer_to_second(DVec2 p, DVec2 q, std::uint32_t corner) const {
    int side = bisector_side(p, q, corner);
    if (side != 0) return side > 0;
    const std::uint32_t last = polygon_.size() - 1, before = corner == 0 ? last : corner - 1;
    const DVec2 here = polygon_.corners[corner];
    const DVec2 ahead = polygon_.corners[polygon_.next(corner)], back = polygon_.corners[before];
    side = sign_of_product(p, q, here, corner == 0 ? back : ahead);
    if (side == 0) side = sign_of_product(p, q, here, corner == 0 ? ahead : back);
    return side > 0;
  }

  /// The vertex where the bisector of p and q crosses side s, towards the circumcentre of t.
  std::uint32_t crossing(DVec2 p, DVec2 q, std::uint32_t s, std::uint32_t t) {
    const std::uint32_t after = polygon_.next(s);
    if (bisector_side(p, q, s) == 0) return first_corner_ + s;
    if (bisector_side(p, q, after) == 0) return first_corner_ + after;
    if (t != kInfinity && where_[t] == kOn) return vertex_on_boundary(t);
    const DVec2 k = polygon_.corners[s], l = polygon_.corners[after];
    std::optional<double> share;
    if (in_range(std::array{p, q})) {
      const RoundedDifference at_k = rounded_bisector_side(p, q, k), at_l = rounded_bisector_side(p, q, l);
      const double whole = at_k.value - at_l.value;
      if (at_k.error + at_l.error < 0x1p-52 * std::fabs(whole)) share = at_k.value / whole;
    }
    if (!share) share = exact_bisector_crossing(p, q, k, l);
    return add_vertex({std::lerp(k.x, l.x, *share), std::lerp(k.y, l.y, *share)});
  }

  /// The part within the polygon of the Voronoi edge between sites p and q, which runs, p to its left, from
  /// the circumcentre of triangle `from` to that of `to`.
  [[nodiscard]] std::optional<VoronoiEdge> clip(std::uint32_t p, std::uint32_t q, std::uint32_t from,
                                                std::uint32_t to) {
    // Corners on the left of the bisector are nearer to p: it comes in where these end, counter-clockwise.
    std::uint32_t entry = kInvalid, exit = kInvalid;
    const bool first = is_nearer_to_second(sites_[p], sites_[q], 0);
    bool here = first;
    for (std::uint32_t s = 0; s < polygon_.size(); ++s) {
      const bool next = s + 1 == polygon_.size() ? first : is_nearer_to_second(sites_[p], sites_[q], s + 1);
      if (here != next) (next ? entry : exit) = s;
      here = next;
    }
    if (entry == kInvalid) return std::nullopt;
    // On this line a point is before the polygon where it is beyond the side of entry.
    const bool from_within = from != kInfinity && where_[from] == kWithin,
               to_within = to != kInfinity && where_[to] == kWithin;
    if (!from_within && from != kInfinity && side_of(from, entry) > 0) return std::nullopt;
    if (!to_within && to != kInfinity && side_of(to, exit) > 0) return std::nullopt;
    VoronoiEdge edge{kInvalid, kInvalid, kInvalid, kInvalid, q};
    if (from_within) {
      edge.start = vertex_of_[from];
    } else {
      edge.start = crossing(sites_[p], sites_[q], entry, from);
      edge.entry = entry;
    }
    if (to_within) {
      edge.end = vertex_of_[to];
    } else {
      edge.end = crossing(sites_[p], sites_[q], exit, to);
      edge.exit = exit;
    }
    return edge;
  }

  void clip_edges(const std::vector<std::uint32_t>& half_edges) {
    for (const std::uint32_t h : half_edges) {
      const HalfEdgeId e(h), twin = mesh_.twin(e);
      const auto edge = clip(mesh_.origin(e).index, mesh_.target(e).index,
                             twin.valid() ? twin.index / 3 : kInfinity, h / 3);
      if (edge) clipped_.push_back({h, *edge});
    }
  }
  /// Sites that are all on one line, or one site.
  void clip_bisectors_in_line() {
    in_line_.resize(sites_.size());
    std::iota(in_line_.begin(), in_line_.end(), std::uint32_t{0});
    std::sort(in_line_.begin(), in_line_.end(), [&](std::uint32_t i, std::uint32_t j) {
      return sites_[i].x != sites_[j].x ? sites_[i].x < sites_[j].x : sites_[i].y < sites_[j].y;
    });
    for (std::uint32_t i = 0; i + 1 < in_line_.size(); ++i) {
      const auto edge = clip(in_line_[i], in_line_[i + 1], kInfinity, kInfinity);
      if (edge) clipped_.push_back({i, *edge});
    }
  }
  [[nodiscard]] const VoronoiEdge* find_clipped(std::uint32_t key) const {
    const auto found = std::lower_bound(clipped_.begin(), clipped_.end(), key,
                                        [](const Clipped& c, std::uint32_t k) { return c.key < k; });
    return found != clipped_.end() && found->key == key ? &found->edge : nullptr;
  }

  struct Corner {
    std::uint32_t vertex, neighbour;
  };
  struct Block {
    std::vector<std::uint32_t> corners, neighbours, sizes;
    std::vector<VoronoiEdge> edges;
    std::vector<Corner> around;
  };

  void join_cells(VoronoiDiagram& diagram, Stop& stop) const {
    std::vector<std::uint32_t> position;  // of collinear sites
    if (mesh_.face_count() == 0) {
      position.resize(sites_.size());
      for (std::uint32_t i = 0; i < in_line_.size(); ++i) position[in_line_[i]] = i;
    }
    const bool one_cell = first_corner_ == 0 && clipped_.empty();
    const std::uint32_t owner = one_cell ? nearest_to_first_corner() : kInvalid;
    const std::size_t most = mesh_.half_edge_count() + 4 * clipped_.size() + 2 * std::size_t{polygon_.size()};
    for (std::vector<std::uint32_t>* list : {&diagram.corners, &diagram.neighbours}) {
      list->clear();
      list->reserve(most);
      prefer_large_pages(list->data(), most * sizeof(std::uint32_t));
    }
    diagram.cell_offsets.assign(1, 0);
    diagram.cell_offsets.reserve(sites_.size() + 1);
    parallel_in_order<Block>(
        sites_.size(), kGrain,
        [&](std::size_t begin, std::size_t end, Block& block) {
          block.corners.clear();
          block.neighbours.clear();
          block.sizes.clear();
          if (!goes_on(&stop)) return;
          for (std::size_t i = begin; i < end; ++i) {
            const std::size_t before = block.corners.size();
            const auto site = static_cast<std::uint32_t>(i);
            if (!join_inner_cell(site, block)) {
              block.edges.clear();
              if (mesh_.face_count() > 0)
                gather_edges(site, block.edges);
              else
                gather_edges_in_line(position[site], block.edges);
              if (!block.edges.empty())
                join_edges(block);
              else if (site == owner)
                join_polygon(block);
            }
            block.sizes.push_back(static_cast<std::uint32_t>(block.corners.size() - before));
          }
        },
        [&](std::size_t, std::size_t, Block& block) {
          diagram.corners.insert(diagram.corners.end(), block.corners.begin(), block.corners.end());
          diagram.neighbours.insert(diagram.neighbours.end(), block.neighbours.begin(),
                                    block.neighbours.end());
          for (const std::uint32_t size : block.sizes)
            diagram.cell_offsets.push_back(diagram.cell_offsets.back() + size);
        });
  }

  static void add(Block& block, std::uint32_t vertex, std::uint32_t neighbour) {
    block.corners.push_back(vertex);
    block.neighbours.push_back(neighbour);
  }
  /// A cell whose vertices are all within the polygon; false, and nothing added, for others.
  bool join_inner_cell(std::uint32_t site, Block& block) const {
    const std::uint32_t first = mesh_.leadings()[site];
    if (first == kInvalid || mesh_.twins()[first] == kInvalid) return false;
    const std::size_t before = block.corners.size();
    const std::uint32_t* const origins = mesh_.origins().data();
    const std::uint32_t* const twins = mesh_.twins().data();
    std::uint32_t last = vertex_of_[twins[first] / 3], h = first;
    do {
      const std::uint32_t t = h / 3, k = h - 3 * t;
      const std::uint32_t next = k == 2 ? h - 2 : h + 1, previous = k == 0 ? h + 2 : h - 1;
      const std::uint32_t vertex = vertex_of_[t];
      if (where_[t] != kWithin) {
        block.corners.resize(before);
        block.neighbours.resize(before);
        return false;
      }
      if (vertex != last) add(block, last, origins[next]);
      last = vertex;
      h = twins[previous];
    } while (h != first);
    return true;
  }

  /// The Voronoi edges of a cell, counter-clockwise.
  void gather_edges(std::uint32_t site, std::vector<VoronoiEdge>& edges) const {
    HalfEdgeId h = mesh_.leading(VertexId(site));
    const HalfEdgeId first = h;
    while (h.valid()) {
      const HalfEdgeId twin = mesh_.twin(h), incoming = mesh_.previous(h);
      if (twin.valid() && where_[h.index / 3] == kWithin && where_[twin.index / 3] == kWithin)
        edges.push_back(
            {vertex_of_[twin.index / 3], vertex_of_[h.index / 3], kInvalid, kInvalid, mesh_.target(h).index});
      else if (!twin.valid() || h < twin)
        gather_clipped(h.index, false, site, edges);
      else
        gather_clipped(twin.index, true, mesh_.target(h).index, edges);
      h = mesh_.twin(incoming);
      if (!h.valid()) gather_clipped(incoming.index, true, mesh_.origin(incoming).index, edges);
      if (h == first) return;
    }
  }
  void gather_edges_in_line(std::uint32_t position, std::vector<VoronoiEdge>& edges) const {
    gather_clipped(position, false, kInvalid, edges);
    if (position > 0) gather_clipped(position - 1, true, in_line_[position - 1], edges);
  }
  void gather_clipped(std::uint32_t key, bool from_beyond, std::uint32_t beyond,
                      std::vector<VoronoiEdge>& edges) const {
    if (const VoronoiEdge* const edge = find_clipped(key))
      edges.push_back(from_beyond ? edge->seen_from_beyond(beyond) : *edge);
  }

  /// The cell of some Voronoi edges, with the parts of the polygon's boundary between them.
  void join_edges(Block& block) const {
    block.around.clear();
    for (std::size_t i = 0; i < block.edges.size(); ++i) {
      const VoronoiEdge& edge = block.edges[i];
      block.around.push_back({edge.start, edge.neighbour});
      if (edge.exit == kInvalid) continue;
      block.around.push_back({edge.end, kInvalid});
      const std::uint32_t entry = block.edges[i + 1 == block.edges.size() ? 0 : i + 1].entry;
      for (std::uint32_t s = edge.exit; s != entry;) {
        s = polygon_.next(s);
        block.around.push_back({first_corner_ + s, kInvalid});
      }
    }
    // What the moved sides parted is one vertex again.
    for (std::size_t i = 0; i < block.around.size(); ++i) {
      const Corner& corner = block.around[i];
      const Corner& next = block.around[i + 1 == block.around.size() ? 0 : i + 1];
      if (corner.vertex != next.vertex) add(block, corner.vertex, corner.neighbour);
    }
  }
  void join_polygon(Block& block) const {
    for (std::uint32_t s = 0; s < polygon_.size(); ++s) add(block, first_corner_ + s, kInvalid);
  }
  [[nodiscard]] std::uint32_t nearest_to_first_corner() const {
    std::uint32_t nearest = 0;
    for (std::uint32_t i = 1; i < sites_.size(); ++i)
      if (is_nearer_to_second(sites_[nearest], sites_[i], 0)) nearest = i;
    return nearest;
  }

  struct Clipped {
    std::uint32_t key;  // the half-edge, or the position on the line
    VoronoiEdge edge;
  };

  const HalfEdgeMesh& mesh_;
  std::span<const DVec2> sites_;
  const ClipPolygon& polygon_;
  bool sites_in_range_, polygon_in_range_;
  double tolerance_;
  LargeArray<DVec2> centres_;                    // by triangle
  LargeArray<std::uint8_t> where_;               // by triangle
  LargeArray<std::uint32_t> vertex_of_;          // by triangle
  std::optional<DisjointSets> first_of_vertex_;  // triangles with the same circumcentre
  std::vector<std::uint32_t> in_line_;           // collinear sites in order
  std::vector<Clipped> clipped_;                 // by key
  std::vector<DVec2> vertices_;
  std::uint32_t first_corner_ = 0;
};

/// Twice the area of a cell, and its first moments about its first vertex times 6.
struct Moments {
  double area = 0;
  DVec2 first{0.0};
};
Moments moments_of(const VoronoiDiagram& diagram, std::size_t i) {
  Moments sum;
  const std::span<const std::uint32_t> cell = diagram.cell(i);
  for (std::size_t k = 1; k + 1 < cell.size(); ++k) {
    const DVec2 a = diagram.vertices[cell[k]] - diagram.vertices[cell[0]],
                b = diagram.vertices[cell[k + 1]] - diagram.vertices[cell[0]];
    const double area = a.x * b.y - a.y * b.x;
    sum.area += area;
    sum.first += area * (a + b);
  }
  return sum;
}

Result<VoronoiDiagram> diagram_of(std::span<const DVec2> points, const VoronoiOptions& options,
                                  const Progress& progress) {
  VoronoiDiagram diagram;
  ClipPolygon polygon;
  const double rounds = 1.0 + options.lloyd_iterations;
  for (unsigned round = 0;; ++round) {
    constexpr double kOfTriangulation = 0.75;
    const Progress part = [&](double fraction) { return !progress || progress((round + fraction) / rounds); };
    VKMESH_TRY(DelaunayTriangulation dual,
               delaunay(round == 0 ? points : diagram.sites,
                        [&](double fraction) { return part(kOfTriangulation * fraction); }));
    if (round == 0) {
      VKMESH_TRY(polygon, ClipPolygon::of(options.clip.empty() ? bounds_of_sites(points) : options.clip));
    }
    std::vector<DVec2> sites(dual.point_of_vertex.size());
    parallel_ranges(sites.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        sites[i] = round == 0 ? points[dual.point_of_vertex[i]] : diagram.sites[dual.point_of_vertex[i]];
    });
    diagram.sites = std::move(sites);
    if (round == 0) {
      diagram.site_of_point = std::move(dual.vertex_of_point);
      diagram.point_of_site = std::move(dual.point_of_vertex);
    } else {
      for (std::uint32_t& site : diagram.site_of_point) site = dual.vertex_of_point[site];
      diagram.point_of_site.resize(diagram.sites.size());
      for (std::size_t i = points.size(); i-- > 0;)
        diagram.point_of_site[diagram.site_of_point[i]] = static_cast<std::uint32_t>(i);
    }
    const Progress rest = [&](double) { return part(kOfTriangulation); };
    Stop stop(rest, Stop::Clock::now(), std::numeric_limits<double>::infinity());
    VKMESH_CHECK(ClippedDual(dual.mesh, diagram.sites, polygon).make(diagram, stop));
    if (round == options.lloyd_iterations) return diagram;
    parallel_ranges(diagram.sites.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) diagram.sites[i] = diagram.centroid(i);
    });
  }
}

}  // namespace
}  // namespace detail

double VoronoiDiagram::area(std::size_t i) const {
  return 0.5 * detail::moments_of(*this, i).area;
}

DVec2 VoronoiDiagram::centroid(std::size_t i) const {
  const detail::Moments moments = detail::moments_of(*this, i);
  if (!(moments.area > 0)) return sites[i];
  const DVec2 centroid = vertices[cell(i)[0]] + moments.first / (3 * moments.area);
  return std::isfinite(centroid.x) && std::isfinite(centroid.y) ? centroid : sites[i];
}

Result<VoronoiDiagram> voronoi(std::span<const DVec2> points, const VoronoiOptions& options,
                               const Progress& progress) {
  return detail::catching([&]() -> Result<VoronoiDiagram> {
    if (points.empty() && options.clip.empty()) {
      VoronoiDiagram none;
      none.cell_offsets = {0};
      return none;
    }
    return detail::diagram_of(points, options, progress);
  });
}

std::vector<DVec2> bounds_of_sites(std::span<const DVec2> points) {
  if (points.empty()) return {};
  DVec2 low = points[0], high = points[0];
  for (const DVec2 p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  constexpr double kMost = std::numeric_limits<double>::max();
  // A tenth of each, whose difference does not overflow.
  double margin = std::max(0.1 * high.x - 0.1 * low.x, 0.1 * high.y - 0.1 * low.y);
  if (low == high) margin = std::max({1.0, 0.1 * std::fabs(low.x), 0.1 * std::fabs(low.y)});
  const auto below = [&](double x) { return std::max(x - margin, -kMost); };
  const auto above = [&](double x) { return std::min(x + margin, kMost); };
  low = {below(low.x), below(low.y)};
  high = {above(high.x), above(high.y)};
  return {low, {high.x, low.y}, high, {low.x, high.y}};
}

}  // namespace vkmesh
