// SPDX-License-Identifier: Apache-2.0

// Sum of the squares of a row's samples, without those up to `radius` from column `skip_x`.
INLINE float SquaresBeside(__global const float* row, int width, int skip_x, int radius) {
  Lanes sum = 0.0f;
  for (int x = 0; x < width; x += V) {
    const IntLanes distance =
        ((LaneNumbers() + (x - skip_x + width / 2)) & (width - 1)) - width / 2;
    const Lanes value = LOAD(row + x);
    sum += select(value * value, (Lanes)(0.0f), (distance <= radius) & (distance >= -radius));
  }
  return SumOfLanes(sum);
}

// Finds the highest sample of each tile's correlation surface, the first one in row-major order
// where several are equal. One work-group a tile. `row_squares` holds `height` values,
// `best_values` and `best_places` GROUP each.
//
// A tile's record: column and row of the highest sample, mean square of the samples outside its
// neighbourhood, coverage of the reference and of the current tile, then the neighbourhood's
// (2 * radius + 1)^2 samples, row-major; columns and rows continue periodically.
__kernel void FindPeak(__global const float* restrict surfaces, int width, int height, int radius,
                       __global const float* restrict reference_coverage,
                       __global const float* restrict current_coverage,
                       __global float* restrict records, __local float* row_squares,
                       __local float* best_values, __local int* best_places) {
  const int item = get_local_id(0);
  const int tile = get_group_id(0);
  const int side = 2 * radius + 1;
  __global const float* surface = surfaces + tile * width * height;

  float best = surface[item * width];
  int place = item * width;
  for (int y = item; y < height; y += GROUP) {
    __global const float* row = surface + y * width;
    Lanes highest = LOAD(row);
    Lanes squares = highest * highest;
    for (int x = V; x < width; x += V) {
      const Lanes value = LOAD(row + x);
      highest = fmax(highest, value);
      squares += value * value;
    }
    row_squares[y] = SumOfLanes(squares);
    const float row_highest = MaxOfLanes(highest);
    if (row_highest > best) {
      best = row_highest;
      int x = 0;
      while (x + 1 < width && row[x] != best) ++x;
      place = y * width + x;
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

  const int peak_x = best_places[0] & (width - 1);
  const int peak_y = best_places[0] / width;
  __global float* record = records + tile * (5 + side * side);
  for (int i = item; i < side; i += GROUP) {
    const int y = (peak_y + i - radius) & (height - 1);
    row_squares[y] = SquaresBeside(surface + y * width, width, peak_x, radius);
    for (int x = 0; x < side; ++x) {
      record[5 + i * side + x] = surface[y * width + ((peak_x + x - radius) & (width - 1))];
    }
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (item == 0) {
    float sum = 0.0f;
    for (int y = 0; y < height; ++y) sum += row_squares[y];
    record[0] = (float)peak_x;
    record[1] = (float)peak_y;
    record[2] = sum / (float)(width * height - side * side);
    record[3] = reference_coverage[tile];
    record[4] = current_coverage[tile];
  }
}
