// SPDX-License-Identifier: Apache-2.0

// Written as vectors, read singly, or the other way round.
typedef union {
  IntLanes lanes[BATCH / V];
  int single[BATCH];
} Offsets;
typedef union {
  ShortLanes lanes[BATCH / V];
  ushort single[BATCH];
} PixelPairs;

// A row of samples: where the four source pixels of each lie, its place between them, whether it is
// seen. The homogeneous coordinates along the row are origin + step * x.
INLINE void LocateSamples(float3 origin, float3 step, int first, int count, int width, int height,
                          int stride,
                   IntLanes* offsets, Lanes* fraction_x, Lanes* fraction_y, Lanes* seen) {
  const float last_x = (float)(width - 1);
  const float last_y = (float)(height - 1);
  const int last_left = max(width - 2, 0);
  const int last_top = max(height - 2, 0);
  for (int i = 0; i < count / V; ++i) {
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
    offsets[i] = top * stride + left;
    fraction_x[i] = safe_u - TO_FLOAT(left);
    fraction_y[i] = safe_v - TO_FLOAT(top);
    seen[i] = select((Lanes)(0.0f), (Lanes)(1.0f), inside);
  }
}

// Samples all tiles bilinearly; UNSEEN where the picture has no pixel. One work-item does ROWS rows
// of one tile: global size tile_height / ROWS x 2 * pairs. `from_tile` holds, for each tile, the 9
// elements of picture_from_tile. `row_sums` takes, for each tile, the window-weighted sums of the
// grey levels of its rows, then those of 1 for each seen sample. Tiles past `tile_count` are not
// seen at all.
__kernel void SampleTiles(__global const uchar* restrict picture, int width, int height, int stride,
                          __global const float* restrict from_tile, int tile_count, int tile_width,
                          int tile_height, __global const float* restrict window_x,
                          __global const float* restrict window_y,
                          __global float* restrict samples, __global float* restrict row_sums) {
  const int tile = get_global_id(1);
  const int first_row = get_global_id(0) * ROWS;
  const float exists = tile < tile_count ? 1.0f : 0.0f;
  __global const float* m = from_tile + 9 * min(tile, tile_count - 1);
  const float3 step = (float3)(m[0], m[3], m[6]);
  const int to_next_row = height > 1 ? stride : 0;
  Lanes fraction_x[BATCH / V];
  Lanes fraction_y[BATCH / V];
  Lanes seen[BATCH / V];
  Offsets offsets;
  PixelPairs upper;
  PixelPairs lower;
  for (int y = first_row; y < first_row + ROWS; ++y) {
    __global float* out = samples + (tile * tile_height + y) * tile_width;
    const float3 origin = (float3)(m[1], m[4], m[7]) * (float)y + (float3)(m[2], m[5], m[8]);
    Lanes value_sum = 0.0f;
    Lanes seen_sum = 0.0f;
    for (int x = 0; x < tile_width; x += BATCH) {
      const int count = min(BATCH, tile_width - x);
      LocateSamples(origin, step, x, count, width, height, stride, offsets.lanes, fraction_x,
                    fraction_y, seen);
      for (int i = 0; i < count; i += V) {
#pragma unroll
        for (int lane = i; lane < i + V; ++lane) {
          __global const uchar* pixel = picture + offsets.single[lane];
          upper.single[lane] = as_ushort(vload2(0, pixel));
          lower.single[lane] = as_ushort(vload2(0, pixel + to_next_row));
        }
      }
      for (int i = 0; i < count / V; ++i) {
        const IntLanes up = SHORTS_TO_INT(upper.lanes[i]);
        const IntLanes low = SHORTS_TO_INT(lower.lanes[i]);
        const Lanes a = TO_FLOAT(up & 0xff);
        const Lanes c = TO_FLOAT(low & 0xff);
        const Lanes above = a + fraction_x[i] * (TO_FLOAT(up >> 8) - a);
        const Lanes below = c + fraction_x[i] * (TO_FLOAT(low >> 8) - c);
        const Lanes value = above + fraction_y[i] * (below - above);
        const Lanes is_seen = exists * seen[i];
        const Lanes weight = is_seen * LOAD(window_x + x + i * V);
        value_sum += weight * value;
        seen_sum += weight;
        STORE(select((Lanes)(UNSEEN), value, is_seen > 0.0f), out + x + i * V);
      }
    }
    row_sums[2 * tile_height * tile + y] = window_y[y] * SumOfLanes(value_sum);
    row_sums[2 * tile_height * tile + tile_height + y] = window_y[y] * SumOfLanes(seen_sum);
  }
}
