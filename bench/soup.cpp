// A soup into half-edges, beside one sort of its edges: what consolidation by a comparison sort cannot be
// faster than.
#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <vkmesh/repair/consolidate.h>
#include <vkmesh/repair/weld.h>

#include "bench/contestants.h"

namespace vkmesh::bench {
namespace {

/// An edge of a triangle, as the lecture's helper list holds it: the ends in ascending order.
struct Edge {
  std::uint32_t a, b, triangle;
  friend bool operator<(const Edge& x, const Edge& y) { return std::tie(x.a, x.b) < std::tie(y.a, y.b); }
};

}  // namespace

void add_soup(Programme& programme, const Input& input) {
  const auto soup = std::make_shared<PolygonSoup>();
  soup->corners.reserve(input.mesh.corners.size());
  for (const std::uint32_t c : input.mesh.corners) soup->corners.push_back(input.mesh.points[c]);

  programme.contestants.push_back(
      {step::kSoup, "vkmesh, CPU: weld, repair, half-edges", [soup]() -> Result<double> {
         const Stopwatch watch;
         VKMESH_TRY(IndexedFaceSet mesh, weld(*soup));
         VKMESH_TRY(const Consolidated made, consolidate(std::move(mesh)));
         static_cast<void>(made);
         return watch.milliseconds();
       }});
  programme.contestants.push_back({step::kSoup, "one std::sort of the edges", [&input]() -> Result<double> {
                                     std::vector<Edge> edges;
                                     edges.reserve(input.mesh.corners.size());
                                     for (std::uint32_t t = 0; t < input.mesh.face_count(); ++t) {
                                       const auto v = input.mesh.face(t);
                                       for (std::size_t i = 0; i < 3; ++i) {
                                         const auto [a, b] = std::minmax(v[i], v[(i + 1) % 3]);
                                         edges.push_back({a, b, t});
                                       }
                                     }
                                     const Stopwatch watch;
                                     std::sort(edges.begin(), edges.end());
                                     const double milliseconds = watch.milliseconds();
                                     if (!std::is_sorted(edges.begin(), edges.end()))
                                       return fail(ErrorCode::kInternal, "not sorted");
                                     return milliseconds;
                                   }});
}

}  // namespace vkmesh::bench
