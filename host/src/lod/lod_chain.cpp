// The levels of one decimation, and their common vertex buffer.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/lod/lod_chain.h>
#include <vkmesh/math/bounds.h>
#include <vkmesh/mesh/handles.h>

#include "decimation/decimate_levels.h"
#include "lod/vertex_cache.h"

namespace vkmesh {
namespace {

using detail::LevelTarget;

Result<void> check(const LodChainOptions& options, double diagonal) {
  const auto usage = [](const char* what) -> Result<void> { return fail(ErrorCode::kUsage, what); };
  if ((options.ratios.empty() ? 0 : 1) + (options.errors.empty() ? 0 : 1) + (options.count > 0 ? 1 : 0) != 1)
    return usage("a chain of levels takes one of ratios, errors and a count");
  double before = 1;
  for (const double ratio : options.ratios) {
    if (!(ratio > 0 && ratio < before)) return usage("ratios of levels must fall, between 1 and 0");
    before = ratio;
  }
  before = 0;
  for (const Length& error : options.errors) {
    const double units = error.in_units(diagonal);
    if (!(units > before && std::isfinite(units))) return usage("errors of levels must rise, above 0");
    before = units;
  }
  if (!(options.reduction > 0 && options.reduction < 1))
    return usage("the reduction from level to level must be between 0 and 1");
  const DecimateTargets& target = options.decimate.target;
  if (target.faces || target.vertices || target.ratio)
    return usage(
        "the levels of a chain are its targets: the decimation may have none of its own but the time");
  if (options.decimate.keep_history) return usage("a chain of levels keeps no history");
  if (options.decimate.bounds.error && !options.errors.empty())
    return usage("the errors of a chain's levels are its bounds: the decimation may have none of its own");
  if (options.vertices == LodVertices::kShared &&
      options.decimate.operation == DecimateOperation::kEdgeCollapse)
    return usage("edge collapses move points, so that levels cannot share them: take half-edge collapses");
  if (options.optimize && !has_vertex_cache_order())
    return usage("this vkmesh was built without meshoptimizer, which orders faces for vertex caches");
  return {};
}

/// Level 0 first, which removes nothing.
std::vector<LevelTarget> targets_of(const LodChainOptions& options, std::size_t faces) {
  std::vector<LevelTarget> targets = {{std::numeric_limits<std::size_t>::max(), std::nullopt}};
  const auto add_share = [&](double share) {
    targets.push_back({static_cast<std::size_t>(std::llround(share * static_cast<double>(faces))), {}});
  };
  for (const double ratio : options.ratios) add_share(ratio);
  for (const Length& error : options.errors) targets.push_back({0, error});
  for (std::size_t k = 1; k < options.count; ++k) {
    add_share(std::pow(options.reduction, static_cast<double>(k)));
    if (targets.back().faces == 0) break;
  }
  return targets;
}

/// Numbers of what levels use, by first use.
class FirstUse {
 public:
  explicit FirstUse(std::size_t most) : number_(most, kInvalid) {}
  void use(std::uint32_t i) {
    if (number_[i] == kInvalid) number_[i] = count_++;
  }
  [[nodiscard]] std::uint32_t operator[](std::uint32_t i) const { return number_[i]; }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  std::vector<std::uint32_t> number_;
  std::uint32_t count_ = 0;
};

/// Values of `width` each, value i at to[i].
template <class T>
void permute(std::vector<T>& values, std::span<const std::uint32_t> to, std::size_t width = 1) {
  std::vector<T> moved(values.size());
  for (std::size_t i = 0; i < to.size(); ++i) std::copy_n(&values[i * width], width, &moved[to[i] * width]);
  values = std::move(moved);
}

void order_faces(LodLevel& level) {
  const std::span<const std::uint32_t> origins = level.mesh.origins(), twins = level.mesh.twins();
  const bool wedges = !level.attributes.corners.empty();
  const std::vector<std::uint32_t> order =
      detail::vertex_cache_order(wedges ? std::span<const std::uint32_t>(level.attributes.corners) : origins,
                                 wedges ? level.attributes.source_corner.size() : level.positions.size());
  std::vector<std::uint32_t> place(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) place[order[i]] = i;
  std::vector<std::uint32_t> origin(origins.begin(), origins.end()), twin(twins.begin(), twins.end());
  for (std::uint32_t& t : twin)
    if (t != kInvalid) t = 3 * place[t / 3] + t % 3;
  permute(origin, place, 3);
  permute(twin, place, 3);
  permute(level.source_face, place);
  if (wedges) permute(level.attributes.corners, place, 3);
  level.mesh = HalfEdgeMesh::from_twins(std::move(origin), std::move(twin), level.positions.size());
}

/// Gives vertices and wedges the numbers that are known of what they are in the input; returns those of the
/// vertices by their old ones.
std::vector<std::uint32_t> renumber(LodLevel& level, const FirstUse& vertices, const FirstUse& wedges) {
  std::vector<std::uint32_t> to;
  to.reserve(level.source_vertex.size());
  for (const std::uint32_t v : level.source_vertex) to.push_back(vertices[v]);
  std::vector<std::uint32_t> origin(level.mesh.origins().begin(), level.mesh.origins().end()),
      twin(level.mesh.twins().begin(), level.mesh.twins().end());
  for (std::uint32_t& v : origin) v = to[v];
  for (std::uint32_t& v : level.vertex_map)
    if (v != kInvalid) v = to[v];
  permute(level.positions, to);
  permute(level.source_vertex, to);
  level.mesh = HalfEdgeMesh::from_twins(std::move(origin), std::move(twin), level.positions.size());

  DecimatedAttributes& attributes = level.attributes;
  if (attributes.corners.empty()) return to;
  std::vector<std::uint32_t> wedge_to;
  wedge_to.reserve(attributes.source_corner.size());
  for (const std::uint32_t c : attributes.source_corner) wedge_to.push_back(wedges[c]);
  for (std::uint32_t& w : attributes.corners) w = wedge_to[w];
  for (std::vector<float>& values : attributes.values)
    permute(values, wedge_to, values.size() / wedge_to.size());
  permute(attributes.source_corner, wedge_to);
  return to;
}

/// Numbers by first use: of all levels together, the coarsest first, where they share vertices, and of each
/// by itself where they do not.
void number_by_use(std::span<LodLevel> levels, const TriangleSurface& surface, LodVertices whose) {
  const auto use = [](const LodLevel& level, FirstUse& vertices, FirstUse& wedges) {
    for (const std::uint32_t v : level.mesh.origins()) vertices.use(level.source_vertex[v]);
    for (const std::uint32_t w : level.attributes.corners) wedges.use(level.attributes.source_corner[w]);
  };
  const FirstUse none_of_vertices(surface.points.size()), none_of_wedges(surface.corners.size());
  FirstUse vertices = none_of_vertices, wedges = none_of_wedges;
  if (whose == LodVertices::kShared)
    for (std::size_t k = levels.size(); k-- > 0;) use(levels[k], vertices, wedges);
  std::vector<std::uint32_t> before;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    if (whose == LodVertices::kOwn) {
      vertices = none_of_vertices;
      wedges = none_of_wedges;
      use(levels[k], vertices, wedges);
    }
    std::vector<std::uint32_t> to = renumber(levels[k], vertices, wedges);
    if (k > 0) permute(levels[k].vertex_map, before);  // which begins at the level before
    before = std::move(to);
  }
}

Result<LodChain> make(const TriangleSurface& surface, const LodChainOptions& options,
                      const Progress& progress) {
  Bounds bounds;
  for (const std::uint32_t v : surface.corners)
    if (v < surface.points.size()) bounds.add(surface.points[v]);
  VKMESH_CHECK(check(options, bounds.diagonal()));
  const double share = options.measure ? 0.5 : 1.0;
  const auto part = [&](double from, double to) -> Progress {
    if (!progress) return {};
    return [&progress, from, to](double fraction) { return progress(from + (to - from) * fraction); };
  };

  VKMESH_TRY(std::vector<Decimated> made,
             detail::decimate_levels(surface, options.decimate,
                                     targets_of(options, surface.corners.size() / 3), {}, part(0, share)));
  if (made.empty()) {  // the time was over
    DecimateOptions at_once = options.decimate;
    at_once.target.seconds = 0;
    VKMESH_TRY(Decimated unchanged, decimate(surface, at_once));
    made.push_back(std::move(unchanged));
  }
  LodChain chain;
  chain.last = made.back();
  for (Decimated& level : made)
    if (chain.levels.empty() || level.mesh.face_count() < chain.levels.back().mesh.face_count())
      chain.levels.push_back({std::move(level), std::nullopt});

  std::span<LodLevel> levels(chain.levels);
  if (options.optimize)
    for (LodLevel& level : levels) order_faces(level);
  if (options.optimize || options.vertices == LodVertices::kShared)
    number_by_use(levels, surface, options.vertices);

  for (std::size_t k = 0; k < levels.size() && options.measure; ++k) {
    const double all = static_cast<double>(levels.size()), done = static_cast<double>(k);
    VKMESH_TRY(
        levels[k].distance,
        surface_distance(surface, {levels[k].positions, levels[k].mesh.origins()}, options.measuring,
                         part(share + (1 - share) * done / all, share + (1 - share) * (done + 1) / all)));
  }
  return chain;
}

}  // namespace

Result<LodChain> lod_chain(const TriangleSurface& surface, const LodChainOptions& options,
                           const Progress& progress) {
  return detail::catching([&] { return make(surface, options, progress); });
}

}  // namespace vkmesh
