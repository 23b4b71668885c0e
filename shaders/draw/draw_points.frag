// Discs. Those without a normal are lit by their depth alone: the farther, the darker.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "draw/draw_common.glsl"

layout(location = 0) in vec3 at;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 direct;
layout(location = 3) in float value;
layout(location = 4) in vec2 disc;

layout(location = 0) out vec4 color;

void main() {
  float outward = length(disc);
  float covered = clamp(0.5 + (1.0 - outward) / max(fwidth(outward), 1e-12), 0.0, 1.0);
  if (covered <= 0.0) discard;

  vec3 to_eye = towards_eye(at);
  float size = dot(normal, normal);
  if (size > 0.0) {
    vec3 n = normal * inversesqrt(size);
    color = vec4(shown(n, value, direct, dot(n, to_eye) < 0.0 ? -n : n, to_eye), covered);
  } else {
    float depth = dot(at - view.eye.xyz, -view.back.xyz);
    float behind = clamp((depth - view.nearest) / max(view.depth, 1e-30), 0.0, 1.0);
    color = vec4(to_srgb(surface_color(value, direct) * mix(1.0, 0.25, behind)), covered);
  }
}
