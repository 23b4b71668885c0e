// What the tests of decimation share.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include <vkmesh/decimation/decimate.h>

#include "support/shapes.h"

namespace vkmesh::test {

template <class Point>
BasicDecimated<Point> run(const HalfEdgeMesh& mesh, const std::vector<Point>& points,
                          const DecimateOptions& options) {
  auto result = decimate(mesh, std::span<const Point>(points), options);
  if (!result) FAIL(result.error().describe());
  if (const auto valid = validate(result->mesh); !valid) FAIL(valid.error().describe());
  return std::move(*result);
}
inline Decimated run(const IndexedFaceSet& mesh, const DecimateOptions& options) {
  return run(half_edges(mesh), mesh.points, options);
}

/// Each way to collapse, and vertex removal.
inline std::vector<DecimateOptions> ways() {
  std::vector<DecimateOptions> all(5);
  all[1].placement = CollapsePlacement::kMidpoint;
  all[2].placement = CollapsePlacement::kEndpoint;
  all[3].operation = DecimateOperation::kHalfEdgeCollapse;
  all[4].operation = DecimateOperation::kVertexRemoval;
  return all;
}

}  // namespace vkmesh::test
