// What the drawing shaders take, declared once for GLSL and C++: push constants that hold addresses, and the
// parameters of a picture, which do not fit there and stand in a uniform buffer. (By address Mesa 22.3's
// llvmpipe takes wrong components of vectors that are not read whole.)
#ifndef VKMESH_DRAW_PARAMS_H
#define VKMESH_DRAW_PARAMS_H

#ifdef __cplusplus
#include <cstdint>
#define VKMESH_UINT std::uint32_t
#define VKMESH_FLOAT float
#define VKMESH_VEC4(name) float name[4]
#define VKMESH_MAT4(name) float name[16]
#define VKMESH_TABLE(name, size) alignas(16) float name[size][4]
#define VKMESH_ADDRESS(Type) std::uint64_t
namespace vkmesh::kernels {
#else
#define VKMESH_UINT uint
#define VKMESH_FLOAT float
#define VKMESH_VEC4(name) vec4 name
#define VKMESH_MAT4(name) mat4 name
#define VKMESH_TABLE(name, size) vec4 name[size]
#define VKMESH_ADDRESS(Type) Type
#endif

// Specialization constant 0: what a surface or point is coloured by.
#define VKMESH_COLOR_PLAIN 0u
#define VKMESH_COLOR_NORMAL 1u
#define VKMESH_COLOR_VALUE 2u   ///< a float, through the colour table
#define VKMESH_COLOR_DIRECT 3u  ///< four bytes red, green, blue, alpha

// Specialization constant 1: the polygons' edges.
#define VKMESH_NO_EDGES 0u
#define VKMESH_EDGES_TOO 1u   ///< on the surface
#define VKMESH_EDGES_ONLY 2u  ///< and nothing between them

// Specialization constant 2: whether back faces are painted in a colour of their own.

// DrawParams::element: whose values they are.
#define VKMESH_PER_POINT 0u
#define VKMESH_PER_CORNER 1u
#define VKMESH_PER_FACE 2u

// DrawParams::flags. What shaders branch on stands in push constants: llvmpipe makes a shader anew, and loses
// it, for each picture that branches on a uniform buffer.
#define VKMESH_SMOOTH 1u       ///< light by the points' normals, where there are some
#define VKMESH_ORIENTED 2u     ///< splats lie across their normals
#define VKMESH_PERSPECTIVE 4u  ///< else a parallel projection

// Values at or below this stand for "none".
#define VKMESH_NO_VALUE -3.0e38f

#ifndef __cplusplus
layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer DrawFloats {
  float at[];
};
layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer DrawUints {
  uint at[];
};
layout(set = 0, binding = 0, std140) uniform DrawView {
#else
struct DrawView {
#endif
  // Vectors count by their xyz alone. Colours are linear, as light adds up, unless said otherwise.
  VKMESH_MAT4(clip_from_origin);  ///< Column by column; of positions relative to `origin`.
  VKMESH_VEC4(origin);
  VKMESH_VEC4(eye);      ///< relative to `origin`
  VKMESH_VEC4(up);       ///< unit vectors
  VKMESH_VEC4(back);     ///< against the view
  VKMESH_VEC4(lamp);     ///< towards the light
  VKMESH_VEC4(plain);    ///< of VKMESH_COLOR_PLAIN
  VKMESH_VEC4(none);     ///< of elements without a value
  VKMESH_VEC4(flipped);  ///< of back faces
  VKMESH_VEC4(edge);     ///< of the triangles' edges: sRGB
  VKMESH_FLOAT value_low;
  VKMESH_FLOAT value_scale;   ///< 1 / (high - low)
  VKMESH_FLOAT point_radius;  ///< pixels
  VKMESH_FLOAT splat_scale;   ///< times the spacing of the points is a splat's radius
  VKMESH_FLOAT nearest;       ///< depth along the view of the nearest point
  VKMESH_FLOAT depth;         ///< from there to the farthest
  VKMESH_FLOAT half_width;    ///< of the picture, pixels
  VKMESH_FLOAT half_height;
  VKMESH_FLOAT edge_width;   ///< pixels
  VKMESH_FLOAT line_bias;    ///< what brings lines nearer: added to z in clip space
  VKMESH_TABLE(table, 256);  ///< the colour table
#ifndef __cplusplus
}
view;
#else
};
#endif

#ifndef __cplusplus
layout(push_constant, std430) uniform PushConstants {
#else
struct DrawParams {
#endif
  VKMESH_ADDRESS(DrawFloats) positions;  ///< 3 a point
  VKMESH_ADDRESS(DrawUints) corners;   ///< 3 a triangle, or 2 an edge; null: each corner has its own position
  VKMESH_ADDRESS(DrawFloats) normals;  ///< 3 a point; null: none
  VKMESH_ADDRESS(DrawUints) values;    ///< 1 an element, float or bytes; null: none
  VKMESH_ADDRESS(DrawUints)
  hidden;  ///< bits 0..2 of a triangle: its edges that are none of the polygon; null: none
  VKMESH_ADDRESS(DrawFloats) spacing;  ///< 1 a point
  VKMESH_UINT element;
  VKMESH_UINT flags;
  VKMESH_UINT color;   ///< of lines: four bytes
  VKMESH_FLOAT width;  ///< of lines: pixels
#ifndef __cplusplus
}
p;
#else
};
static_assert(sizeof(DrawParams) == 64 && sizeof(DrawView) == 64 + 9 * 16 + 12 * 4 + 4096);
}  // namespace vkmesh::kernels
#endif

#undef VKMESH_UINT
#undef VKMESH_FLOAT
#undef VKMESH_VEC4
#undef VKMESH_MAT4
#undef VKMESH_TABLE
#undef VKMESH_ADDRESS

#endif
