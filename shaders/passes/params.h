// Push constants of every kernel, declared once for GLSL and C++. Addresses come after the two counts, so
// that each is 8-byte aligned in both languages; engine/src asserts the sizes.
#ifndef VKMESH_PARAMS_H
#define VKMESH_PARAMS_H

#ifdef __cplusplus
#include <cstdint>
#define VKMESH_UINT std::uint32_t
#define VKMESH_FLOAT float
#define VKMESH_FLOATS std::uint64_t
#define VKMESH_UINTS std::uint64_t
namespace vkmesh::kernels {
#else
// clang-format off
layout(buffer_reference, std430, buffer_reference_align = 4) buffer Floats { float at[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer Uints { uint at[]; };
// clang-format on
#define VKMESH_UINT uint
#define VKMESH_FLOAT float
#define VKMESH_FLOATS Floats
#define VKMESH_UINTS Uints
#endif

// Every kernel runs one thread for each i in [first, first + count).

/// triangle_areas.comp, triangle_normals.comp: i is a face.
struct TrianglesParams {
  VKMESH_UINT first;
  VKMESH_UINT count;
  VKMESH_FLOATS positions;  ///< 3 a vertex
  VKMESH_UINTS corners;     ///< 3 a face
  VKMESH_FLOATS vectors;    ///< 3 a face: written
};

/// vertex_normals.comp: i is a vertex.
struct VertexNormalsParams {
  VKMESH_UINT first;
  VKMESH_UINT count;
  VKMESH_FLOATS areas;          ///< 3 a face, from triangle_areas or triangle_normals
  VKMESH_UINTS corner_offsets;  ///< vertices + 1
  VKMESH_UINTS corner_half_edges;
  VKMESH_FLOATS normals;  ///< 3 a vertex: written
};

/// vertex_normals_by_angle.comp: i is a vertex.
struct VertexNormalsByAngleParams {
  VKMESH_UINT first;
  VKMESH_UINT count;
  VKMESH_FLOATS positions;      ///< 3 a vertex
  VKMESH_UINTS corners;         ///< 3 a face
  VKMESH_FLOATS face_normals;   ///< 3 a face, from triangle_normals
  VKMESH_UINTS corner_offsets;  ///< vertices + 1
  VKMESH_UINTS corner_half_edges;
  VKMESH_FLOATS normals;  ///< 3 a vertex: written
};

/// laplacian_smoothing.comp, cotangent_smoothing.comp: i is a vertex.
struct LaplacianSmoothingParams {
  VKMESH_UINT first;
  VKMESH_UINT count;
  VKMESH_UINTS neighbour_offsets;  ///< vertices + 1
  VKMESH_UINTS neighbour_ids;
  VKMESH_UINTS boundary_bits;  ///< bit i % 32 of word i / 32: vertex i lies on the boundary
  VKMESH_UINTS locked_bits;    ///< likewise: it stays
  VKMESH_FLOATS source;        ///< 3 a vertex
  VKMESH_FLOATS target;        ///< 3 a vertex: written
  VKMESH_FLOAT factor;         ///< λ or μ
  VKMESH_UINT boundary_rule;   ///< SmoothingBoundary
};

// Of SmoothingBoundary.
#define VKMESH_BOUNDARY_FIXED 0
#define VKMESH_BOUNDARY_ALONG_ITSELF 1

/// dihedral_angles.comp: i is a half-edge.
struct DihedralAnglesParams {
  VKMESH_UINT first;
  VKMESH_UINT count;
  VKMESH_FLOATS positions;  ///< 3 a vertex
  VKMESH_UINTS corners;     ///< 3 a face
  VKMESH_FLOATS normals;    ///< 3 a face, from triangle_normals
  VKMESH_UINTS twins;
  VKMESH_FLOATS angles;  ///< 1 a half-edge: written
};

/// vertex_maxima.comp: i is a vertex.
struct VertexMaximaParams {
  VKMESH_UINT first;
  VKMESH_UINT count;
  VKMESH_FLOATS angles;         ///< 1 a half-edge of a triangle mesh
  VKMESH_UINTS corner_offsets;  ///< vertices + 1
  VKMESH_UINTS corner_half_edges;
  VKMESH_FLOATS maxima;  ///< 1 a vertex: written
};

/// curvatures.comp: i is a vertex.
struct CurvaturesParams {
  VKMESH_UINT first;
  VKMESH_UINT count;
  VKMESH_FLOATS positions;         ///< 3 a vertex
  VKMESH_UINTS neighbour_offsets;  ///< vertices + 1
  VKMESH_UINTS neighbour_ids;
  VKMESH_UINTS boundary_bits;  ///< bit i % 32 of word i / 32: vertex i lies on the boundary
  VKMESH_FLOATS curvatures;    ///< 4 a vertex, as VertexCurvature: written
};

/// bilateral_faces.comp: i is a face, by its place in the grid.
struct BilateralFacesParams {
  VKMESH_UINT first;
  VKMESH_UINT count;
  VKMESH_FLOATS positions;  ///< 3 a vertex
  VKMESH_UINTS corners;     ///< 3 a face
  VKMESH_UINTS face_order;  ///< the face at each place
  VKMESH_FLOATS faces;      ///< 4 a place, centroid and area: written
  VKMESH_FLOAT spatial;
  VKMESH_UINT unused;
};

/// bilateral_normals.comp: i is a face, by its place in the grid.
struct BilateralNormalsParams {
  VKMESH_UINT first;
  VKMESH_UINT count;
  VKMESH_FLOATS mollified;  ///< 3 a vertex
  VKMESH_UINTS corners;     ///< 3 a face
  VKMESH_UINTS face_order;  ///< the face at each place
  VKMESH_FLOATS normals;    ///< 3 a place: written
};

/// bilateral_mollify.comp, bilateral_move.comp: i is a vertex, by its place in the grid.
struct BilateralSumParams {
  VKMESH_UINT first;
  VKMESH_UINT count;
  VKMESH_FLOATS positions;     ///< 3 a vertex
  VKMESH_UINTS vertex_order;   ///< the vertex at each place
  VKMESH_UINTS cells;          ///< the cell of each place
  VKMESH_UINTS range_offsets;  ///< cells + 1
  VKMESH_UINTS ranges;         ///< 2 a range: the first place of its faces, and the place after its last
  VKMESH_FLOATS faces;         ///< 4 a place, from bilateral_faces
  VKMESH_FLOATS normals;       ///< 3 a place, from bilateral_normals; not read by bilateral_mollify
  VKMESH_FLOATS target;        ///< 3 a vertex: written
  VKMESH_FLOAT spatial;        ///< σ_f
  VKMESH_FLOAT per_spatial;    ///< 1 / σ_f
  VKMESH_FLOAT spatial_over_influence;  ///< σ_f / σ_g
  VKMESH_UINT unused;
};

/// bounds_blocks.comp: i is a block of VKMESH_SUM_BLOCK elements.
struct BoundsBlocksParams {
  VKMESH_UINT first;
  VKMESH_UINT count;
  VKMESH_FLOATS source;  ///< `vectors` times 3 an element: a point (1), or low and high (2)
  VKMESH_FLOATS target;  ///< 6 a block: written
  VKMESH_UINT elements;
  VKMESH_UINT vectors;
};

/// face_measures.comp: i is a block of VKMESH_SUM_BLOCK faces.
struct FaceMeasuresParams {
  VKMESH_UINT first;
  VKMESH_UINT count;
  VKMESH_FLOATS positions;  ///< 3 a vertex
  VKMESH_UINTS corners;     ///< 3 a face
  VKMESH_FLOATS bounds;     ///< 6
  VKMESH_FLOATS sums;       ///< 5 a block: written
  VKMESH_UINT faces;
  VKMESH_UINT unused;
};

/// quadrics.comp: i is a vertex.
struct QuadricsParams {
  VKMESH_UINT first;
  VKMESH_UINT count;
  VKMESH_FLOATS positions;      ///< 3 a vertex
  VKMESH_UINTS corners;         ///< 3 a face
  VKMESH_UINTS twins;           ///< 1 a half-edge
  VKMESH_UINTS corner_offsets;  ///< vertices + 1
  VKMESH_UINTS corner_half_edges;
  VKMESH_FLOATS quadrics;  ///< 6 a vertex: written
  VKMESH_FLOAT centre_x;
  VKMESH_FLOAT centre_y;
  VKMESH_FLOAT centre_z;
  VKMESH_FLOAT scale;
  VKMESH_FLOAT boundary_weight;
  VKMESH_UINT unused;
};

/// collapse_costs.comp: i is a half-edge.
struct CollapseCostsParams {
  VKMESH_UINT first;
  VKMESH_UINT count;
  VKMESH_FLOATS positions;  ///< 3 a vertex
  VKMESH_UINTS corners;     ///< 3 a face
  VKMESH_UINTS twins;       ///< 1 a half-edge
  VKMESH_FLOATS quadrics;   ///< 6 a vertex
  VKMESH_FLOATS costs;      ///< 1 a half-edge: written
  VKMESH_FLOAT centre_x;
  VKMESH_FLOAT centre_y;
  VKMESH_FLOAT centre_z;
  VKMESH_FLOAT scale;
  VKMESH_UINT placement;  ///< CollapsePlacement
  VKMESH_UINT unused;
};
#define VKMESH_PLACEMENT_OPTIMAL 0
#define VKMESH_PLACEMENT_ENDPOINT 2

/// swap_scores.comp: i is a half-edge.
struct SwapScoresParams {
  VKMESH_UINT first;
  VKMESH_UINT count;
  VKMESH_FLOATS positions;  ///< 3 a vertex
  VKMESH_UINTS corners;     ///< 3 a face
  VKMESH_UINTS twins;       ///< 1 a half-edge
  VKMESH_FLOATS scores;     ///< 1 a half-edge: written
  VKMESH_UINT criterion;    ///< SwapCriterion
  VKMESH_UINT unused;
};
#define VKMESH_SWAP_BY_ANGLE 0
#define VKMESH_NO_SWAP -4.0f

/// restore_volume.comp: i is a vertex.
struct RestoreVolumeParams {
  VKMESH_UINT first;
  VKMESH_UINT count;
  VKMESH_FLOATS positions;  ///< 3 a vertex: read and written
  VKMESH_FLOATS before;     ///< RawMeasures
  VKMESH_FLOATS after;      ///< RawMeasures
};

/// sum_blocks.comp: i is a block of VKMESH_SUM_BLOCK elements.
struct SumBlocksParams {
  VKMESH_UINT first;
  VKMESH_UINT count;
  VKMESH_FLOATS source;  ///< 5 an element
  VKMESH_FLOATS target;  ///< 5 a block: written
  VKMESH_UINT elements;
  VKMESH_UINT unused;
};

/// canary.comp: i is a case.
struct CanaryParams {
  VKMESH_UINT first;
  VKMESH_UINT count;
  VKMESH_FLOATS inputs;   ///< VKMESH_CANARY_INPUTS a case
  VKMESH_FLOATS results;  ///< VKMESH_CANARY_RESULTS a case: written
};
#define VKMESH_CANARY_INPUTS 9
#define VKMESH_CANARY_RESULTS 23

#ifdef __cplusplus
}  // namespace vkmesh::kernels
#endif
#undef VKMESH_UINT
#undef VKMESH_FLOAT
#undef VKMESH_FLOATS
#undef VKMESH_UINTS

#endif
