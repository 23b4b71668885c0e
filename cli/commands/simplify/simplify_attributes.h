// The attributes of a mesh through its decimation.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <vkmesh/decimation/decimate.h>
#include <vkmesh/mesh/half_edge_mesh.h>
#include <vkmesh/mesh/indexed_face_set.h>

#include "job/common.h"

namespace vkmesh::cli {

/// What the command line says of attributes.
struct AttributeChoice {
  std::vector<std::string> weights;  ///< "NAME=WEIGHT", or "NAME"; "all" for each.
  std::vector<std::string> dropped;  ///< Names of attributes that are left out.
  std::string lock;                  ///< Name of the attribute that marks what stays; it is not mixed.
  bool material_borders = true;      ///< Borders between values of faces are seams.
};

/// Channels that take part in a decimation, and those that are only taken along.
///
/// What points and corners have takes part, whichever of the two has it, unless it numbers things or was
/// dropped. Normals of points are made to fit and do not count; those of corners, which differ from face to
/// face as a rule, are left out; both count if they are named.
class SimplifyAttributes {
 public:
  /// Takes the channels out of the mesh, whose corners are those of triangles, as in `half_edges`.
  /// `vertices_stay`: points are not moved.
  static Result<SimplifyAttributes> of(Job& job, IndexedFaceSet& mesh, const HalfEdgeMesh& half_edges,
                                       const AttributeChoice& choice, bool vertices_stay);

  /// Keeps corners apart that have different numbers, as where different vertices of a buffer stand at one
  /// place. Empty: none are.
  void tell_apart(std::span<const std::uint32_t> number_of_corner);
  /// Sets what decimate() is to know; valid as long as this is.
  void add_to(DecimateOptions& options) const;

  /// Sets the channels of the result, whose points and corners are there.
  void give(const Decimated& decimated, IndexedFaceSet& output) const;
  /// Appends what these points of the input have to the channels of points.
  void append_points(const std::vector<std::uint32_t>& points, IndexedFaceSet& output) const;
  /// As give(), for faces over the vertex buffer of the input, whose channels the output has.
  void give_index_only(const Decimated& decimated, IndexedFaceSet& output) const;

  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// Names of the channels of points that are not mixed: where points move, each is that of some old point.
  [[nodiscard]] std::vector<std::string> unmixed_points() const;
  /// Names of what makes seams: channels of corners that take part, and of faces whose borders are kept.
  [[nodiscard]] std::vector<std::string> corner_names() const;
  [[nodiscard]] const std::vector<std::string>& borders() const { return borders_; }

 private:
  struct Part {
    std::size_t channel;  // of point_channels_, or of corner_channels_
    bool of_corners;
    double weight;
    std::vector<float> values;
  };
  /// Finds the face channels whose borders are kept: those that number things, and others whose values are
  /// those of regions.
  void find_borders(Job& job, const HalfEdgeMesh& half_edges);
  void give_faces(const Decimated& decimated, IndexedFaceSet& output) const;
  [[nodiscard]] const Channel& channel_of(const Part& part) const {
    return (part.of_corners ? corner_channels_ : point_channels_)[part.channel];
  }

  std::vector<Channel> point_channels_, corner_channels_, face_channels_;
  std::vector<Part> parts_;
  std::vector<std::string> names_;
  std::vector<std::uint32_t> each_corner_;  // 0, 1, …: corners have values of their own
  std::vector<std::string> borders_;        // face channels whose borders are kept
  std::vector<std::uint32_t> groups_;       // for each corner, if there are borders
  bool vertices_stay_ = false;
};

}  // namespace vkmesh::cli
