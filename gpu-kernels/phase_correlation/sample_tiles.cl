// SPDX-License-Identifier: Apache-2.0
//
// Compiled behind lanes.cl and warp/bilinear.cl.

// Samples all tiles bilinearly; UNSEEN where the picture has no pixel. One work-item does ROWS rows
// of one tile: global size tile_height / ROWS x 2 * pairs. `from_tile` holds, for each tile, the 9
// elements of picture_from_tile. `row_sums` takes, for each tile, the window-weighted sums of the
// grey levels of its rows, then those of 1 for each seen sample. Tiles past `tile_count` are not
// seen at all.
__kernel void SampleTiles(__global const uchar* restrict picture, int width, int height, int stride,
                          __global const float* restrict from_tile, int tile_count, int tile_width,
                          int tile_height, __global const float* restrict window_x,
                          __global const float* restrict window_y, __global float* restrict samples,
                          __global float* restrict row_sums) {
  const int tile = get_global_id(1);
  const int first_row = get_global_id(0) * ROWS;
  const float exists = tile < tile_count ? 1.0f : 0.0f;
  __global const float* m = from_tile + 9 * min(tile, tile_count - 1);
  const float3 step = (float3)(m[0], m[3], m[6]);
  const Source source = {picture, width, height, stride};
  Samples batch;
  for (int y = first_row; y < first_row + ROWS; ++y) {
    __global float* out = samples + (tile * tile_height + y) * tile_width;
    const float3 origin = (float3)(m[1], m[4], m[7]) * (float)y + (float3)(m[2], m[5], m[8]);
    Lanes value_sum = 0.0f;
    Lanes seen_sum = 0.0f;
    for (int x = 0; x < tile_width; x += BATCH) {
      SampleRow(source, origin, step, x, &batch);
      for (int i = 0; i < min(BATCH, tile_width - x) / V; ++i) {
        const Lanes is_seen = exists * batch.seen[i];
        const Lanes weight = is_seen * LOAD(window_x + x + i * V);
        value_sum += weight * batch.values[i];
        seen_sum += weight;
        STORE(select((Lanes)(UNSEEN), batch.values[i], is_seen > 0.0f), out + x + i * V);
      }
    }
    row_sums[2 * tile_height * tile + y] = window_y[y] * SumOfLanes(value_sum);
    row_sums[2 * tile_height * tile + tile_height + y] = window_y[y] * SumOfLanes(seen_sum);
  }
}
