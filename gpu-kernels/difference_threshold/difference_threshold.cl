// SPDX-License-Identifier: Apache-2.0
//
// Motion seeds: one bit a pixel, one word of 32 pixels at a time.
//
// Macros given to the compiler:
//   GRADIENT   1 where the threshold has a gradient term, else 0

#define LANE_NUMBERS ((ushort16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15))

// 16 grey levels of a row, 0 past its width.
ushort16 LoadRow(__global const uchar* row, int x, int width) {
  const ushort16 grey = convert_ushort16(*(__global const uchar16*)(row + x));
  if (x + 16 <= width) return grey;
  return select((ushort16)(0), grey, LANE_NUMBERS < (ushort16)(max(width - x, 0)));
}

// |a - b|, 0 where a or b has not been seen.
ushort16 SeenDifference(ushort16 a, ushort16 b) {
  return select((ushort16)(0), abs_diff(a, b), (a != (ushort)0) & (b != (ushort)0));
}

// Bit i of the result is the highest bit of lane i.
uint PackLanes(short16 mask) {
  const ushort16 bits = as_ushort16(mask) & ((ushort16)(1) << LANE_NUMBERS);
  const ushort8 or8 = bits.lo | bits.hi;
  const ushort4 or4 = or8.lo | or8.hi;
  const ushort2 or2 = or4.lo | or4.hi;
  return or2.x | or2.y;
}

// One work-item does every get_global_size(0)-th word of a row. All in units of 1/128 grey level,
// which makes the gradient term, gain_64ths / 64 * difference / 2, an integer; both sides of the
// comparison fit 16 bits.
__kernel void DifferenceThreshold(__global const uchar* restrict frame, int frame_stride,
                                  __global const uchar* restrict background,
                                  int background_stride, int width, int height, int threshold,
                                  int gain_64ths, __global uint* restrict seeds,
                                  int seeds_stride) {
  const int y = get_global_id(1);
  if (y >= height) return;
  __global const uchar* f = frame + y * frame_stride;
  __global const uchar* b = background + y * background_stride;
  // Of rows outside the picture nothing is seen: their width is 0.
  __global const uchar* above = y > 0 ? b - background_stride : b;
  __global const uchar* below = y + 1 < height ? b + background_stride : b;
  const int above_width = y > 0 ? width : 0;
  const int below_width = y + 1 < height ? width : 0;
  const int words = (width + 31) / 32;
  for (int word = get_global_id(0); word < words; word += get_global_size(0)) {
    uint bits = 0;
    for (int half_word = 0; half_word < 2; ++half_word) {
      const int x = word * 32 + half_word * 16;
      const ushort16 grey = convert_ushort16(*(__global const uchar16*)(f + x));
      const ushort16 centre = LoadRow(b, x, width);
      const ushort16 excess = sub_sat(abs_diff(grey, centre), (ushort16)((ushort)threshold));
#if GRADIENT
      const ushort before = x > 0 ? b[x - 1] : 0;
      const ushort after = x + 16 < width ? b[x + 16] : 0;
      const ushort16 left =
          (ushort16)(before, centre.s0123, centre.s4567, centre.s89ab, centre.scd, centre.se);
      const ushort16 right =
          (ushort16)(centre.s1, centre.s23, centre.s4567, centre.s89ab, centre.scdef, after);
      const ushort16 dx = SeenDifference(left, right);
      const ushort16 dy =
          SeenDifference(LoadRow(above, x, above_width), LoadRow(below, x, below_width));
      const ushort16 forgiven = max(dx, dy) * (ushort16)((ushort)gain_64ths);
#else
      const ushort16 forgiven = 0;
#endif
      const short16 is_seed = ((excess * (ushort16)(128)) > forgiven) & (grey != (ushort)0) &
                              (centre != (ushort)0);
      bits |= PackLanes(is_seed) << (16 * half_word);
    }
    seeds[y * seeds_stride + word] = bits;
  }
}
