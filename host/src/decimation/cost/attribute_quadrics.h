// What attributes add to the quadric error of edge collapses and vertex removals.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <vkmesh/decimation/decimate.h>

#include "decimation/cost/edge_batch.h"
#include "decimation/cost/retriangulation.h"
#include "decimation/legality/wedges.h"
#include "decimation/vertex_record.h"
#include "math/quadric.h"

namespace vkmesh::detail {

/// Quadrics over place and attributes (H. Hoppe, "New quadric metric for simplifying meshes with appearance
/// attributes", 1999), one for each wedge. On a face of area w an attribute is a linear function of the
/// place; the quadric of a wedge is the sum of w cost (function(x) - s)² over its faces and attributes, and
/// for each x the best s is the mean of the functions there. So a wedge is kept as this mean function and the
/// weight of its faces, and what is left for the best s, a quadric in x alone, is added to the geometric one
/// of its vertex. Two wedges that become one have the weighted mean function, and the square of their
/// difference, with the weight w v / (w + v), is added to what is left (T. Chan, G. Golub, R. LeVeque,
/// "Updating formulae and a pairwise algorithm for computing sample variances", 1979): all terms are
/// positive, and floats are enough.
///
/// A vertex that does not move keeps the values that it has in the input.
///
/// Where vertices are removed, what is left for the best s stays apart from the geometric quadrics; each
/// neighbour that gets a share of these gets the same share of the wedge's mean function and weight, and of
/// what is left, in its wedge on that side.
class AttributeQuadrics {
 public:
  /// `corners`: vertices of the input; `diagonal`: of the box, local. The vertices have their geometric
  /// quadrics, to which those of the attributes are added, unless they are to stand apart, for removals.
  /// O(n · components).
  /// Where `stop` is set meanwhile they are of no use.
  AttributeQuadrics(CollapseMesh& mesh, std::size_t vertex_count, Wedges wedges,
                    std::span<const DecimateAttribute> attributes, std::span<const std::uint32_t> corners,
                    double diagonal, bool apart, Stop& stop);

  /// What collapses do from now on is kept, each being a step.
  void keep_changes();
  [[nodiscard]] DecimationChanges take_changes() { return std::move(changes_); }

  [[nodiscard]] const Wedges& wedges() const { return wedges_; }

  /// Adds what joining the wedges of these edges costs to a batch that holds them, for a point anywhere or,
  /// where an end is locked, there. A vertex of a seam is not to become part of one that is on none.
  void add_to(EdgeBatch& batch, std::span<const std::uint32_t> edges) const;
  /// The same for a point at one of the ends.
  void add_to_ends(EdgeBatch& batch, std::span<const std::uint32_t> edges, EndCosts& costs) const;

  /// The cost by the geometric quadrics alone, with the point at p + x.
  [[nodiscard]] float geometric_cost(std::uint32_t p, std::uint32_t q, const Vector3& x) const;
  /// The summed weight of all wedges of the vertex.
  [[nodiscard]] float weight(std::uint32_t v) const;

  /// The collapse of `gone` into `kept` along h = gone → kept, to be told after both vertices' quadrics were
  /// moved to the new place, by `move_gone` and `move_kept`, and added, and before the mesh collapses.
  void collapse(std::uint32_t h, const Vector3& move_gone, const Vector3& move_kept);

  /// Room for the components.
  void prepare(RetriangulationAttributes& batch) const;
  /// Puts what is known of the vertex that `edges` leave, see Wedges::sides, into a lane.
  void set(RetriangulationAttributes& batch, std::size_t lane, std::span<const std::uint32_t> edges,
           std::size_t neighbours, const SeamSides& sides) const;
  /// Gives a share of what the vertex stands for to one of its neighbours; of a vertex on a seam, to one at
  /// an end of the new seam edge.
  void distribute_quadric(std::span<const std::uint32_t> edges, const SeamSides& sides, std::size_t neighbour,
                          float share);
  /// To be told before the mesh fills the hole.
  void fill_hole(std::span<const std::uint32_t> edges, std::size_t neighbours, const SeamSides& sides,
                 std::span<const std::array<std::uint8_t, 3>> triangles, std::size_t first) {
    wedges_.fill_hole(mesh_, edges, neighbours, sides, triangles, first);
  }

  /// The attributes of the faces that are left; face f is face new_face[its source] of the result.
  [[nodiscard]] DecimatedAttributes gather(std::span<const std::uint32_t> faces,
                                           std::span<const std::uint32_t> new_face) const;

 private:
  void add_face(std::uint32_t f);
  /// Adds that which parts the functions of two wedges, of which the second has this weight, with the place
  /// expressed relative to p.
  void add_difference(std::uint32_t wedge_p, std::uint32_t wedge_q, float weight_q, const Vector3& d,
                      Quadric& to) const;
  /// The second, with this weight and at the place of the first plus d, becomes part of it.
  void join(std::uint32_t wedge_p, std::uint32_t wedge_q, float weight_q, const Vector3& d);
  /// Sum of cost (function(x) - value)², times the weight of `wedge`; the value of `at`.
  [[nodiscard]] float deviation(std::uint32_t wedge, const Vector3& x, std::uint32_t at) const;
  /// What all wedges of a vertex that stays where it is cost beside what is left of their quadrics.
  [[nodiscard]] float deviation(std::uint32_t v) const;
  [[nodiscard]] double value_of(std::size_t attribute, std::uint32_t corner, std::size_t component) const;
  void move(std::uint32_t wedge, const Vector3& by);
  /// The collapse of h as a step, with values as they are from then on; the kept vertex has moved, or not.
  void keep_change(std::uint32_t h, bool moved);
  /// Appends the values of a wedge whose vertex was moved, or not.
  void append_values(std::uint32_t wedge, bool moved, std::vector<std::vector<float>>& values) const;
  [[nodiscard]] Vector3 between(std::uint32_t p, std::uint32_t q) const;

  /// A linear function: its gradient, and its value at the vertex.
  struct Function {
    Vector3 gradient;
    float value;
  };
  /// Values are local: (value - middle) / range, and a square of them costs `cost`.
  struct Component {
    std::size_t attribute, index;
    double middle, range;
    float cost, low, high;
  };

  CollapseMesh& mesh_;
  Wedges wedges_;
  std::span<const DecimateAttribute> attributes_;
  std::span<const std::uint32_t> corners_;
  std::vector<Component> components_;
  std::vector<float> weight_;       // by wedge
  std::vector<Function> function_;  // by wedge and component
  std::vector<float> value_;        // the same: the input's
  std::vector<Quadric> plain_;      // by vertex: the geometric quadrics alone
  std::vector<Quadric> apart_;      // by vertex, for removals: the quadrics of attributes alone
  std::vector<float> deviation_;    // by vertex
  bool keeps_changes_ = false;
  std::uint32_t step_ = 0;
  DecimationChanges changes_;
};

}  // namespace vkmesh::detail
