// The constants of the exact arithmetic, included by C++ and by GLSL alike (so: preprocessor only).
#ifndef VKMESH_ARITHMETIC_CONSTANTS_H
#define VKMESH_ARITHMETIC_CONSTANTS_H

// Powers of two below which values count as zero, so that no operation sees or makes a subnormal.
#define VKMESH_TINY_COORDINATE 7.8886090522101181e-31f /* 2^-100: coordinates of smoothing */
#define VKMESH_TINY_LENGTH \
  4.3368086899420177e-19f /* 2^-61: components of edge vectors, of sums of unit vectors */
#define VKMESH_TINY_AREA 7.8886090522101181e-31f      /* 2^-100: components of area vectors */
#define VKMESH_TINY_DIRECTION 9.0949470177292824e-13f /* 2^-40: components of a vector scaled to [1, 2) */

// Seeds of Newton's iteration, close to the best for each; the iterations below absorb the rest.
#define VKMESH_RECIPROCAL_SEED 0x7ef311c7u
#define VKMESH_RECIPROCAL_ROOT_SEED 0x5f375a86u

// atan(t) / t on [0, 1] as a polynomial in t²: minimax for the relative error, 2.4e-9 (Remez' algorithm).
#define VKMESH_ATAN_0 1.0f
#define VKMESH_ATAN_1 -0.33333283641628394f
#define VKMESH_ATAN_2 0.19998266040057297f
#define VKMESH_ATAN_3 -0.14261933098564997f
#define VKMESH_ATAN_4 0.10942030660233987f
#define VKMESH_ATAN_5 -0.08377315497507809f
#define VKMESH_ATAN_6 0.057552103654712067f
#define VKMESH_ATAN_7 -0.030804599396347866f
#define VKMESH_ATAN_8 0.010726945564756386f
#define VKMESH_ATAN_9 -0.0017539305431064276f
// π/2 = HIGH + LOW to 48 bits.
#define VKMESH_HALF_PI_HIGH 1.57079637050628662109375f
#define VKMESH_HALF_PI_LOW -4.37113900018624283e-8f

#endif
