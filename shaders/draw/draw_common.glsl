// What the drawing shaders share.
#ifndef VKMESH_DRAW_COMMON_GLSL
#define VKMESH_DRAW_COMMON_GLSL

#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "draw/draw_params.h"

// Constants, so that a pipeline holds only the code that it needs: drivers in software run both sides of a branch.
layout(constant_id = 0) const uint kColorSource = VKMESH_COLOR_PLAIN;
layout(constant_id = 1) const uint kEdges = VKMESH_NO_EDGES;
layout(constant_id = 2) const bool kShowFlipped = false;

// A macro, since glslang takes all buffer addresses for one type when functions are overloaded.
#define VKMESH_GIVEN(address) (uvec2(address) != uvec2(0))

bool has(uint flag) { return (p.flags & flag) != 0u; }

vec3 load3(DrawFloats values, uint i) { return vec3(values.at[3 * i], values.at[3 * i + 1], values.at[3 * i + 2]); }

/// Relative to the view's origin, so that meshes far from zero keep their digits.
vec3 relative(vec3 position) { return position - view.origin.xyz; }

vec4 to_clip(vec3 at) { return view.clip_from_origin * vec4(at, 1.0); }

/// From a point towards the eye, a unit vector.
vec3 towards_eye(vec3 at) { return has(VKMESH_PERSPECTIVE) ? normalize(view.eye.xyz - at) : view.back.xyz; }

/// The bits of an element's value.
uint load_value(uint element) {
  return kColorSource == VKMESH_COLOR_VALUE || kColorSource == VKMESH_COLOR_DIRECT ? p.values.at[element] : 0u;
}

vec4 as_color(uint value) { return kColorSource == VKMESH_COLOR_DIRECT ? unpackUnorm4x8(value) : vec4(0.0); }

float as_number(uint value) { return kColorSource == VKMESH_COLOR_VALUE ? uintBitsToFloat(value) : 0.0; }

vec3 to_linear(vec3 srgb) {
  return mix(srgb / 12.92, pow((srgb + 0.055) / 1.055, vec3(2.4)), greaterThan(srgb, vec3(0.04045)));
}

vec3 to_srgb(vec3 linear) {
  linear = clamp(linear, 0.0, 1.0);
  return mix(linear * 12.92, 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, greaterThan(linear, vec3(0.0031308)));
}

/// The linear colour of an element before light falls on it. Normals are shown as they are: see shown().
vec3 surface_color(float value, vec4 direct) {
  if (kColorSource == VKMESH_COLOR_VALUE) {
    float at = clamp((value - view.value_low) * view.value_scale, 0.0, 1.0) * 255.0;
    uint below = min(uint(at), 254u);
    vec3 color = mix(view.table[below].rgb, view.table[below + 1u].rgb, at - float(below));
    return value > VKMESH_NO_VALUE ? color : view.none.rgb;
  }
  if (kColorSource == VKMESH_COLOR_DIRECT) return to_linear(direct.rgb);
  return view.plain.rgb;
}

/// Linear light: a lamp beside the eye, and a sky that is brighter above. `normal` faces the eye. Measured colours are
/// lit gently, so that they can be read against the legend.
vec3 lit(vec3 color, vec3 normal, vec3 to_eye) {
  float diffuse = max(dot(normal, view.lamp.xyz), 0.0);
  float facing = abs(dot(normal, to_eye));
  float sky = 0.5 + 0.5 * dot(normal, view.up.xyz);
  if (kColorSource != VKMESH_COLOR_PLAIN) return color * (0.24 + 0.16 * sky + 0.16 * facing + 0.46 * diffuse);
  float shine = max(dot(normal, view.lamp.xyz + to_eye), 0.0) * inversesqrt(2.0 + 2.0 * dot(view.lamp.xyz, to_eye));
  shine *= shine;
  shine *= shine;
  shine *= shine;
  return color * (0.06 + 0.12 * sky + 0.14 * facing + 0.66 * diffuse) + 0.08 * shine * shine;
}

/// What is written for an element: sRGB.
vec3 shown(vec3 normal, float value, vec4 direct, vec3 facing, vec3 to_eye) {
  if (kColorSource == VKMESH_COLOR_NORMAL) return normal * 0.5 + 0.5;
  return to_srgb(lit(surface_color(value, direct), facing, to_eye));
}

#endif
