// One-rings: the neighbours of a vertex and the half-edges to them, and walks that gather them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/prefetch.h"
#include "mesh/edit/edit_mesh.h"

namespace vkmesh::detail {

/// Neighbours of a vertex, counter-clockwise, and the half-edges from it to them: all, or those from one on.
struct OneRing {
  std::span<const std::uint32_t> vertices, edges;

  [[nodiscard]] std::size_t size() const { return vertices.size(); }
};

/// The step from a half-edge to the next around its origin: the vertex to which that leads, and itself.
struct RingStep {
  std::uint32_t vertex, edge;

  [[gnu::always_inline]] static RingStep from(const EditFaces::Face* faces, std::uint32_t h) {
    const EditFaces::Face& face = faces[h >> 2];
    const std::uint32_t corner = EditFaces::kPreviousCorner[h & 3u];
    return {face.origin[corner], face.twin[corner]};
  }
};

/// A ring of at most kCapacity neighbours.
template <std::uint32_t kCapacity>
struct FixedRing {
  static constexpr std::uint32_t kTooLong = ~0u;
  std::array<std::uint32_t, kCapacity> vertex, edge;  // the first `size` are meant
  std::uint32_t size;                                 // kTooLong when there are more

  [[nodiscard]] bool is_whole() const { return size != kTooLong; }
  [[nodiscard]] OneRing part(std::size_t first, std::size_t count) const {
    return {std::span(vertex).subspan(first, count), std::span(edge).subspan(first, count)};
  }
};

/// Walks around many vertices, one step of each in turn: their waits for memory overlap. What a walk gathers,
/// or looks for, is a `Target` of the user's.
template <class Target>
class RingWalks {
 public:
  /// Walks begin anew; none takes more than so many steps.
  void start(std::uint32_t max_steps) {
    walks_.clear();
    max_steps_ = max_steps;
  }
  /// Adds a walk around the origin of `from`, from the half-edge after it on and up to `last`.
  void add(std::uint32_t from, std::uint32_t last, Target& target) {
    walks_.push_back({from, last, &target});
  }

  /// Takes all steps, those of the same number together. Calls visit(target, number of the step, the step,
  /// whether it is the last) for each, which returns whether to go on, and give_up(target) for walks of too
  /// many steps.
  template <class Visit, class GiveUp>
  void walk(const EditFaces& mesh, Visit&& visit, GiveUp&& give_up) {
    const EditFaces::Face* const faces = mesh.faces();
    std::size_t count = walks_.size();
    for (std::uint32_t number = 0; count > 0 && number < max_steps_; ++number) {
      Walk* kept = walks_.data();
      for (const Walk *walk = kept, *const end = walk + count; walk != end; ++walk) {
        const auto [at, last, target] = *walk;
        const RingStep step = RingStep::from(faces, at);
        prefetch(&faces[step.edge >> 2]);
        const bool goes_on = visit(*target, number, step, step.edge == last);
        *kept = {step.edge, last, target};
        kept += static_cast<std::size_t>(step.edge != last) & static_cast<std::size_t>(goes_on);
      }
      count = static_cast<std::size_t>(kept - walks_.data());
    }
    walks_.resize(count);
    for (const Walk& too_long : walks_) give_up(*too_long.target);
    walks_.clear();
  }

 private:
  struct Walk {
    std::uint32_t at, last;
    Target* target;
  };
  std::vector<Walk> walks_;
  std::uint32_t max_steps_ = 0;
};

/// A ring of any size. Whole blocks of kBlock vertices can be read.
class LongRing {
 public:
  static constexpr std::size_t kBlock = 16;

  /// Gathers the ring of the origin of h from beyond its target, which is left out.
  void gather(const EditFaces& mesh, std::uint32_t h) {
    vertices_.clear();
    edges_.clear();
    for (auto step = RingStep::from(mesh.faces(), h); step.edge != h;
         step = RingStep::from(mesh.faces(), step.edge)) {
      vertices_.push_back(step.vertex);
      edges_.push_back(step.edge);
    }
    vertices_.resize((edges_.size() + kBlock - 1) / kBlock * kBlock);
  }
  [[nodiscard]] OneRing ring() const { return {std::span(vertices_).first(edges_.size()), edges_}; }

 private:
  std::vector<std::uint32_t> vertices_, edges_;
};

}  // namespace vkmesh::detail
