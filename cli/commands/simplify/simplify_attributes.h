// The attributes of a mesh through its decimation.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <vkmesh/decimation/decimate.h>
#include <vkmesh/mesh/indexed_face_set.h>

#include "job/common.h"

namespace vkmesh::cli {

/// Channels that take part in a decimation, and those that are only taken along.
class SimplifyAttributes {
 public:
  /// What corners have takes part unless it is normals, and what `weights` names ("NAME=WEIGHT"; "all" for
  /// each). Takes the channels out of the mesh, whose corners are those of triangles. `vertices_stay`: points
  /// are not moved.
  static Result<SimplifyAttributes> of(Job& job, IndexedFaceSet& mesh,
                                       const std::vector<std::string>& weights, bool vertices_stay);

  /// Sets what decimate() is to know; valid as long as this is.
  void add_to(DecimateOptions& options) const;

  /// Sets the channels of the result, whose points and corners are there.
  void give(const Decimated& decimated, IndexedFaceSet& output) const;
  /// Appends what these points of the input have to the channels of points.
  void append_points(const std::vector<std::uint32_t>& points, IndexedFaceSet& output) const;
  /// As give(), for faces over all points of the input.
  void give_index_only(const Decimated& decimated, IndexedFaceSet& output) const;

  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  [[nodiscard]] bool has_points() const { return !point_channels_.empty(); }

 private:
  struct Part {
    std::size_t channel;  // of point_channels_, or of corner_channels_
    bool of_corners;
    double weight;
    std::vector<float> values;
  };
  void give_faces(const Decimated& decimated, IndexedFaceSet& output) const;
  [[nodiscard]] const Channel& channel_of(const Part& part) const {
    return (part.of_corners ? corner_channels_ : point_channels_)[part.channel];
  }

  std::vector<Channel> point_channels_, corner_channels_, face_channels_;
  std::vector<Part> parts_;
  std::vector<std::string> names_;
  std::vector<std::uint32_t> each_corner_;  // 0, 1, …: corners have values of their own
  bool vertices_stay_ = false;
};

}  // namespace vkmesh::cli
