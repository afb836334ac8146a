// SPDX-License-Identifier: Apache-2.0
//
// Bilinear sampling along the rows of a grid: the common part of the kernels that sample a picture.
// Compiled behind phase_correlation/lanes.cl, which explains V and BATCH.

// Written as vectors, read singly, or the other way round.
typedef union {
  IntLanes lanes[BATCH / V];
  int single[BATCH];
} Offsets;
typedef union {
  ShortLanes lanes[BATCH / V];
  ushort single[BATCH];
} PixelPairs;

// BATCH samples: their grey levels, not rounded, and 1 or 0 for those that are seen and not. Values
// of samples that are not seen mean nothing.
typedef struct {
  Lanes values[BATCH / V];
  Lanes seen[BATCH / V];
} Samples;

typedef struct {
  __global const uchar* pixels;
  int width;
  int height;
  int stride;
} Source;

// Samples `first` to first + BATCH - 1 of a row whose homogeneous coordinates are origin + step *
// number. Seen is a sample with w > 0 within the centres of the border pixels. At the right and
// bottom border its place between four pixels becomes 1, so that all four stay inside.
INLINE void SampleRow(Source source, float3 origin, float3 step, int first, Samples* samples) {
  const float last_x = (float)(source.width - 1);
  const float last_y = (float)(source.height - 1);
  const int last_left = max(source.width - 2, 0);
  const int last_top = max(source.height - 2, 0);
  const int to_next_row = source.height > 1 ? source.stride : 0;
  Lanes fraction_x[BATCH / V];
  Lanes fraction_y[BATCH / V];
  Offsets offsets;
  PixelPairs upper;
  PixelPairs lower;
  for (int i = 0; i < BATCH / V; ++i) {
    const Lanes x = TO_FLOAT(LaneNumbers() + (first + i * V));
    const Lanes w = origin.z + step.z * x;
    const Lanes inverse = 1.0f / w;
    const Lanes u = (origin.x + step.x * x) * inverse;
    const Lanes v = (origin.y + step.y * x) * inverse;
    const IntLanes inside = (w > 0.0f) & (u >= 0.0f) & (v >= 0.0f) & (u <= last_x) & (v <= last_y);
    const Lanes safe_u = select((Lanes)(0.0f), u, inside);
    const Lanes safe_v = select((Lanes)(0.0f), v, inside);
    const IntLanes left = min(TO_INT(safe_u), (IntLanes)(last_left));
    const IntLanes top = min(TO_INT(safe_v), (IntLanes)(last_top));
    offsets.lanes[i] = top * source.stride + left;
    fraction_x[i] = safe_u - TO_FLOAT(left);
    fraction_y[i] = safe_v - TO_FLOAT(top);
    samples->seen[i] = select((Lanes)(0.0f), (Lanes)(1.0f), inside);
  }
#pragma unroll 8
  for (int i = 0; i < BATCH; ++i) {
    __global const uchar* pixel = source.pixels + offsets.single[i];
    upper.single[i] = as_ushort(vload2(0, pixel));
    lower.single[i] = as_ushort(vload2(0, pixel + to_next_row));
  }
  for (int i = 0; i < BATCH / V; ++i) {
    const IntLanes up = SHORTS_TO_INT(upper.lanes[i]);
    const IntLanes low = SHORTS_TO_INT(lower.lanes[i]);
    const Lanes a = TO_FLOAT(up & 0xff);
    const Lanes c = TO_FLOAT(low & 0xff);
    const Lanes above = a + fraction_x[i] * (TO_FLOAT(up >> 8) - a);
    const Lanes below = c + fraction_x[i] * (TO_FLOAT(low >> 8) - c);
    samples->values[i] = above + fraction_y[i] * (below - above);
  }
}
