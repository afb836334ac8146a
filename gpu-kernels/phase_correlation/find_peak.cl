// SPDX-License-Identifier: Apache-2.0

#define SIDE (2 * RADIUS + 1)
// What is written for each tile: column and row of the highest sample, mean square of the samples
// outside its neighbourhood, coverage of the reference and of the current tile, then the
// neighbourhood's SIDE * SIDE samples, row-major; columns and rows continue periodically.
#define RECORD (5 + SIDE * SIDE)

// Sum of the squares of a row's samples, without those up to RADIUS from column `skip_x`.
INLINE float SquaresBeside(__global const float* row, int skip_x) {
  Lanes sum = 0.0f;
  for (int x = 0; x < W; x += V) {
    const IntLanes distance = ((LaneNumbers() + (x - skip_x + W / 2)) & (W - 1)) - W / 2;
    const Lanes value = LOAD(row + x);
    sum += select(value * value, (Lanes)(0.0f), (distance <= RADIUS) & (distance >= -RADIUS));
  }
  return SumOfLanes(sum);
}

// Finds the highest sample of each tile's correlation surface, the first one in row-major order
// where several are equal. One work-group a tile; `row_squares` holds H values, `best_values` and
// `best_places` GROUP each.
__kernel void FindPeak(__global const float* restrict surfaces,
                       __global const float* restrict reference_coverage,
                       __global const float* restrict current_coverage,
                       __global float* restrict records, __local float* row_squares,
                       __local float* best_values, __local int* best_places) {
  const int item = get_local_id(0);
  const int tile = get_group_id(0);
  __global const float* surface = surfaces + tile * SAMPLES;

  float best = surface[item * W];
  int place = item * W;
  for (int y = item; y < H; y += GROUP) {
    __global const float* row = surface + y * W;
    Lanes highest = LOAD(row);
    Lanes squares = highest * highest;
    for (int x = V; x < W; x += V) {
      const Lanes value = LOAD(row + x);
      highest = fmax(highest, value);
      squares += value * value;
    }
    row_squares[y] = SumOfLanes(squares);
    const float row_highest = MaxOfLanes(highest);
    if (row_highest > best) {
      best = row_highest;
      int x = 0;
      while (x + 1 < W && row[x] != best) ++x;
      place = y * W + x;
    }
  }
  best_values[item] = best;
  best_places[item] = place;
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int half_group = GROUP / 2; half_group > 0; half_group /= 2) {
    if (item < half_group) {
      const float other = best_values[item + half_group];
      const int other_place = best_places[item + half_group];
      if (other > best || (other == best && other_place < place)) {
        best = best_values[item] = other;
        place = best_places[item] = other_place;
      }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
  }

  const int peak_x = best_places[0] & (W - 1);
  const int peak_y = best_places[0] / W;
  __global float* record = records + tile * RECORD;
  for (int i = item; i < SIDE; i += GROUP) {
    const int y = (peak_y + i - RADIUS) & (H - 1);
    row_squares[y] = SquaresBeside(surface + y * W, peak_x);
    for (int x = 0; x < SIDE; ++x) {
      record[5 + i * SIDE + x] = surface[y * W + ((peak_x + x - RADIUS) & (W - 1))];
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item == 0) {
    float sum = 0.0f;
    for (int y = 0; y < H; ++y) sum += row_squares[y];
    record[0] = (float)peak_x;
    record[1] = (float)peak_y;
    record[2] = sum / (float)(SAMPLES - SIDE * SIDE);
    record[3] = reference_coverage[tile];
    record[4] = current_coverage[tile];
  }
}
