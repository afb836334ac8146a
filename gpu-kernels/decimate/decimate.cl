// SPDX-License-Identifier: Apache-2.0
//
// Decimation by a whole factor.
//
// Macros given to the compiler:
//   FACTOR   1 to 16
//   V        result pixels that are made together: 1 or 16

#if V == 1
typedef ushort Sums;
#define TO_SUMS(bytes) convert_ushort(bytes)
#define LOAD_BYTES(pointer) (*(pointer))
#else
typedef ushort16 Sums;
#define TO_SUMS(bytes) convert_ushort16(bytes)
#define LOAD_BYTES(pointer) (*(__global const uchar16*)(pointer))
#endif

// Column sums, written as vectors and read singly. 16 rows of 255 fit 16 bits.
typedef union {
  Sums lanes[FACTOR];
  ushort single[FACTOR * V];
} Columns;

// The rounded mean of a block: (sum + half) * ceil(2^24 / area) >> 24 is exact for up to 256
// pixels.
#define AREA (FACTOR * FACTOR)
#define MEAN(sum) ((((sum) + AREA / 2u) * (((1u << 24) + AREA - 1u) / AREA)) >> 24)

// One work-item does every get_global_size(0)-th group of V pixels of a result row. Groups may
// reach into the rows' padding, but not past it.
__kernel void Decimate(__global const uchar* restrict source, int source_stride,
                       __global uchar* restrict destination, int width, int height, int stride) {
  const int y = get_global_id(1);
  if (y >= height) return;
  for (int x = get_global_id(0) * V; x < width; x += get_global_size(0) * V) {
    Columns columns;
    for (int i = 0; i < FACTOR; ++i) {
      const int column = x * FACTOR + i * V;
      __global const uchar* from = source + y * FACTOR * source_stride + column;
      columns.lanes[i] = 0;
      if (column >= source_stride) continue;
      for (int row = 0; row < FACTOR; ++row) {
        columns.lanes[i] += TO_SUMS(LOAD_BYTES(from + row * source_stride));
      }
    }
    __global uchar* out = destination + y * stride + x;
#if V == 16 && FACTOR == 2
    const ushort16 sum = (ushort16)(columns.lanes[0].even + columns.lanes[0].odd,
                                    columns.lanes[1].even + columns.lanes[1].odd);
    *(__global uchar16*)out = convert_uchar16(MEAN(convert_uint16(sum)));
#else
#pragma unroll
    for (int i = 0; i < V; ++i) {
      uint sum = 0;
#pragma unroll
      for (int j = 0; j < FACTOR; ++j) sum += columns.single[i * FACTOR + j];
      out[i] = (uchar)MEAN(sum);
    }
#endif
  }
}
