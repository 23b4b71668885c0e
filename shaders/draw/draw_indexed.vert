// A triangle mesh through vertex and index buffers: each point is transformed once.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "draw/draw_common.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 point_normal;
layout(location = 2) in uint point_value;

layout(location = 0) out vec3 at;
layout(location = 1) centroid out vec3 normal;
layout(location = 2) centroid out vec4 direct;
layout(location = 3) centroid out float value;
layout(location = 4) out vec3 across;

void main() {
  at = relative(position);
  normal = point_normal;
  direct = as_color(point_value);
  value = as_number(point_value);
  across = vec3(1.0);
  gl_Position = to_clip(at);
}
