// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/difference_threshold/difference_threshold_cpu.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <vector>

#include "gpu-kernels/difference_threshold/difference_threshold_check.h"
#include "gpu-kernels/multiversion.h"

namespace windhover {
namespace {

// One row of the background with what lies above and below it. `centre` is 0 before its first pixel
// and behind its last one; rows outside the picture are rows of 0.
struct BackgroundRows {
  const std::uint8_t* above;
  const std::uint8_t* centre;
  const std::uint8_t* below;
};

// Steps stay in 8 bits as long as they fit, so that a vector holds more pixels.
inline std::uint8_t Difference(std::uint8_t a, std::uint8_t b) {
  return static_cast<std::uint8_t>(a > b ? a - b : b - a);
}

// 0 where a or b has not been seen.
inline std::uint8_t SeenDifference(std::uint8_t a, std::uint8_t b) {
  const std::uint8_t difference = Difference(a, b);
  return (a != 0) & (b != 0) ? difference : std::uint8_t{0};
}

// flags[x] = 1 where pixel x is a seed. All in units of 1/128 grey level, which makes the
// threshold's gradient term, gain_64ths / 64 * difference / 2, an integer; both sides of the
// comparison fit 16 bits.
WINDHOVER_MULTIVERSION
void FlagRow(const std::uint8_t* frame, const BackgroundRows& background, int width, int threshold,
             int gain_64ths, std::uint8_t* flags) {
  const std::uint8_t* above = background.above;
  const std::uint8_t* centre = background.centre;
  const std::uint8_t* below = background.below;
  const auto limit = static_cast<std::uint8_t>(threshold);
  const auto gain = static_cast<std::uint16_t>(gain_64ths);
  for (int x = 0; x < width; ++x) {
    const std::uint8_t f = frame[x];
    const std::uint8_t b = centre[x];
    const std::uint8_t change = Difference(f, b);
    const auto excess = static_cast<std::uint8_t>(change > limit ? change - limit : 0);
    const std::uint8_t dx = SeenDifference(centre[x + 1], centre[x - 1]);
    const std::uint8_t dy = SeenDifference(below[x], above[x]);
    const std::uint8_t gradient = dx > dy ? dx : dy;
    const bool is_seed =
        static_cast<std::uint16_t>(128 * excess) > static_cast<std::uint16_t>(gain * gradient);
    flags[x] = static_cast<std::uint8_t>((f != 0) & (b != 0) & is_seed);
  }
}

WINDHOVER_MULTIVERSION
void FlagRowWithoutGradient(const std::uint8_t* frame, const std::uint8_t* background, int width,
                            int threshold, std::uint8_t* flags) {
  const auto limit = static_cast<std::uint8_t>(threshold);
  for (int x = 0; x < width; ++x) {
    const std::uint8_t f = frame[x];
    const std::uint8_t b = background[x];
    flags[x] = static_cast<std::uint8_t>((f != 0) & (b != 0) & (Difference(f, b) > limit));
  }
}

// Packs flags of 0 and 1, a multiple of 32 of them, least significant bit first. The multiplication
// gathers the lowest bits of eight bytes in the highest byte.
static_assert(std::endian::native == std::endian::little);
void PackFlags(const std::uint8_t* flags, int words, std::uint32_t* out) {
  constexpr std::uint64_t kGather = 0x0102040810204080ULL;
  for (int i = 0; i < words; ++i) {
    std::uint64_t eights[4];
    std::memcpy(eights, flags + 32 * i, sizeof(eights));
    std::uint32_t word = 0;
    for (int j = 0; j < 4; ++j) {
      word |= static_cast<std::uint32_t>((eights[j] * kGather) >> 56) << (8 * j);
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
