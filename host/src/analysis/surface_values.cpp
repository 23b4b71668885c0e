#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include <glm/geometric.hpp>

#include <vkmesh/analysis/surface_values.h>
#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/math/arithmetic.h>

namespace vkmesh {
namespace {

using glm::cross;
using glm::dot;
using glm::length;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

Result<void> require_points(const IndexedFaceSet& mesh) {
  const auto bad = std::find_if(mesh.corners.begin(), mesh.corners.end(),
                                [&](std::uint32_t c) { return c >= mesh.points.size(); });
  if (bad == mesh.corners.end()) return {};
  return fail(ErrorCode::kUsage, "corner " + std::to_string(bad - mesh.corners.begin()) + " names no point");
}

Result<void> require_triangles(const IndexedFaceSet& mesh) {
  if (mesh.is_triangles() && mesh.corners.size() % 3 == 0) return {};
  return fail(ErrorCode::kUnsuitable, "this takes triangles only: triangulate the polygons first");
}

/// Twice the area of a face along its normal.
DVec3 newell(const IndexedFaceSet& mesh, std::size_t f) {
  const auto corners = mesh.face(f);
  DVec3 sum(0.0);
  if (corners.size() < 3) return sum;
  // Relative to one of its points, so that faces far from zero keep their digits.
  const DVec3 origin(mesh.points[corners[0]]);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    sum += cross(DVec3(mesh.points[corners[i]]) - origin, DVec3(mesh.points[corners[i + 1]]) - origin);
  return sum;
}

/// A side of a face, filed under the smaller of its points.
struct Side {
  std::uint32_t high, face;
  bool ascending;
};

/// Nearest neighbours by halving boxes: a node is a range of `order`, split at its middle.
class PointTree {
 public:
  explicit PointTree(std::span<const Vec3> points) : points_(points), order_(points.size()) {
    std::iota(order_.begin(), order_.end(), std::uint32_t{0});
    axes_.resize(points.size());
    build(0, order_.size());
  }

  /// The squared distance to the k-th nearest other point. `heap` is scratch.
  float kth_squared_distance(std::uint32_t point, std::size_t k, std::vector<float>& heap) const {
    heap.clear();
    search(0, order_.size(), point, k, heap);
    return heap.empty() ? 0.0f : heap.front();
  }

 private:
  void build(std::size_t begin, std::size_t end) {
    if (end - begin < 2) return;
    Vec3 low = points_[order_[begin]], high = low;
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3& p = points_[order_[i]];
      for (int a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], p[a]);
        high[a] = std::max(high[a], p[a]);
      }
    }
    int axis = 0;
    for (int a = 1; a < 3; ++a)
      if (high[a] - low[a] > high[axis] - low[axis]) axis = a;
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end),
                     [&](std::uint32_t a, std::uint32_t b) { return points_[a][axis] < points_[b][axis]; });
    axes_[middle] = static_cast<std::uint8_t>(axis);
    build(begin, middle);
    build(middle + 1, end);
  }

  void search(std::size_t begin, std::size_t end, std::uint32_t point, std::size_t k,
              std::vector<float>& heap) const {
    if (begin == end) return;
    const std::size_t middle = begin + (end - begin) / 2;
    const Vec3 away = points_[point] - points_[order_[middle]];
    if (order_[middle] != point) {
      const float distance = away.x * away.x + away.y * away.y + away.z * away.z;
      if (heap.size() < k || distance < heap.front()) {
        if (heap.size() == k) {
          std::pop_heap(heap.begin(), heap.end());
          heap.pop_back();
        }
        heap.push_back(distance);
        std::push_heap(heap.begin(), heap.end());
      }
    }
    const float across = away[axes_[middle]];
    const bool lower = across < 0.0f;
    if (lower) {
      search(begin, middle, point, k, heap);
    } else {
      search(middle + 1, end, point, k, heap);
    }
    if (heap.size() == k && across * across > heap.front()) return;
    if (lower) {
      search(middle + 1, end, point, k, heap);
    } else {
      search(begin, middle, point, k, heap);
    }
  }

  std::span<const Vec3> points_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint8_t> axes_;  ///< Of the node whose middle lies there.
};

}  // namespace

Result<std::vector<SurfaceEdge>> surface_edges(const IndexedFaceSet& mesh) {
  return detail::catching([&]() -> Result<std::vector<SurfaceEdge>> {
    VKMESH_CHECK(require_points(mesh));
    const auto for_each_side = [&](auto&& f) {
      for (std::size_t face = 0; face < mesh.face_count(); ++face) {
        const auto corners = mesh.face(face);
        for (std::size_t i = 0; i < corners.size(); ++i) {
          const std::uint32_t from = corners[i], to = corners[i + 1 == corners.size() ? 0 : i + 1];
          if (from != to) f(from, to, static_cast<std::uint32_t>(face));
        }
      }
    };
    std::vector<std::uint32_t> starts(mesh.points.size() + 1, 0);
    for_each_side(
        [&](std::uint32_t from, std::uint32_t to, std::uint32_t) { ++starts[std::min(from, to) + 1]; });
    std::partial_sum(starts.begin(), starts.end(), starts.begin());
    std::vector<Side> sides(starts.back());
    std::vector<std::uint32_t> next(starts.begin(), starts.end() - 1);
    for_each_side([&](std::uint32_t from, std::uint32_t to, std::uint32_t face) {
      sides[next[std::min(from, to)]++] = {std::max(from, to), face, from < to};
    });

    std::vector<SurfaceEdge> edges;
    edges.reserve(sides.size() / 2);
    for (std::uint32_t a = 0; a < mesh.points.size(); ++a) {
      const auto begin = sides.begin() + starts[a], end = sides.begin() + starts[a + 1];
      std::sort(begin, end, [](const Side& x, const Side& y) {
        return std::pair(x.high, x.face) < std::pair(y.high, y.face);
      });
      for (auto side = begin; side != end;) {
        SurfaceEdge edge{a, side->high, 0, side->face, kInvalid, false};
        const auto first = side;
        for (; side != end && side->high == edge.b; ++side) ++edge.faces;
        if (edge.faces > 1) edge.second_face = (first + 1)->face;
        edge.opposed = edge.faces == 2 && first->ascending != (first + 1)->ascending;
        edges.push_back(edge);
      }
    }
    return edges;
  });
}

Result<std::vector<float>> signed_dihedral_angles(const IndexedFaceSet& mesh,
                                                  std::span<const SurfaceEdge> edges) {
  return detail::catching([&]() -> Result<std::vector<float>> {
    VKMESH_CHECK(require_points(mesh));
    std::vector<DVec3> normals(mesh.face_count());
    std::vector<DVec3> centers(mesh.face_count());
    for (std::size_t f = 0; f < normals.size(); ++f) {
      normals[f] = newell(mesh, f);
      DVec3 sum(0.0);
      for (const std::uint32_t c : mesh.face(f)) sum += DVec3(mesh.points[c]);
      centers[f] = sum / static_cast<double>(std::max<std::size_t>(mesh.face(f).size(), 1));
    }
    std::vector<float> angles(edges.size(), 0.0f);
    for (std::size_t e = 0; e < edges.size(); ++e) {
      if (!edges[e].opposed) continue;
      const DVec3& n = normals[edges[e].first_face];
      const DVec3& m = normals[edges[e].second_face];
      if (!(dot(n, n) > 0.0) || !(dot(m, m) > 0.0)) continue;
      const double angle = std::atan2(length(cross(n, m)), dot(n, m));
      // Convex: the other face lies below this one's plane.
      const bool concave = dot(n, centers[edges[e].second_face] - DVec3(mesh.points[edges[e].a])) > 0.0;
      angles[e] = static_cast<float>(concave ? -angle : angle);
    }
    return angles;
  });
}

Result<std::vector<float>> mean_curvatures(const IndexedFaceSet& mesh, std::span<const SurfaceEdge> edges,
                                           std::span<const float> signed_angles) {
  return detail::catching([&]() -> Result<std::vector<float>> {
    VKMESH_CHECK(require_points(mesh));
    std::vector<double> area(mesh.points.size(), 0.0), curvature(mesh.points.size(), 0.0);
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      const auto corners = mesh.face(f);
      const double share =
          length(newell(mesh, f)) / 2.0 / static_cast<double>(std::max<std::size_t>(corners.size(), 1));
      for (const std::uint32_t c : corners) area[c] += share;
    }
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const double along = length(DVec3(mesh.points[edges[e].a]) - DVec3(mesh.points[edges[e].b]));
      const double share = along * static_cast<double>(signed_angles[e]) / 4.0;
      curvature[edges[e].a] += share;
      curvature[edges[e].b] += share;
    }
    std::vector<float> values(mesh.points.size());
    for (std::size_t v = 0; v < values.size(); ++v)
      values[v] = area[v] > 0.0 ? static_cast<float>(curvature[v] / area[v]) : kNaN;
    return values;
  });
}

Result<std::vector<float>> largest_angles(const IndexedFaceSet& mesh, std::span<const SurfaceEdge> edges,
                                          std::span<const float> signed_angles) {
  return detail::catching([&]() -> Result<std::vector<float>> {
    std::vector<float> values(mesh.points.size(), 0.0f);
    for (std::size_t e = 0; e < edges.size(); ++e)
      for (const std::uint32_t v : {edges[e].a, edges[e].b})
        values[v] = std::max(values[v], std::abs(signed_angles[e]));
    return values;
  });
}

Result<std::vector<float>> valences(const IndexedFaceSet& mesh, std::span<const SurfaceEdge> edges) {
  return detail::catching([&]() -> Result<std::vector<float>> {
    std::vector<float> values(mesh.points.size(), 0.0f);
    for (const SurfaceEdge& e : edges)
      for (const std::uint32_t v : {e.a, e.b}) values[v] += 1.0f;
    return values;
  });
}

Result<ConnectedComponents> connected_components(const IndexedFaceSet& mesh) {
  return detail::catching([&]() -> Result<ConnectedComponents> {
    VKMESH_CHECK(require_points(mesh));
    std::vector<std::uint32_t> parent(mesh.points.size());
    std::iota(parent.begin(), parent.end(), std::uint32_t{0});
    const auto root = [&](std::uint32_t v) {
      while (parent[v] != v) v = parent[v] = parent[parent[v]];
      return v;
    };
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      const auto corners = mesh.face(f);
      for (std::size_t i = 1; i < corners.size(); ++i) {
        const std::uint32_t a = root(corners[0]), b = root(corners[i]);
        // The smaller point stays the root: it is the component's first.
        parent[std::max(a, b)] = std::min(a, b);
      }
    }
    std::vector<std::size_t> faces(mesh.points.size(), 0);
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
      if (!mesh.face(f).empty()) ++faces[root(mesh.face(f)[0])];
    std::vector<std::uint32_t> roots;
    for (std::uint32_t v = 0; v < faces.size(); ++v)
      if (faces[v] > 0) roots.push_back(v);
    std::stable_sort(roots.begin(), roots.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return faces[a] > faces[b]; });
    ConnectedComponents result;
    std::vector<float> number(mesh.points.size(), kNaN);
    for (std::size_t i = 0; i < roots.size(); ++i) {
      number[roots[i]] = static_cast<float>(i);
      result.faces.push_back(faces[roots[i]]);
    }
    result.of_point.resize(mesh.points.size());
    for (std::uint32_t v = 0; v < mesh.points.size(); ++v) result.of_point[v] = number[root(v)];
    return result;
  });
}

Result<std::vector<float>> triangle_qualities(const IndexedFaceSet& mesh) {
  return detail::catching([&]() -> Result<std::vector<float>> {
    VKMESH_CHECK(require_triangles(mesh));
    VKMESH_CHECK(require_points(mesh));
    std::vector<float> values(mesh.face_count());
    for (std::size_t f = 0; f < values.size(); ++f) {
      const auto c = mesh.face(f);
      const DVec3 a(mesh.points[c[0]]), b(mesh.points[c[1]]), d(mesh.points[c[2]]);
      const double sides = dot(b - a, b - a) + dot(d - b, d - b) + dot(a - d, a - d);
      const double twice_area = length(cross(b - a, d - a));
      values[f] = sides > 0.0 ? static_cast<float>(2.0 * std::sqrt(3.0) * twice_area / sides) : 0.0f;
    }
    return values;
  });
}

Result<std::vector<Vec3>> point_normals(const IndexedFaceSet& mesh) {
  return detail::catching([&]() -> Result<std::vector<Vec3>> {
    VKMESH_CHECK(require_triangles(mesh));
    VKMESH_CHECK(require_points(mesh));
    std::vector<Vec3> p(mesh.points.size());
    VKMESH_CHECK(prepare_positions(mesh.points, p));
    std::vector<Vec3> normals(p.size(), Vec3(0.0f));
    for (std::size_t i = 0; i < mesh.corners.size(); i += 3) {
      const std::uint32_t* c = mesh.corners.data() + i;
      const Vec3 area = area_vector(p[c[0]], p[c[1]], p[c[2]]);
      for (std::size_t k = 0; k < 3; ++k) normals[c[k]] += area;
    }
    for (Vec3& n : normals) n = unit_vector(n);
    return normals;
  });
}

Result<std::vector<float>> point_spacing(std::span<const Vec3> points, unsigned neighbours) {
  return detail::catching([&]() -> Result<std::vector<float>> {
    std::vector<float> spacing(points.size(), 0.0f);
    if (points.size() < 2 || neighbours == 0) return spacing;
    const PointTree tree(points);
    std::vector<float> heap, positive;
    for (std::size_t v = 0; v < points.size(); ++v) {
      spacing[v] = std::sqrt(tree.kth_squared_distance(static_cast<std::uint32_t>(v), neighbours, heap));
      if (spacing[v] > 0.0f) positive.push_back(spacing[v]);
    }
    if (positive.empty()) return spacing;
    const auto middle = positive.begin() + static_cast<std::ptrdiff_t>(positive.size() / 2);
    std::nth_element(positive.begin(), middle, positive.end());
    for (float& s : spacing)
      if (!(s > 0.0f)) s = *middle;
    return spacing;
  });
}

}  // namespace vkmesh
