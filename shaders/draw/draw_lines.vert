// Edges as bars of a width in pixels, a little nearer to the eye than the surface they lie on.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "draw/draw_common.glsl"

void main() {
  uint edge = uint(gl_VertexIndex) / 6u, i = uint(gl_VertexIndex) % 6u;
  vec4 a = to_clip(relative(load3(p.positions, p.corners.at[2u * edge])));
  vec4 b = to_clip(relative(load3(p.positions, p.corners.at[2u * edge + 1u])));
  vec2 half_size = vec2(view.half_width, view.half_height);
  // Without a division, so that an end beside or behind the eye gives a direction as well; the offset below grows
  // with w, which keeps the bar's width wherever it is clipped.
  vec2 along = (b.xy * a.w - a.xy * b.w) * half_size;
  float size = length(along);
  along = size > 0.0 ? along / size : vec2(1.0, 0.0);
  vec2 side = vec2(-along.y, along.x);
  bool at_end = i == 1u || i == 4u || i == 5u;
  float left = i == 2u || i == 3u || i == 5u ? -1.0 : 1.0;
  vec4 end = at_end ? b : a;
  // Ends reach half a width further, so that bars that meet leave no notch.
  vec2 offset = (side * left + along * (at_end ? 1.0 : -1.0)) * 0.5 * p.width;
  gl_Position = end;
  gl_Position.xy += offset / half_size * end.w;
  gl_Position.z += view.line_bias;
}
