// Triangles: two-sided light, colours by value, back faces and edges on request.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "draw/draw_common.glsl"

layout(location = 0) in vec3 at;
layout(location = 1) centroid in vec3 normal;
layout(location = 2) centroid in vec4 direct;
layout(location = 3) centroid in float value;
layout(location = 4) in vec3 across;

layout(location = 0) out vec4 color;

void main() {
  vec3 to_eye = towards_eye(at);
  float size = dot(normal, normal);
  // Where no direction is defined (a point whose faces have no area) light falls straight on.
  vec3 n = size > 0.0 ? normal * inversesqrt(size) : to_eye;
  vec3 facing = gl_FrontFacing ? n : -n;
  // A normal that points far away from the eye belongs to neighbours that are oriented the other way.
  if (dot(facing, to_eye) < -0.25) facing = -facing;
  vec3 srgb = shown(n, value, direct, facing, to_eye);
  if (kShowFlipped && !gl_FrontFacing)
    srgb = to_srgb(view.flipped.rgb * (0.75 + 0.25 * abs(dot(n, to_eye))));
  color = vec4(srgb, 1.0);

  if (kEdges != VKMESH_NO_EDGES) {
    vec3 pixels = across / max(fwidth(across), vec3(1e-12));
    float distance = min(pixels.x, min(pixels.y, pixels.z));
    float covered = clamp(0.5 * view.edge_width + 0.5 - distance, 0.0, 1.0);
    if (kEdges == VKMESH_EDGES_ONLY) {
      if (covered <= 0.0) discard;
      color.a = covered;
    } else {
      color.rgb = mix(color.rgb, view.edge.rgb, covered);
    }
  }
}
