// Edges as bars of a width in pixels, a little nearer to the eye than the surface they lie on.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "draw_common.glsl"

void main() {
  uint edge = uint(gl_VertexIndex) / 6u, i = uint(gl_VertexIndex) % 6u;
  vec4 a = to_clip(relative(load3(p.positions, p.corners.at[2u * edge])));
  vec4 b = to_clip(relative(load3(p.positions, p.corners.at[2u * edge + 1u])));
  // An end behind the eye has no place in the picture: the edge is cut just before it.
  const float nearest = 1e-6 * max(abs(a.w), abs(b.w));
  if (a.w < nearest && b.w < nearest) {
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
    return;
  }
  if (a.w < nearest) a = mix(b, a, (b.w - nearest) / (b.w - a.w));
  if (b.w < nearest) b = mix(a, b, (a.w - nearest) / (a.w - b.w));

  vec2 half_size = vec2(p.view.half_width, p.view.half_height);
  vec2 along = (b.xy / b.w - a.xy / a.w) * half_size;
  float pixels = length(along);
  along = pixels > 1e-6 ? along / pixels : vec2(1.0, 0.0);
  vec2 side = vec2(-along.y, along.x);
  bool at_end = i == 1u || i == 4u || i == 5u;
  float left = i == 2u || i == 3u || i == 5u ? -1.0 : 1.0;
  vec4 end = at_end ? b : a;
  // Ends reach half a width further, so that bars that meet leave no notch.
  vec2 offset = (side * left + along * (at_end ? 1.0 : -1.0)) * 0.5 * p.width;
  gl_Position = end;
  gl_Position.xy += offset / half_size * end.w;
  gl_Position.z += p.view.line_bias;
}
