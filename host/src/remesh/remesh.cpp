// The stages of a remeshing: check, prepare, iterate, gather.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <glm/geometric.hpp>

#include <vkmesh/base/exceptions_to_result.h>
#include <vkmesh/math/bounds.h>
#include <vkmesh/passes/dihedral_angles.h>
#include <vkmesh/remesh/remesh.h>

#include "base/parallel.h"
#include "base/stop.h"
#include "math/angle.h"
#include "mesh/edit/gather.h"
#include "remesh/remesh_state.h"

namespace vkmesh {
namespace {

using namespace detail;

/// Faces that may come of it: what memory of some gigabytes holds.
constexpr double kMostFaces = 1 << 27;
/// Lengths beyond these mean the same, and floats hold them; the mesh has a diagonal of 1/2 to 1.
constexpr double kShortest = 1e-30, kLongest = 1e30;
/// How far curves may lie from their chords, as shares of the shortest target length. Boundaries of scans are
/// ragged.
constexpr double kCurveTolerance = 0.05, kBoundaryTolerance = 0.2;
/// The target length at a curve that is shorter than edges are to be, as a multiple of it.
constexpr double kOfShortCurves = 1.25;
/// So many iterations at the end bring the mesh to rest.
constexpr unsigned kResting = 3;

Result<void> usage(const char* what) {
  return fail(ErrorCode::kUsage, what);
}

Result<void> check_options(const HalfEdgeMesh& mesh, const RemeshOptions& options) {
  const auto is_length = [](const std::optional<Length>& x) {
    return !x || (x->value > 0 && std::isfinite(x->value));
  };
  const RemeshSize& size = options.size;
  if (!is_length(size.edge_length)) return usage("size.edge_length must be above 0 and finite");
  if (!is_length(size.deviation)) return usage("size.deviation must be above 0 and finite");
  if (!is_length(size.shortest) || !is_length(size.longest))
    return usage("size.shortest and size.longest must be above 0 and finite");
  if (size.faces && *size.faces == 0) return usage("size.faces must be at least 1");
  const RemeshCurves& curves = options.curves;
  if (curves.tolerance && !(curves.tolerance->value >= 0 && std::isfinite(curves.tolerance->value)))
    return usage("curves.tolerance must be at least 0 and finite");
  if (!is_length(options.max_deviation)) return usage("max_deviation must be above 0 and finite");
  if (options.seconds && !(*options.seconds >= 0)) return usage("seconds must be at least 0");
  if (std::ranges::any_of(curves.edges, [&](std::uint32_t h) { return h >= mesh.half_edge_count(); }))
    return usage("an edge of a curve is not of the mesh");
  if (std::ranges::any_of(options.locked, [&](std::uint32_t v) { return v >= mesh.vertex_count(); }))
    return usage("a locked vertex is not of the mesh");
  return {};
}

/// What the sizes of the input come to.
struct Measures {
  double scale = 1;  // of coordinates, a power of two
  // In scaled units.
  double diagonal = 0, area = 0, edges = 0;
  std::size_t edge_count = 0;
};

Result<Measures> measure(const HalfEdgeMesh& mesh, std::span<const Vec3> positions) {
  Measures all;
  DBounds bounds;
  for (const Vec3& p : positions)
    if (!(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)))
      return fail(ErrorCode::kUnsuitable, "remeshing needs finite positions");
  for (const std::uint32_t v : mesh.origins()) bounds.add(DVec3(positions[v]));
  if (const double diagonal = bounds.diagonal(); diagonal > 0) {
    int exponent = 0;
    std::frexp(diagonal, &exponent);
    all.scale = std::ldexp(1.0, -exponent);
    all.diagonal = diagonal * all.scale;
  }
  const auto at = [&](VertexId v) { return DVec3(positions[v.index]) * all.scale; };
  mesh.for_each_edge([&](HalfEdgeId h) {
    all.edges += glm::length(at(mesh.target(h)) - at(mesh.origin(h)));
    ++all.edge_count;
  });
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); h += 3) {
    const DVec3 a = at(mesh.origin(HalfEdgeId(h)));
    all.area += 0.5 * glm::length(glm::cross(at(mesh.origin(HalfEdgeId(h + 1))) - a,
                                             at(mesh.origin(HalfEdgeId(h + 2))) - a));
  }
  return all;
}

/// Edges of the input that are of curves.
Result<std::vector<bool>> find_curves(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                                      const RemeshCurves& curves) {
  std::vector<bool> is_curve(mesh.half_edge_count(), false);
  const auto add = [&](std::uint32_t h) {
    is_curve[h] = true;
    if (const std::uint32_t t = mesh.twins()[h]; t != kInvalid) is_curve[t] = true;
  };
  for (std::uint32_t h = 0; h < is_curve.size(); ++h)
    if (mesh.twins()[h] == kInvalid) is_curve[h] = true;
  for (const std::uint32_t h : curves.edges) add(h);
  if (curves.creases) {
    VKMESH_TRY(const DihedralAngles angles, dihedral_angles(mesh, positions));
    VKMESH_TRY(const std::vector<Crease> creases,
               find_creases(mesh, positions, angles.half_edge, *curves.creases));
    for (const Crease& crease : creases)
      for (const std::uint32_t h : crease.half_edges) add(h);
  }
  return is_curve;
}

class Remesher {
 public:
  Remesher(const HalfEdgeMesh& input, std::span<const Vec3> positions, const RemeshOptions& options,
           const Progress& progress)
      : input_(input),
        positions_(positions),
        options_(options),
        stop_(progress, std::chrono::steady_clock::now(),
              options.seconds.value_or(std::numeric_limits<double>::infinity())) {}

  Result<Remeshed> run() {
    VKMESH_CHECK(prepare());
    VKMESH_CHECK(iterate());
    return gather();
  }

 private:
  Result<void> prepare() {
    VKMESH_TRY(measures_, measure(input_, positions_));
    VKMESH_TRY(is_curve_, find_curves(input_, positions_, options_.curves));
    std::vector<bool> is_locked(input_.vertex_count(), false);
    for (const std::uint32_t v : options_.locked) is_locked[v] = true;
    if (options_.curves.boundary_kept)
      for (std::uint32_t v = 0; v < is_locked.size(); ++v)
        if (input_.is_boundary(VertexId(v))) is_locked[v] = true;

    surface_.emplace(input_, positions_, measures_.scale);
    if (std::find(is_curve_.begin(), is_curve_.end(), true) != is_curve_.end()) surface_->part_at(is_curve_);
    VKMESH_TRY(TargetLengths lengths, target_lengths(*surface_));
    FeatureCurves curves(*surface_, is_curve_, is_locked, 0.5 * shortest_length_);
    lengths.shorten(*surface_, curves.short_ones(longest_length_, kOfShortCurves));
    VKMESH_TRY(const double faces, count_faces(lengths));
    state_.emplace(
        RemeshState{.mesh = {},
                    .surface = *surface_,
                    .stop = stop_,
                    .curves = std::move(curves),
                    .lengths = std::move(lengths),
                    .deviation = options_.max_deviation
                                     ? DeviationBound(*surface_, in_scaled_units(*options_.max_deviation))
                                     : DeviationBound(*surface_),
                    .scale = measures_.scale,
                    .inverse_scale = 1 / measures_.scale});
    const double tolerance = options_.curves.tolerance && options_.curves.tolerance->value > 0
                                 ? in_scaled_units(*options_.curves.tolerance)
                             : options_.curves.tolerance ? 0
                                                         : kCurveTolerance * shortest_length_;
    const double of_boundary = options_.curves.tolerance ? tolerance : kBoundaryTolerance * shortest_length_;
    const double most = options_.max_deviation
                            ? DeviationBound::kAtSamples * in_scaled_units(*options_.max_deviation)
                            : kLongest;
    state_->curve_tolerance2 = std::min(tolerance, most) * std::min(tolerance, most);
    state_->boundary_tolerance2 = std::min(of_boundary, most) * std::min(of_boundary, most);
    state_->splits_left = 1000 + 2 * static_cast<std::size_t>(faces);
    return build();
  }

  [[nodiscard]] double in_scaled_units(const Length& length) const {
    const double scaled = length.value * (length.is_relative ? measures_.diagonal : measures_.scale);
    return std::clamp(scaled, kShortest, kLongest);
  }

  Result<TargetLengths> target_lengths(const OriginalSurface& surface) {
    const RemeshSize& size = options_.size;
    if (size.deviation && !size.edge_length && !size.faces) {
      const double deviation = in_scaled_units(*size.deviation);
      shortest_length_ = size.shortest ? in_scaled_units(*size.shortest) : 2 * deviation;
      longest_length_ = size.longest ? in_scaled_units(*size.longest) : 40 * deviation;
      if (!(shortest_length_ <= longest_length_))
        return fail(ErrorCode::kUsage, "size.shortest must not be above size.longest");
      TargetLengths lengths =
          TargetLengths::by_curvature(surface, is_curve_, deviation, shortest_length_, longest_length_);
      return lengths;
    }
    double length =
        measures_.edge_count > 0 ? measures_.edges / static_cast<double>(measures_.edge_count) : 1;
    if (size.edge_length)
      length = in_scaled_units(*size.edge_length);
    else if (size.faces)
      length = std::sqrt(measures_.area / static_cast<double>(*size.faces) * 4 / std::numbers::sqrt3);
    // All points coincide: nothing can be done, with any length.
    if (!(length > 0)) length = 1;
    length = std::clamp(length, kShortest, kLongest);
    shortest_length_ = longest_length_ = length;
    return TargetLengths(length);
  }

  /// About how many faces will come of it, or fewer. Errors: kUnsuitable where memory is not to be asked for
  /// so many.
  Result<double> count_faces(const TargetLengths& lengths) const {
    double faces = 0;
    const auto at = [&](VertexId v) { return DVec3(positions_[v.index]) * measures_.scale; };
    const auto target = [&](VertexId v) { return static_cast<double>(lengths.at_vertex(v.index)); };
    input_.for_each_edge([&](HalfEdgeId h) {
      const VertexId v = input_.origin(h), w = input_.target(h);
      faces += glm::length(at(w) - at(v)) / std::min(target(v), target(w));
    });
    for (std::uint32_t h = 0; h < input_.half_edge_count(); h += 3) {
      const VertexId a = input_.origin(HalfEdgeId(h)), b = input_.origin(HalfEdgeId(h + 1)),
                     c = input_.origin(HalfEdgeId(h + 2));
      const double length = std::min({target(a), target(b), target(c)});
      faces += 1.5 * glm::length(glm::cross(at(b) - at(a), at(c) - at(a))) / (length * length);
    }
    if (!(faces <= kMostFaces))
      return fail(ErrorCode::kUnsuitable,
                  "edges so short would make more than a hundred million faces of this mesh");
    return faces;
  }

  Result<void> build() {
    RemeshMesh& mesh = state_->mesh;
    const std::size_t vertices = input_.vertex_count();
    if (!mesh.build(input_)) return fail(ErrorCode::kUnsuitable, "remeshing takes at most 268 million faces");
    for (std::uint32_t h = 0; h < is_curve_.size(); ++h) {
      if (!is_curve_[h]) continue;
      const std::uint32_t e = 4 * (h / 3) + h % 3, t = mesh.twin(e);
      const bool is_kept = mesh.is_ghost(t) && options_.curves.boundary_kept;
      for (const std::uint32_t one : {e, t}) {
        mesh.set_tag(one, kCurveTag);
        if (is_kept) mesh.set_tag(one, kKeptTag);
      }
    }
    for (std::uint32_t v = 0; v < vertices; ++v) {
      RemeshVertex& vertex = mesh.vertices[v];
      if (vertex.leading == kInvalid) vertex.leading = kVertexGone;  // isolated: dropped
      if (!vertex.alive()) continue;
      vertex.position = DVec3(positions_[v]) * measures_.scale;
      vertex.length = state_->lengths.at_vertex(v);
      const std::uint32_t curve = state_->curves.curve_of(v);
      if (curve == FeatureCurves::kNone) {
        vertex.kind = VertexKind::kFree;
        vertex.is_placed = 1;
        vertex.place = input_.leadings()[v] / 3;
      } else if (curve == FeatureCurves::kEnd) {
        vertex.kind = VertexKind::kFixed;
        vertex.place = v;
      } else {
        vertex.kind = VertexKind::kCurve;
        vertex.place = curve;
        vertex.along = state_->curves.along(v);
      }
    }
    for (std::uint32_t v = 0; v < vertices; ++v)
      if (mesh.vertices[v].alive()) set_valence(v);
    return {};
  }

  /// Counts the edges at a vertex; the best number leaves 60 degrees between them.
  void set_valence(std::uint32_t v) {
    RemeshMesh& mesh = state_->mesh;
    RemeshVertex& vertex = mesh.vertices[v];
    std::uint32_t h = vertex.leading, valence = 0;
    double angle = 0;
    bool on_boundary = false;
    do {
      ++valence;
      if (mesh.is_ghost(h)) {
        on_boundary = true;
      } else {
        const DVec3 a = state_->position(mesh.target(h)) - vertex.position,
                    b = state_->position(mesh.origin(RemeshMesh::previous(h))) - vertex.position;
        const DVec3 across = glm::cross(a, b);
        angle += angle_of(std::sqrt(glm::dot(across, across)), glm::dot(a, b));
      }
      h = mesh.around_vertex(h);
    } while (h != vertex.leading);
    vertex.valence = valence & ((1u << 20) - 1);
    const auto faces = static_cast<std::uint32_t>(std::lround(std::min(angle * 3 / std::numbers::pi, 64.0)));
    std::uint32_t best = on_boundary ? 5 : 6;
    if (vertex.kind == VertexKind::kFixed) best = on_boundary ? std::max(faces, 1u) + 2 : std::max(faces, 3u);
    vertex.best_valence = best & ((1u << 9) - 1);
  }

  /// Whether to go on. Errors: kInterrupted.
  Result<bool> goes_on(double fraction) {
    stop_.report(fraction);
    VKMESH_CHECK(stop_.check());
    return !stop_.is_time_over();
  }

  Result<void> iterate() {
    RemeshState& state = *state_;
    // The last do not change how many vertices there are, but for needles: all comes to rest.
    const unsigned n = options_.iterations, resting = std::min(kResting, n / 2);
    for (unsigned i = 0; i < n; ++i) {
      const auto fraction = [&](unsigned step) {
        return (static_cast<double>(i) + 0.25 * step) / static_cast<double>(n);
      };
      const bool rests = i + resting >= n;
      VKMESH_TRY(const bool may_split, goes_on(fraction(0)));
      if (!may_split) break;
      if (!rests) state.splits += split_long_edges(state);
      VKMESH_TRY(const bool may_collapse, goes_on(fraction(1)));
      if (!may_collapse) break;
      state.collapses += rests ? collapse_needles(state) : collapse_short_edges(state);
      VKMESH_TRY(const bool may_swap, goes_on(fraction(2)));
      if (!may_swap) break;
      state.swaps += rests ? swap_for_angles(state) : swap_for_valence(state);
      VKMESH_TRY(const bool may_relax, goes_on(fraction(3)));
      if (!may_relax) break;
      relax_vertices(state);
      if (rests) relax_vertices(state);
      if (!rests && options_.size.faces) meet_count();
    }
    VKMESH_CHECK(goes_on(1));
    return {};
  }

  /// Makes edges longer or shorter where the number of faces is not what was asked for.
  void meet_count() {
    RemeshMesh& mesh = state_->mesh;
    std::size_t faces = 0;
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f) faces += mesh.alive(4 * f) ? 1 : 0;
    // More than the root that areas ask for: edges that are within bounds do not follow.
    const double factor = static_cast<double>(faces) / static_cast<double>(*options_.size.faces);
    const double bounded = std::clamp(factor, 0.8, 1.25);
    state_->lengths.scale(bounded);
    longest_length_ *= bounded;
    for (std::uint32_t v = 0; v < mesh.vertex_bound(); ++v)
      if (v != mesh.apex())
        mesh.vertices[v].length = static_cast<float>(static_cast<double>(mesh.vertices[v].length) * bounded);
  }

  Result<Remeshed> gather() {
    const RemeshMesh& mesh = state_->mesh;
    Remeshed result;
    Gathered gathered = detail::gather(mesh);
    result.mesh = std::move(gathered.mesh);
    for (const std::uint32_t v : gathered.vertices)
      result.positions.push_back(Vec3(mesh.vertices[v].position * state_->inverse_scale));
    result.corner_origins.assign(result.mesh.origins().begin(), result.mesh.origins().end());
    std::vector<std::uint32_t> new_face(mesh.face_count(), kInvalid);
    for (std::uint32_t f = 0; f < gathered.faces.size(); ++f) new_face[gathered.faces[f]] = f;
    gather_origins(gathered.vertices, gathered.faces, new_face, result);
    result.edge_length = longest_length_ * state_->inverse_scale;
    result.splits = state_->splits;
    result.collapses = state_->collapses;
    result.swaps = state_->swaps;
    result.stop = stop_.is_time_over() ? RemeshStop::kTimeLimit : RemeshStop::kDone;
    return result;
  }

  static SurfacePoint point_of(const Foot& foot) {
    SurfacePoint point{foot.face, {}};
    for (std::size_t i = 0; i < 3; ++i) point.weights[i] = static_cast<float>(foot.weights[i]);
    return point;
  }

  /// The points of the input that vertices, corners and faces have.
  void gather_origins(const std::vector<std::uint32_t>& vertices, const std::vector<std::uint32_t>& faces,
                      const std::vector<std::uint32_t>& new_face, Remeshed& result) const {
    const RemeshMesh& mesh = state_->mesh;
    constexpr std::size_t kGrain = 1 << 10;
    result.origins.resize(vertices.size());
    std::vector<double> distance2(vertices.size(), 0.0);
    parallel_ranges(vertices.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const RemeshVertex& vertex = mesh.vertices[vertices[i]];
        std::uint32_t h = vertex.leading;
        if (mesh.is_ghost(h)) h = mesh.around_vertex(h);
        if (mesh.is_ghost(h)) h = mesh.around_vertex(h);
        const Foot foot =
            vertex.is_free() ? state_->surface.walk(vertex.place, vertex.position) : state_->original_at(h);
        result.origins[i] = point_of(foot);
        const DVec3 away = vertex.position - foot.point;
        distance2[i] = glm::dot(away, away);
      }
    });
    if (!distance2.empty())
      result.largest_distance = std::sqrt(*std::ranges::max_element(distance2)) * state_->inverse_scale;
    // The sectors between the curves at a vertex, where there are two or more.
    for (const std::uint32_t v : vertices) {
      const RemeshVertex& vertex = mesh.vertices[v];
      if (vertex.is_free()) continue;
      std::vector<std::uint32_t> starts;
      std::uint32_t h = vertex.leading;
      do {
        if (state_->is_curve(h) && !mesh.is_ghost(h)) starts.push_back(h);
        h = mesh.around_vertex(h);
      } while (h != vertex.leading);
      if (starts.size() < 2) continue;
      for (const std::uint32_t start : starts) {
        const auto number = static_cast<std::uint32_t>(result.origins.size());
        result.origins.push_back(point_of(state_->original_at(start)));
        std::uint32_t g = start;
        do {
          result.corner_origins[3 * new_face[g / 4] + g % 4] = number;
          g = mesh.around_vertex(g);
        } while (!state_->is_curve(g));
      }
    }
    result.source_faces.resize(faces.size());
    parallel_ranges(faces.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const DVec3 &a = state_->position(mesh.origin(4 * faces[k])),
                    &b = state_->position(mesh.origin(4 * faces[k] + 1)),
                    &c = state_->position(mesh.origin(4 * faces[k] + 2)), middle = (a + b + c) / 3.0,
                    area = area_vector(a, b, c);
        // At a fold a walk may stay on the wrong leaf: from another corner it finds that which looks as the
        // face does.
        for (std::size_t i = 3; i-- > 0;) {
          const std::uint32_t near = result.origins[result.corner_origins[3 * k + i]].face;
          const std::uint32_t f = state_->surface.walk(near, middle).face;
          const bool agrees = glm::dot(state_->surface.normal(f), area) > 0;
          if (i == 2 || agrees) result.source_faces[k] = f;
          if (agrees) break;
        }
      }
    });
  }

  const HalfEdgeMesh& input_;
  std::span<const Vec3> positions_;
  const RemeshOptions& options_;
  Stop stop_;
  Measures measures_;
  std::vector<bool> is_curve_;
  double shortest_length_ = 0, longest_length_ = 0;  // scaled
  std::optional<OriginalSurface> surface_;
  std::optional<RemeshState> state_;
};

}  // namespace

std::string name_of(RemeshStop stop) {
  return stop == RemeshStop::kDone ? "done" : "time limit";
}

Result<Remeshed> remesh(const HalfEdgeMesh& mesh, std::span<const Vec3> positions,
                        const RemeshOptions& options, const Progress& progress) {
  if (!mesh.is_triangles())
    return fail(ErrorCode::kUnsuitable, "remeshing takes triangles only: triangulate first");
  if (positions.size() != mesh.vertex_count())
    return fail(ErrorCode::kUsage, "remeshing needs one position for each vertex");
  VKMESH_CHECK(check_options(mesh, options));
  if (mesh.face_count() == 0) return Remeshed{};
  return catching([&] { return Remesher(mesh, positions, options, progress).run(); });
}

}  // namespace vkmesh
