// SPDX-License-Identifier: Apache-2.0
#include "service/vision/block_residuals.h"

#include "gpu-kernels/multiversion.h"

namespace windhover {
namespace {

// The homogeneous coordinates in the frame are linear in those of the reference.
struct Warping {
  double m[9];
  float gain;
  float bias;
};

bool LiesOnFrame(const ReferenceBlock& block, const Warping& warping, const FloatPicture& frame) {
  const double* m = warping.m;
  for (const int i : {0, kBlockSide - 1}) {
    for (const int j : {0, kBlockSide - 1}) {
      const double x = block.x + i;
      const double y = block.y + j;
      const double w = m[6] * x + m[7] * y + m[8];
      if (w <= 0.0) return false;
      const double u = (m[0] * x + m[1] * y + m[2]) / w;
      const double v = (m[3] * x + m[4] * y + m[5]) / w;
      // A little less than the border: single precision must not reach beyond it.
      constexpr double kRim = 0.01;
      if (!(u >= kRim && v >= kRim && u <= frame.width - 1 - kRim &&
            v <= frame.height - 1 - kRim)) {
        return false;
      }
    }
  }
  return true;
}

// Sums over the columns of a block, before they are added up.
struct ColumnSums {
  float e[kBlockSide] = {};
  float te[kBlockSide] = {};
  float ee[kBlockSide] = {};
  float seen[kBlockSide] = {};
  float xe[kBlockSide] = {};    // gradient_x e
  float xve[kBlockSide] = {};   // gradient_x v e
  float ye[kBlockSide] = {};    // gradient_y e
  float yve[kBlockSide] = {};   // gradient_y v e
  float yvve[kBlockSide] = {};  // gradient_y v^2 e
};

// Pixel values of the frame at the places of one row of the block, linearly interpolated.
struct RowOfFrame {
  float values[kBlockSide];
};

inline RowOfFrame SampleRow(const ReferenceBlock& block, int j, const Warping& warping,
                            const float* frame, int stride) {
  const double* m = warping.m;
  const double x = block.x;
  const double y = block.y + j;
  const auto u0 = static_cast<float>(m[0] * x + m[1] * y + m[2]);
  const auto v0 = static_cast<float>(m[3] * x + m[4] * y + m[5]);
  const auto w0 = static_cast<float>(m[6] * x + m[7] * y + m[8]);
  const auto u_step = static_cast<float>(m[0]);
  const auto v_step = static_cast<float>(m[3]);
  const auto w_step = static_cast<float>(m[6]);
  RowOfFrame row;
  for (int i = 0; i < kBlockSide; ++i) {
    const auto step = static_cast<float>(i);
    const float inverse = 1.0F / (w0 + w_step * step);
    const float u = (u0 + u_step * step) * inverse;
    const float v = (v0 + v_step * step) * inverse;
    const int left = static_cast<int>(u);
    const int top = static_cast<int>(v);
    const float fraction_x = u - static_cast<float>(left);
    const float fraction_y = v - static_cast<float>(top);
    const float* const upper = frame + top * stride + left;
    const float* const lower = upper + stride;
    const float above = upper[0] + fraction_x * (upper[1] - upper[0]);
    const float below = lower[0] + fraction_x * (lower[1] - lower[0]);
    row.values[i] = above + fraction_y * (below - above);
  }
  return row;
}

// A block's residuals by columns. It lies on the frame wholly or not at all, so that its pixels
// need no test.
WINDHOVER_MULTIVERSION
void SumColumns(const ReferenceBlock& block, const Warping& warping, const float* frame, int stride,
                float v_first, float v_per_row, ColumnSums& sums) {
  for (int j = 0; j < kBlockSide; ++j) {
    const RowOfFrame row = SampleRow(block, j, warping, frame, stride);
    const float v = v_first + v_per_row * static_cast<float>(j);
    const float* const gradient_x = block.gradient_x.data() + j * kBlockSide;
    const float* const gradient_y = block.gradient_y.data() + j * kBlockSide;
    const float* const value = block.value.data() + j * kBlockSide;
    const float* const use = block.use.data() + j * kBlockSide;
    for (int i = 0; i < kBlockSide; ++i) {
      const bool shown = (row.values[i] > kDarkest) & (row.values[i] < kBrightest);
      const float seen = shown ? use[i] : 0.0F;
      const float e = seen * (warping.gain * row.values[i] + warping.bias - value[i]);
      const float xe = gradient_x[i] * e;
      const float ye = gradient_y[i] * e;
      sums.e[i] += e;
      sums.te[i] += value[i] * e;
      sums.ee[i] += e * e;
      sums.seen[i] += seen;
      sums.xe[i] += xe;
      sums.xve[i] += v * xe;
      sums.ye[i] += ye;
      sums.yve[i] += v * ye;
      sums.yvve[i] += v * v * ye;
    }
  }
}

BlockResidual AddColumns(const ColumnSums& sums, float u0, float u_step) {
  BlockResidual r{};
  for (int i = 0; i < kBlockSide; ++i) {
    const float u = u0 + u_step * static_cast<float>(i);
    r.gradient[0] += sums.e[i];
    r.gradient[1] += sums.te[i];
    r.gradient[2] += sums.xe[i];
    r.gradient[3] += sums.ye[i];
    r.gradient[4] += u * sums.xe[i];
    r.gradient[5] += sums.xve[i];
    r.gradient[6] += u * sums.ye[i];
    r.gradient[7] += sums.yve[i];
    r.gradient[8] -= u * (u * sums.xe[i] + sums.yve[i]);
    r.gradient[9] -= u * sums.xve[i] + sums.yvve[i];
    r.squared += sums.ee[i];
    r.pixels += sums.seen[i];
  }
  return r;
}

}  // namespace

void ComputeResiduals(const ReferenceBlocks& reference, const FloatPicture& frame,
                      const Eigen::Matrix3d& frame_from_reference,
                      const GainBias& reference_from_frame, std::span<BlockResidual> residuals) {
  Warping warping{};
  for (int i = 0; i < 9; ++i) warping.m[i] = frame_from_reference(i / 3, i % 3);
  warping.gain = static_cast<float>(reference_from_frame.gain);
  warping.bias = static_cast<float>(reference_from_frame.bias);
  const ScaledCoordinates& scaled = reference.scaled;
  const auto step = static_cast<float>(1.0 / scaled.px_per_unit);
  for (std::size_t i = 0; i < reference.blocks.size(); ++i) {
    const ReferenceBlock& block = reference.blocks[i];
    if (!LiesOnFrame(block, warping, frame)) {
      residuals[i] = {};
      continue;
    }
    const auto u0 = static_cast<float>((block.x - scaled.centre_x) / scaled.px_per_unit);
    const auto v0 = static_cast<float>((block.y - scaled.centre_y) / scaled.px_per_unit);
    ColumnSums sums;
    SumColumns(block, warping, frame.values.data(), frame.width, v0, step, sums);
    residuals[i] = AddColumns(sums, u0, step);
  }
}

}  // namespace windhover
