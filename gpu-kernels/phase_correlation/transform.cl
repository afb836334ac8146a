// SPDX-License-Identifier: Apache-2.0
//
// Fourier transforms of tile pairs. A work-item transforms V neighbouring columns at a time, one a
// lane, and writes the result transposed: two such steps make a two-dimensional transform in
// natural order. The columns' transform decimates in frequency, in place: a block of values is
// split by radix 8 or 4 until nothing is left to split.
//
// `columns`, a power of two, is how many there are; all kernels have the global size columns / V x
// pairs of tiles. Tables: twiddle[k] = exp(-2 pi i k / N), and order[k], where the value of
// frequency k lies after the last split.

// Forward transform of 4 values, natural order.
INLINE void Transform4(Lanes* re, Lanes* im) {
  const Lanes a_re = re[0] + re[2], a_im = im[0] + im[2];
  const Lanes b_re = re[0] - re[2], b_im = im[0] - im[2];
  const Lanes c_re = re[1] + re[3], c_im = im[1] + im[3];
  const Lanes d_re = re[1] - re[3], d_im = im[1] - im[3];
  re[0] = a_re + c_re, im[0] = a_im + c_im;
  re[1] = b_re + d_im, im[1] = b_im - d_re;
  re[2] = a_re - c_re, im[2] = a_im - c_im;
  re[3] = b_re - d_im, im[3] = b_im + d_re;
}

// Forward transform of 8 values, natural order.
INLINE void Transform8(Lanes* re, Lanes* im) {
  Lanes even_re[4] = {re[0], re[2], re[4], re[6]}, even_im[4] = {im[0], im[2], im[4], im[6]};
  Lanes odd_re[4] = {re[1], re[3], re[5], re[7]}, odd_im[4] = {im[1], im[3], im[5], im[7]};
  Transform4(even_re, even_im);
  Transform4(odd_re, odd_im);
  // The odd half times exp(-2 pi i k / 8).
  const float root = 0.70710678118654752f;
  const Lanes turned_re[4] = {odd_re[0], root * (odd_re[1] + odd_im[1]), odd_im[2],
                              root * (odd_im[3] - odd_re[3])};
  const Lanes turned_im[4] = {odd_im[0], root * (odd_im[1] - odd_re[1]), -odd_re[2],
                              -root * (odd_re[3] + odd_im[3])};
#pragma unroll
  for (int k = 0; k < 4; ++k) {
    re[k] = even_re[k] + turned_re[k], im[k] = even_im[k] + turned_im[k];
    re[k + 4] = even_re[k] - turned_re[k], im[k + 4] = even_im[k] - turned_im[k];
  }
}

// Splits every block of `block` values into RADIX blocks, of which block m takes the frequencies
// RADIX * q + m.
#define DEFINE_SPLIT(RADIX)                                                                     \
  INLINE void SplitBy##RADIX(Lanes* re, Lanes* im, __global const float2* twiddle, int block) { \
    const int step = block / RADIX;                                                             \
    for (int j = 0; j < step; ++j) {                                                            \
      float2 turn[RADIX];                                                                       \
      for (int m = 1; m < RADIX; ++m) turn[m] = twiddle[m * j * (N / block)];                   \
      for (int at = j; at < N; at += block) {                                                   \
        Lanes r[RADIX], i[RADIX];                                                               \
        _Pragma("unroll") for (int m = 0; m < RADIX; ++m) {                                     \
          r[m] = re[at + m * step], i[m] = im[at + m * step];                                   \
        }                                                                                       \
        Transform##RADIX(r, i);                                                                 \
        re[at] = r[0], im[at] = i[0];                                                           \
        _Pragma("unroll") for (int m = 1; m < RADIX; ++m) {                                     \
          re[at + m * step] = turn[m].x * r[m] - turn[m].y * i[m];                              \
          im[at + m * step] = turn[m].x * i[m] + turn[m].y * r[m];                              \
        }                                                                                       \
      }                                                                                         \
    }                                                                                           \
  }
DEFINE_SPLIT(4)
DEFINE_SPLIT(8)

// The last split, which needs no twiddles.
#define DEFINE_FINISH(RADIX)                                                  \
  INLINE void FinishBy##RADIX(Lanes* re, Lanes* im) {                         \
    for (int at = 0; at < N; at += RADIX) Transform##RADIX(re + at, im + at); \
  }
DEFINE_FINISH(4)
DEFINE_FINISH(8)

// In place; frequency k comes to lie at order[k] (PhaseCorrelationOpenCl makes that table).
INLINE void TransformLanes(Lanes* re, Lanes* im, __global const float2* twiddle) {
  int block = N;
  for (; block > 8; block /= block == 16 ? 4 : 8) {
    if (block == 16) {
      SplitBy4(re, im, twiddle, block);
    } else {
      SplitBy8(re, im, twiddle, block);
    }
  }
  if (block == 8) {
    FinishBy8(re, im);
  } else {
    FinishBy4(re, im);
  }
}

// a0 b0 a1 b1 ... of the lower, and of the upper halves of two vectors.
#if V == 2
#define INTERLEAVE_LOW(a, b) (float2)(a.x, b.x)
#define INTERLEAVE_HIGH(a, b) (float2)(a.y, b.y)
#elif V == 4
#define INTERLEAVE_LOW(a, b) (float4)(a.x, b.x, a.y, b.y)
#define INTERLEAVE_HIGH(a, b) (float4)(a.z, b.z, a.w, b.w)
#elif V == 8
#define INTERLEAVE_LOW(a, b) (float8)(a.s0, b.s0, a.s1, b.s1, a.s2, b.s2, a.s3, b.s3)
#define INTERLEAVE_HIGH(a, b) (float8)(a.s4, b.s4, a.s5, b.s5, a.s6, b.s6, a.s7, b.s7)
#elif V == 16
#define INTERLEAVE_LOW(a, b)                                                                    \
  (float16)(a.s0, b.s0, a.s1, b.s1, a.s2, b.s2, a.s3, b.s3, a.s4, b.s4, a.s5, b.s5, a.s6, b.s6, \
            a.s7, b.s7)
#define INTERLEAVE_HIGH(a, b)                                                                   \
  (float16)(a.s8, b.s8, a.s9, b.s9, a.sa, b.sa, a.sb, b.sb, a.sc, b.sc, a.sd, b.sd, a.se, b.se, \
            a.sf, b.sf)
#endif

// Writes V columns as V rows of N values. A block of V x V is transposed in registers: each
// round interleaves vector i with vector i + V / 2, which turns the bits of (vector, lane) by one.
INLINE void StoreTransposed(const Lanes* values, __global const int* order,
                            __global float* restrict out) {
  for (int k = 0; k < N; k += V) {
#if V == 1
    out[k] = values[order[k]];
#else
    Lanes block[V], turned[V];
#pragma unroll
    for (int i = 0; i < V; ++i) block[i] = values[order[k + i]];
#pragma unroll
    for (int round = 1; round < V; round *= 2) {
#pragma unroll
      for (int i = 0; i < V / 2; ++i) {
        turned[2 * i] = INTERLEAVE_LOW(block[i], block[i + V / 2]);
        turned[2 * i + 1] = INTERLEAVE_HIGH(block[i], block[i + V / 2]);
      }
#pragma unroll
      for (int i = 0; i < V; ++i) block[i] = turned[i];
    }
#pragma unroll
    for (int i = 0; i < V; ++i) STORE(block[i], out + i * N + k);
#endif
  }
}

INLINE float SumOf(__global const float* values) {
  Lanes sum = 0.0f;
  for (int i = 0; i < N; i += V) sum += LOAD(values + i);
  return SumOfLanes(sum);
}

// Transforms the columns x to x + V - 1 of a pair of tiles and writes them as rows.
INLINE void TransformAndStore(Lanes* re, Lanes* im, __global const float2* twiddle,
                              __global const int* order, int pair, int x, int plane,
                              __global float* out) {
  TransformLanes(re, im, twiddle);
  __global float* destination = out + 2 * plane * pair + x * N;
  StoreTransposed(re, order, destination);
  StoreTransposed(im, order, destination + plane);
}

// First step of a picture's transform: takes the window-weighted mean off the samples, applies the
// window, transforms columns. Also notes each tile's coverage.
__kernel void TransformSamples(__global const float* restrict samples,
                               __global const float* restrict row_sums, int columns,
                               __global const float* restrict window_x,
                               __global const float* restrict window_y, float window_sum,
                               __global const float2* restrict twiddle,
                               __global const int* restrict order,
                               __global float* restrict coverage, __global float* restrict out) {
  const int x = get_global_id(0) * V;
  const int pair = get_global_id(1);
  const int plane = N * columns;
  const Lanes weight_x = LOAD(window_x + x);
  Lanes parts[2][N];
  for (int part = 0; part < 2; ++part) {
    const int tile = 2 * pair + part;
    const float value_sum = SumOf(row_sums + 2 * N * tile);
    const float seen_sum = SumOf(row_sums + 2 * N * tile + N);
    const float mean = seen_sum > 0.0f ? value_sum / seen_sum : 0.0f;
    if (x == 0) coverage[tile] = fmin(seen_sum / window_sum, 1.0f);
    __global const float* column = samples + tile * plane + x;
    for (int y = 0; y < N; ++y) {
      const Lanes value = LOAD(column + y * columns);
      parts[part][y] =
          select((Lanes)(0.0f), weight_x * window_y[y] * (value - mean), value >= 0.0f);
    }
  }
  TransformAndStore(parts[0], parts[1], twiddle, order, pair, x, plane, out);
}

// Second step of a transform or of an inverse one.
__kernel void TransformColumns(__global const float* restrict in, int columns,
                               __global const float2* restrict twiddle,
                               __global const int* restrict order, __global float* restrict out) {
  const int x = get_global_id(0) * V;
  const int pair = get_global_id(1);
  const int plane = N * columns;
  __global const float* column = in + 2 * plane * pair + x;
  Lanes re[N], im[N];
  for (int y = 0; y < N; ++y) {
    re[y] = LOAD(column + y * columns);
    im[y] = LOAD(column + plane + y * columns);
  }
  TransformAndStore(re, im, twiddle, order, pair, x, plane, out);
}

typedef struct {
  Lanes re;
  Lanes im;
} Complex;

// Values at x to x + V - 1 of a spectrum's row.
INLINE Complex LoadBins(__global const float* row, int x, int plane) {
  return (Complex){LOAD(row + x), LOAD(row + plane + x)};
}

// Values at -x to -(x + V - 1) of a row of one plane; columns continue periodically.
INLINE Lanes LoadMirrored(__global const float* row, int x, int columns) {
  const float first = row[(columns - x) & (columns - 1)];
#if V == 1
  return first;
#else
  const Lanes rest = LOAD(row + columns - x - V);
#if V == 2
  return (float2)(first, rest.s1);
#elif V == 4
  return (float4)(first, rest.s32, rest.s1);
#elif V == 8
  return (float8)(first, rest.s7654, rest.s32, rest.s1);
#else
  return (float16)(first, rest.sfedcba98, rest.s7654, rest.s32, rest.s1);
#endif
#endif
}

INLINE Complex LoadMirroredBins(__global const float* row, int x, int columns, int plane) {
  return (Complex){LoadMirrored(row, x, columns), LoadMirrored(row + plane, x, columns)};
}

// Cross power conj(reference) * current over its magnitude (eq. 2.18, the sign that puts the peak
// of current(x + d) = reference(x) at d), weighted. `damping` holds down what does not rise above
// it.
INLINE Complex NormalisedCrossPower(Complex reference, Complex current, Lanes weight,
                                    float damping) {
  const Lanes re = current.re * reference.re + current.im * reference.im;
  const Lanes im = current.im * reference.re - current.re * reference.im;
  const Lanes scale = weight / (sqrt(re * re + im * im) + damping);
  return (Complex){scale * re, scale * im};
}

// First step of the inverse transform of the cross power of two pictures.
//
// With z the transform of a + i b, twice the transform of a is z(k) + conj(z(-k)), that of b is
// (z(k) - conj(z(-k))) / i; the factors are made up for by four times the noise power. An inverse
// transform is a forward one between swapped real and imaginary parts: of c_b + i c_a, where c_a
// and c_b are the cross powers, so that the surfaces of a and b come out as real and imaginary
// part.
__kernel void TransformCrossPower(__global const float* restrict reference,
                                  __global const float* restrict current, int columns,
                                  __global const float* restrict weight, float damping,
                                  __global const float2* restrict twiddle,
                                  __global const int* restrict order,
                                  __global float* restrict out) {
  const int x = get_global_id(0) * V;
  const int pair = get_global_id(1);
  const int plane = N * columns;
  reference += 2 * plane * pair;
  current += 2 * plane * pair;
  Lanes re[N], im[N];
  for (int y = 0; y < N; ++y) {
    const int row = y * columns;
    const int mirrored_row = ((N - y) & (N - 1)) * columns;
    const Complex r = LoadBins(reference + row, x, plane);
    const Complex s = LoadMirroredBins(reference + mirrored_row, x, columns, plane);
    const Complex c = LoadBins(current + row, x, plane);
    const Complex d = LoadMirroredBins(current + mirrored_row, x, columns, plane);
    const Lanes w = LOAD(weight + row + x);
    const Complex first =
        NormalisedCrossPower((Complex){r.re + s.re, r.im - s.im},
                             (Complex){c.re + d.re, c.im - d.im}, w, 4.0f * damping);
    const Complex second =
        NormalisedCrossPower((Complex){r.im + s.im, s.re - r.re},
                             (Complex){c.im + d.im, d.re - c.re}, w, 4.0f * damping);
    re[y] = second.im + first.re;
    im[y] = second.re - first.im;
  }
  TransformAndStore(re, im, twiddle, order, pair, x, plane, out);
}
