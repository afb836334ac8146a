// SPDX-License-Identifier: Apache-2.0
//
// Motion seeds: one bit a pixel.
//
// Macros given to the compiler:
//   GRADIENT   1 where the threshold has a gradient term, else 0
//   V          pixels that are compared together: 16 or 64. OpenCL has no vectors of more than 16;
//              wider ones are an extension of the compilers for CPUs.

#if V == 16
typedef uchar16 Bytes;
typedef ushort16 Shorts;
#define TO_SHORTS(bytes) convert_ushort16(bytes)
#define TO_BYTES(shorts) convert_uchar16(shorts)
#define AS_BYTES(mask) as_uchar16(mask)
#define AS_SHORTS(mask) as_ushort16(mask)
#define LOAD_UNALIGNED(pointer) vload16(0, pointer)
#else
typedef uchar Bytes __attribute__((ext_vector_type(V)));
typedef ushort Shorts __attribute__((ext_vector_type(V)));
typedef Bytes UnalignedBytes __attribute__((aligned(1)));
#define TO_SHORTS(bytes) __builtin_convertvector(bytes, Shorts)
#define TO_BYTES(shorts) __builtin_convertvector(shorts, Bytes)
#define AS_BYTES(mask) __builtin_astype(mask, Bytes)
#define AS_SHORTS(mask) __builtin_astype(mask, Shorts)
#define LOAD_UNALIGNED(pointer) (*(__global const UnalignedBytes*)(pointer))
#endif
#define LOAD(pointer) (*(__global const Bytes*)(pointer))
#define INLINE __attribute__((always_inline)) static inline
// Words that a work-item makes at a time, and their pixels.
#define WORDS ((V + 31) / 32)
#define STEP (32 * WORDS)

typedef union {
  Bytes all;
  uchar single[V];
  ulong eights[V / 8];
} Pixels;

INLINE Bytes Difference(Bytes a, Bytes b) { return a > b ? a - b : b - a; }

// 0 where a or b has not been seen.
INLINE Bytes SeenDifference(Bytes a, Bytes b) {
  return Difference(a, b) & AS_BYTES((a != (Bytes)(0)) & (b != (Bytes)(0)));
}

// Pixels first to first + V - 1 of a row, 0 where they lie outside its width. Reads from memory as
// a whole what surely lies inside the row's memory.
INLINE Bytes LoadShifted(__global const uchar* row, int first, int width) {
  if (first >= 0 && first + V <= width) return LOAD_UNALIGNED(row + first);
  Pixels pixels;
  for (int i = 0; i < V; ++i) {
    const int x = first + i;
    pixels.single[i] = x >= 0 && x < width ? row[x] : 0;
  }
  return pixels.all;
}

// Bit i is the lowest one of byte i. The multiplication gathers those of eight bytes in the
// highest.
INLINE ulong Pack(Bytes flags) {
  Pixels pixels;
  pixels.all = flags;
  ulong bits = 0;
#pragma unroll
  for (int i = 0; i < V / 8; ++i) {
    bits |= ((pixels.eights[i] * 0x0102040810204080UL) >> 56) << (8 * i);
  }
  return bits;
}

// One work-item does every get_global_size(0)-th group of words of a row; groups may reach into the
// rows' padding. All in units of 1/128 grey level, which makes the gradient term,
// gain_64ths / 64 * difference / 2, an integer; both sides of the comparison fit 16 bits.
__kernel void DifferenceThreshold(__global const uchar* restrict frame, int frame_stride,
                                  __global const uchar* restrict background,
                                  int background_stride, int width, int height, int threshold,
                                  int gain_64ths, __global uint* restrict seeds,
                                  int seeds_stride) {
  const int y = get_global_id(1);
  if (y >= height) return;
  __global const uchar* f = frame + y * frame_stride;
  __global const uchar* b = background + y * background_stride;
  const bool has_rows = y > 0 && y + 1 < height;
  __global const uchar* above = has_rows ? b - background_stride : b;
  __global const uchar* below = has_rows ? b + background_stride : b;
  const Bytes limit = (Bytes)((uchar)threshold);
  for (int first = get_global_id(0) * STEP; first < width; first += get_global_size(0) * STEP) {
    ulong bits = 0;
    for (int x = first; x < first + STEP; x += V) {
      const Bytes grey = LOAD(f + x);
      const Bytes centre = LOAD(b + x);
      const Bytes change = Difference(grey, centre);
      Bytes is_seed = AS_BYTES((grey != (Bytes)(0)) & (centre != (Bytes)(0)) & (change > limit));
#if GRADIENT
      const Bytes dx =
          SeenDifference(LoadShifted(b, x - 1, width), LoadShifted(b, x + 1, width));
      // Rows outside the picture are not seen; above and below are then the same row.
      const Bytes dy = SeenDifference(LOAD(above + x), LOAD(below + x));
      const Shorts forgiven =
          TO_SHORTS(dx > dy ? dx : dy) * (Shorts)((ushort)gain_64ths);
      const Shorts excess = TO_SHORTS(change - limit) * (Shorts)(128);
      is_seed &= TO_BYTES(AS_SHORTS(excess > forgiven) & (Shorts)(255));
#endif
      bits |= Pack(is_seed & (Bytes)(1)) << (x - first);
    }
    // No seeds past the width.
    if (first + STEP > width) bits &= (1UL << (width - first)) - 1;
    for (int i = 0; i < WORDS; ++i) {
      seeds[y * seeds_stride + first / 32 + i] = (uint)(bits >> (32 * i));
    }
  }
}
