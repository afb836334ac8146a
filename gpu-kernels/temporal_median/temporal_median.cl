// SPDX-License-Identifier: Apache-2.0
//
// Pixel-wise lower median of the frames that have seen a pixel.
//
// OpenCL C 1.2 knows no array of buffers as an argument. So each frame is an argument of its own,
// which saves copying the window on every frame; a kernel with 32 such arguments serves up to 32
// frames, one with 96 serves up to 96 (and keeps within the 1024 bytes of arguments that every
// device takes). Where there are still more, or their rows differ in stride, the frames are first
// stacked in one buffer.
//
// Macros given to the compiler:
//   SLOTS   frames that are arguments: 32 or 96; 0 for frames stacked in one buffer
//   V       pixels that are searched together: 1 to 64, a divisor of 64. OpenCL has no vectors of
//           more than 16; wider ones are an extension of the compilers for CPUs.

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#if V == 1
typedef uchar Bytes;
#define AT_LEAST(a, b) ((uchar)((a) >= (b) ? 255 : 0))
#elif V <= 16
typedef JOIN(uchar, V) Bytes;
#define AT_LEAST(a, b) JOIN(as_uchar, V)((a) >= (b))
#else
typedef uchar Bytes __attribute__((ext_vector_type(V)));
#define AT_LEAST(a, b) __builtin_astype((a) >= (b), Bytes)
#endif

#define EIGHT_FRAMES(X, s) X(s##0) X(s##1) X(s##2) X(s##3) X(s##4) X(s##5) X(s##6) X(s##7)
#if SLOTS == 32
#define FRAMES(X) EIGHT_FRAMES(X, a) EIGHT_FRAMES(X, b) EIGHT_FRAMES(X, c) EIGHT_FRAMES(X, d)
#elif SLOTS == 96
#define FRAMES(X)                                                                                 \
  EIGHT_FRAMES(X, a) EIGHT_FRAMES(X, b) EIGHT_FRAMES(X, c) EIGHT_FRAMES(X, d) EIGHT_FRAMES(X, e) \
  EIGHT_FRAMES(X, f) EIGHT_FRAMES(X, g) EIGHT_FRAMES(X, h) EIGHT_FRAMES(X, i) EIGHT_FRAMES(X, j) \
  EIGHT_FRAMES(X, k) EIGHT_FRAMES(X, l)
#endif
#define PARAMETER(name) __global const uchar *name,
#define ELEMENT(name) name,

#if SLOTS > 0
#define IN_FRAME(i) (*(__global const Bytes*)(frames[i] + offset))
#else
#define IN_FRAME(i) (*(__global const Bytes*)(stack + (ulong)(i) * frame_pitch + offset))
#endif
// CPUs gather the values first: frames whose size is a multiple of 4096 bytes would otherwise evict
// one another from the first level cache in each of the 8 steps. GPUs have no such memory of their
// own.
#if V >= 16
#define MAX_FRAMES (SLOTS > 0 ? SLOTS : 255)
#define KEEP(i, value) (kept[i] = (value))
#define VALUES(i) kept[i]
#else
#define KEEP(i, value) (value)
#define VALUES(i) IN_FRAME(i)
#endif

// The median of n seen values is the largest m that at least n / 2 + 1 values reach, found bit by
// bit from the highest. One work-item does every get_global_size(0)-th group of V pixels of a row;
// groups may reach into the rows' padding.
__kernel void TemporalMedian(
#if SLOTS > 0
    FRAMES(PARAMETER)
#else
    __global const uchar* restrict stack, ulong frame_pitch,
#endif
    int count, int min_samples, __global uchar* restrict median, int width, int height,
    int frame_stride, int median_stride) {
  const int y = get_global_id(1);
  if (y >= height) return;
#if SLOTS > 0
  __global const uchar* const frames[SLOTS] = {FRAMES(ELEMENT)};
#endif
#if V >= 16
  Bytes kept[MAX_FRAMES];
#endif
  for (int x = get_global_id(0) * V; x < width; x += get_global_size(0) * V) {
    const int offset = y * frame_stride + x;
    Bytes seen = 0;
    for (int i = 0; i < count; ++i) seen -= AT_LEAST(KEEP(i, IN_FRAME(i)), (Bytes)(1));
    const Bytes needed = seen / (Bytes)(2) + (Bytes)(1);
    Bytes result = 0;
    for (int bit = 128; bit > 0; bit >>= 1) {
      const Bytes candidate = result | (Bytes)((uchar)bit);
      Bytes reached = 0;
      for (int i = 0; i < count; ++i) reached -= AT_LEAST(VALUES(i), candidate);
      const Bytes accepted = AT_LEAST(reached, needed);
      result = (candidate & accepted) | (result & ~accepted);
    }
    *(__global Bytes*)(median + y * median_stride + x) =
        result & AT_LEAST(seen, (Bytes)((uchar)min_samples));
  }
}

// Copies one frame into the stack, 16 pixels a work-item, with rows of stack_stride.
__kernel void StackFrame(__global const uchar16* restrict frame, int frame_stride,
                         __global uchar16* restrict stack, ulong stack_offset, int stack_stride,
                         int height) {
  const int x = get_global_id(0);
  const int y = get_global_id(1);
  if (x >= stack_stride / 16 || y >= height) return;
  stack[stack_offset / 16 + y * (stack_stride / 16) + x] = frame[y * (frame_stride / 16) + x];
}
