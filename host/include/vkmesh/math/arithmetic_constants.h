// The constants of the exact arithmetic, included by C++ and by GLSL alike (so: preprocessor only).
#ifndef VKMESH_ARITHMETIC_CONSTANTS_H
#define VKMESH_ARITHMETIC_CONSTANTS_H

// Powers of two below which values count as zero, so that no operation sees or makes a subnormal.
#define VKMESH_TINY_COORDINATE 7.8886090522101181e-31f /* 2^-100: coordinates of smoothing */
#define VKMESH_TINY_LENGTH \
  4.3368086899420177e-19f /* 2^-61: components of edge vectors, of sums of unit vectors */
#define VKMESH_TINY_AREA 7.8886090522101181e-31f      /* 2^-100: components of area vectors */
#define VKMESH_TINY_DIRECTION 9.0949470177292824e-13f /* 2^-40: components of a vector scaled to [1, 2) */
#define VKMESH_TINY_WEIGHT 9.5367431640625e-07f       /* 2^-20: weights of neighbours in smoothing */

// Sums over all elements are trees of blocks of so many.
#define VKMESH_SUM_BLOCK 64

// Seeds of Newton's iteration, close to the best for each; the iterations below absorb the rest.
#define VKMESH_RECIPROCAL_SEED 0x7ef311c7u
#define VKMESH_RECIPROCAL_ROOT_SEED 0x5f375a86u
#define VKMESH_RECIPROCAL_CUBE_ROOT_SEED 0x54a2fa8cu
#define VKMESH_THIRD 0.333333343267440796f
#define VKMESH_FOUR_THIRDS 1.33333337306976318f

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

// (asin(s) / s - 1) / s² on [0, 1/2] as a polynomial in s²: minimax, 2.8e-10 of asin(s).
#define VKMESH_ASIN_0 0.16666659712791443f
#define VKMESH_ASIN_1 0.07500505447387695f
#define VKMESH_ASIN_2 0.044516708701848984f
#define VKMESH_ASIN_3 0.03180991858243942f
#define VKMESH_ASIN_4 0.014429810456931591f
#define VKMESH_ASIN_5 0.03752942383289337f

// (e^r - 1 - r) / r² for |r| <= ln(2) / 2: minimax, 3.1e-9 of e^r.
#define VKMESH_EXP_0 0.4999999403953552f
#define VKMESH_EXP_1 0.1666652113199234f
#define VKMESH_EXP_2 0.04166838899254799f
#define VKMESH_EXP_3 0.008368737064301968f
#define VKMESH_EXP_4 0.0013814624398946762f
#define VKMESH_LOG2_E 1.4426950216293335f
// ln(2) = HIGH + LOW to 39 bits; HIGH has 15, so that its small multiples are exact.
#define VKMESH_LN2_HIGH 0.693145751953125f
#define VKMESH_LN2_LOW 1.428606765330187e-06f
#define VKMESH_ROUNDING 12582912.0f /* 1.5 · 2^23: adding it rounds to an integer */
#define VKMESH_ROUNDING_BITS 0x4b400000u
#define VKMESH_EXP_RANGE 0x42d00000u /* 104, beyond which e^x is out of range on either side */
#define VKMESH_LARGEST 3.4028234663852886e38f

// Cotangents are held within ±2^10: those of angles down to 0.056 degrees.
#define VKMESH_COTANGENT_BOUND 1024.0f
#define VKMESH_COTANGENT_BOUND_INVERSE 0.0009765625f
// Bilateral smoothing: areas in units of σ_f², weights below which a face does not count, and how many σ_g
// across a prediction may lie (e^-128 is far below every other weight).
#define VKMESH_BILATERAL_AREA_BOUND 1.099511627776e12f /* 2^40 */
#define VKMESH_BILATERAL_AREA_BOUND_INVERSE 9.0949470177292824e-13f
#define VKMESH_TINY_GAUSSIAN 8.6736173798840355e-19f /* 2^-60 */
#define VKMESH_BILATERAL_FAR 16.0f
// Quadrics: entries that count, and how flat a direction is left alone, as a share of the steepest and at
// all.
#define VKMESH_TINY_QUADRIC 8.6736173798840355e-19f /* 2^-60 */
#define VKMESH_FLAT_SHARE 9.5367431640625e-07f      /* 2^-20 */
#define VKMESH_FLAT_LEAST 8.0779356694631609e-28f   /* 2^-90 */
#define VKMESH_QUALITY_SCALE 3.46410161513775f      /* 2√3: makes an equilateral triangle's quality 1 */
// Volumes are restored up to a factor of 2^30.
#define VKMESH_VOLUME_RATIO_BOUND 1073741824.0f
#define VKMESH_VOLUME_RATIO_BOUND_INVERSE 9.31322574615478515625e-10f
// Curvatures are held within ±2^100.
#define VKMESH_CURVATURE_BOUND 1.2676506002282294e30f
#define VKMESH_CURVATURE_BOUND_INVERSE 7.8886090522101181e-31f

#endif
