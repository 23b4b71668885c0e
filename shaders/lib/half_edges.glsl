// Half-edges 3f to 3f + 2 of a triangle f.
#ifndef VKMESH_HALF_EDGES_GLSL
#define VKMESH_HALF_EDGES_GLSL

uint next_half_edge(uint h) { return h % 3 == 2 ? h - 2 : h + 1; }
uint previous_half_edge(uint h) { return h % 3 == 0 ? h + 2 : h - 1; }

#endif
