#version 460
#extension GL_GOOGLE_include_directive : require
#include "draw/draw_common.glsl"

layout(location = 0) out vec4 color;

void main() { color = vec4(unpackUnorm4x8(p.color).rgb, 1.0); }
