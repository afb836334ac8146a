// SPDX-License-Identifier: Apache-2.0
//
// Warp by a homography. Compiled behind phase_correlation/lanes.cl and bilinear.cl.

#if V == 1
typedef uchar ByteLanes;
#define TO_BYTE(value) convert_uchar_sat_rtz(value)
#else
typedef JOIN(uchar, V) ByteLanes;
#define TO_BYTE(value) JOIN(JOIN(convert_uchar, V), _sat_rtz)(value)
#endif

// One work-item does every get_global_size(0)-th batch of a row. `matrix` holds the 9 elements of
// source_from_destination. Batches may reach into the rows' padding.
__kernel void Warp(__global const uchar* restrict source, int source_width, int source_height,
                   int source_stride, float16 matrix, __global uchar* restrict destination,
                   int width, int height, int stride) {
  const int y = get_global_id(1);
  if (y >= height) return;
  const Source from = {source, source_width, source_height, source_stride};
  const float3 step = matrix.s036;
  const float3 origin = matrix.s147 * (float)y + matrix.s258;
  __global uchar* out = destination + y * stride;
  for (int x = get_global_id(0) * BATCH; x < width; x += get_global_size(0) * BATCH) {
    Samples samples;
    SampleRow(from, origin, step, x, &samples);
    for (int i = 0; i < BATCH / V; ++i) {
      const Lanes grey = max(samples.values[i], 1.0f) * samples.seen[i];
      *(__global ByteLanes*)(out + x + i * V) = TO_BYTE(grey + 0.5f);
    }
  }
}
