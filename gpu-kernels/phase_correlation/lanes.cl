// SPDX-License-Identifier: Apache-2.0
//
// Tiled phase correlation (thesis 2.4.1), common part: vectors of lanes. It comes before
// warp/bilinear.cl, sample_tiles.cl and find_peak.cl in one program, and before transform.cl in one
// program for each side.
//
// Two real tiles of one picture travel as the real and the imaginary part of one complex transform;
// their spectra are told apart by symmetry where they meet the other picture's. Complex data is
// planar: for each pair of tiles a plane of real parts, then one of imaginary parts.
//
// Macros given to the compiler:
//   V        vector lanes: 1, 2, 4, 8 or 16
//   N        values of a column in transform.cl: a tile's side, a power of two, 16 to 512
//   ROWS     tile rows that a work-item samples, 1 to 16, a power of two
//   BATCH    samples of a row that are worked on together, a multiple of V
//   GROUP    work-items that look for a tile's peak together, a power of two

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)

#if V == 1
typedef float Lanes;
typedef int IntLanes;
typedef ushort ShortLanes;
#define TO_INT(value) convert_int_rtz(value)
#define TO_FLOAT(value) convert_float(value)
#define SHORTS_TO_INT(value) convert_int(value)
#else
typedef JOIN(float, V) Lanes;
typedef JOIN(int, V) IntLanes;
typedef JOIN(ushort, V) ShortLanes;
#define TO_INT(value) JOIN(JOIN(convert_int, V), _rtz)(value)
#define TO_FLOAT(value) JOIN(convert_float, V)(value)
#define SHORTS_TO_INT(value) JOIN(convert_int, V)(value)
#endif

// Global memory as vectors; the address must be a multiple of the vector's size. vload and vstore
// would allow for any address, which compilers for CPUs pay for with several accesses.
#define LOAD(pointer) (*(__global const Lanes*)(pointer))
#define STORE(value, pointer) (*(__global Lanes*)(pointer) = (value))

// Compilers for CPUs that leave a function as it is may break its wide vectors into narrower ones.
#define INLINE __attribute__((always_inline)) static inline

// Stands for a sample that the picture does not have; grey levels are not negative.
#define UNSEEN (-1.0f)

// Numbers of the lanes, 0 to V - 1.
INLINE IntLanes LaneNumbers(void) {
#if V == 1
  return 0;
#elif V == 2
  return (int2)(0, 1);
#elif V == 4
  return (int4)(0, 1, 2, 3);
#elif V == 8
  return (int8)(0, 1, 2, 3, 4, 5, 6, 7);
#else
  return (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#endif
}

INLINE float SumOfLanes(Lanes value) {
#if V >= 16
  const float8 value8 = value.lo + value.hi;
#elif V == 8
  const float8 value8 = value;
#endif
#if V >= 8
  const float4 value4 = value8.lo + value8.hi;
#elif V == 4
  const float4 value4 = value;
#endif
#if V >= 4
  const float2 value2 = value4.lo + value4.hi;
#elif V == 2
  const float2 value2 = value;
#endif
#if V >= 2
  return value2.x + value2.y;
#else
  return value;
#endif
}

INLINE float MaxOfLanes(Lanes value) {
#if V >= 16
  const float8 value8 = fmax(value.lo, value.hi);
#elif V == 8
  const float8 value8 = value;
#endif
#if V >= 8
  const float4 value4 = fmax(value8.lo, value8.hi);
#elif V == 4
  const float4 value4 = value;
#endif
#if V >= 4
  const float2 value2 = fmax(value4.lo, value4.hi);
#elif V == 2
  const float2 value2 = value;
#endif
#if V >= 2
  return fmax(value2.x, value2.y);
#else
  return value;
#endif
}
