// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/difference_threshold/difference_threshold_cpu.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#include "gpu-kernels/difference_threshold/difference_threshold_check.h"
#include "gpu-kernels/multiversion.h"

namespace windhover {
namespace {

// One row of the background with what lies above and below it. `centre` has a readable pixel of 0
// before its first and behind its last one; rows outside the picture are rows of 0.
struct BackgroundRows {
  const std::uint8_t* above;
  const std::uint8_t* centre;
  const std::uint8_t* below;
};

inline unsigned SeenDifference(unsigned a, unsigned b) {
  const unsigned difference = a > b ? a - b : b - a;
  return (a != 0) & (b != 0) ? difference : 0U;
}

// flags[x] = 1 where pixel x is a seed. All in units of 1/128 grey level, which makes the
// threshold's gradient term, gain_64ths / 64 * difference / 2, an integer; both sides fit 16 bits.
WINDHOVER_MULTIVERSION
void FlagRow(const std::uint8_t* frame, const BackgroundRows& background, int width, int threshold,
             int gain_64ths, std::uint8_t* flags) {
  const std::uint8_t* above = background.above;
  const std::uint8_t* centre = background.centre;
  const std::uint8_t* below = background.below;
  for (int x = 0; x < width; ++x) {
    const unsigned f = frame[x];
    const unsigned b = centre[x];
    const unsigned difference = f > b ? f - b : b - f;
    const unsigned above_threshold =
        difference > static_cast<unsigned>(threshold) ? difference - threshold : 0U;
    const unsigned dx = SeenDifference(centre[x + 1], centre[x - 1]);
    const unsigned dy = SeenDifference(below[x], above[x]);
    const auto forgiven = static_cast<std::uint16_t>(gain_64ths * (dx > dy ? dx : dy));
    const auto excess = static_cast<std::uint16_t>(128 * above_threshold);
    flags[x] = static_cast<std::uint8_t>((f != 0) & (b != 0) & (excess > forgiven));
  }
}

WINDHOVER_MULTIVERSION
void FlagRowWithoutGradient(const std::uint8_t* frame, const std::uint8_t* background, int width,
                            int threshold, std::uint8_t* flags) {
  const auto limit = static_cast<std::uint8_t>(threshold);
  for (int x = 0; x < width; ++x) {
    const std::uint8_t f = frame[x];
    const std::uint8_t b = background[x];
    const auto difference = static_cast<std::uint8_t>(f > b ? f - b : b - f);
    flags[x] = static_cast<std::uint8_t>((f != 0) & (b != 0) & (difference > limit));
  }
}

// Packs flags of 0 and 1, a multiple of 32 of them, least significant bit first. The multiplication
// gathers the lowest bits of eight bytes in the highest byte.
void PackFlags(const std::uint8_t* flags, int words, std::uint32_t* out) {
  constexpr std::uint64_t kGather = 0x0102040810204080ULL;
  for (int i = 0; i < words; ++i) {
    std::uint32_t word = 0;
    for (int j = 0; j < 4; ++j) {
      std::uint64_t eight = 0;
      for (int k = 0; k < 8; ++k) {
        eight |= static_cast<std::uint64_t>(flags[32 * i + 8 * j + k]) << (8 * k);
      }
      word |= static_cast<std::uint32_t>((eight * kGather) >> 56) << (8 * j);
    }
    out[i] = word;
  }
}

class DifferenceThresholdCpu : public DifferenceThreshold {
 public:
  void Run(const GrayImage& frame, const GrayImage& background,
           const DifferenceThresholdSettings& settings, BitImage& seeds) override {
    CheckDifferenceThreshold(frame, background, settings, seeds);
    const int width = frame.width();
    const int height = frame.height();
    const int words = (width + 31) / 32;
    const int gain_64ths = GainIn64ths(settings);
    const auto f = frame.Read();
    const auto b = background.Read();
    const auto out = seeds.words.Write();
    zeros_.resize(width);
    flags_.assign(32 * words, 0);
    padded_.assign(width + 2, 0);
    for (int y = 0; y < height; ++y) {
      if (gain_64ths == 0) {
        FlagRowWithoutGradient(f.row(y), b.row(y), width, settings.threshold, flags_.data());
      } else {
        std::memcpy(padded_.data() + 1, b.row(y), width);
        const BackgroundRows rows = {y > 0 ? b.row(y - 1) : zeros_.data(), padded_.data() + 1,
                                     y + 1 < height ? b.row(y + 1) : zeros_.data()};
        FlagRow(f.row(y), rows, width, settings.threshold, gain_64ths, flags_.data());
      }
      PackFlags(flags_.data(), words, out.row(y));
    }
  }

 private:
  std::vector<std::uint8_t> zeros_;
  std::vector<std::uint8_t> padded_;
  std::vector<std::uint8_t> flags_;
};

}  // namespace

std::unique_ptr<DifferenceThreshold> MakeDifferenceThresholdCpu() {
  return std::make_unique<DifferenceThresholdCpu>();
}

}  // namespace windhover
