// Triangles one by one, each corner by itself: soups, flat shading, values of faces and corners, edges on the surface.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "draw/draw_common.glsl"

layout(location = 0) out vec3 at;
layout(location = 1) centroid out vec3 normal;
layout(location = 2) centroid out vec4 direct;
layout(location = 3) centroid out float value;
layout(location = 4) out vec3 across;

uint point_of(uint corner) { return VKMESH_GIVEN(p.corners) ? p.corners.at[corner] : corner; }

// The element of a corner whose value colours it.
uint element_of(uint point, uint corner) {
  return p.element == VKMESH_PER_POINT ? point : p.element == VKMESH_PER_CORNER ? corner : corner / 3u;
}

void main() {
  uint corner = uint(gl_VertexIndex);
  uint face = corner / 3u, side = corner % 3u;
  uint point = point_of(corner);
  at = relative(load3(p.positions, point));
  if (has(VKMESH_SMOOTH) && VKMESH_GIVEN(p.normals)) {
    normal = load3(p.normals, point);
  } else {
    // Each corner computes this in the same order, so that the face is flat to the last bit.
    vec3 a = load3(p.positions, point_of(3u * face));
    vec3 b = load3(p.positions, point_of(3u * face + 1u)) - a;
    vec3 c = load3(p.positions, point_of(3u * face + 2u)) - a;
    b /= max(max(abs(b.x), abs(b.y)), max(abs(b.z), 1e-37));
    c /= max(max(abs(c.x), abs(c.y)), max(abs(c.z), 1e-37));
    normal = cross(b, c);
  }
  uint bits = load_value(element_of(point, corner));
  direct = as_color(bits);
  value = as_number(bits);
  // Edge i runs from corner i to the next one, opposite corner i + 2: the share of that corner is zero along it.
  across = vec3(side == 0u, side == 1u, side == 2u);
  if (VKMESH_GIVEN(p.hidden)) {
    uint hidden = p.hidden.at[face];
    if ((hidden & 1u) != 0u) across.z = 1.0;
    if ((hidden & 2u) != 0u) across.x = 1.0;
    if ((hidden & 4u) != 0u) across.y = 1.0;
  }
  gl_Position = to_clip(at);
}
