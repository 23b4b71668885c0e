// Points, each as a triangle around a disc: across the view, or across the point's normal.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "draw/draw_common.glsl"

layout(location = 0) out vec3 at;
layout(location = 1) out vec3 normal;
layout(location = 2) out vec4 direct;
layout(location = 3) out float value;
layout(location = 4) out vec2 disc;  ///< the disc is where its length is below 1

const vec2 kCorners[3] = vec2[](vec2(0.0, 2.0), vec2(-1.7320508, -1.0), vec2(1.7320508, -1.0));

void main() {
  uint point = uint(gl_VertexIndex) / 3u;
  at = relative(load3(p.positions, point));
  normal = VKMESH_GIVEN(p.normals) ? load3(p.normals, point) : vec3(0.0);
  uint bits = load_value(point);
  direct = as_color(bits);
  value = as_number(bits);
  disc = kCorners[uint(gl_VertexIndex) % 3u];

  vec4 center = to_clip(at);
  if (VKMESH_GIVEN(p.spacing)) {
    float radius = p.spacing.at[point] * view.splat_scale;
    vec3 axis = has(VKMESH_ORIENTED) && dot(normal, normal) > 0.0 ? normalize(normal) : towards_eye(at);
    vec3 tangent = normalize(cross(axis, abs(axis.x) < 0.6 ? vec3(1, 0, 0) : vec3(0, 1, 0)));
    vec3 other = cross(axis, tangent);
    // No disc gets smaller than a point would be.
    vec3 row = vec3(view.clip_from_origin[0].y, view.clip_from_origin[1].y, view.clip_from_origin[2].y);
    float pixels = view.half_height * length(row) * radius / max(center.w, 1e-30);
    radius *= max(1.0, 0.5 / max(pixels, 1e-6));
    gl_Position = to_clip(at + radius * (disc.x * tangent + disc.y * other));
  } else {
    gl_Position = center;
    gl_Position.xy += disc * view.point_radius / vec2(view.half_width, view.half_height) * center.w;
  }
}
