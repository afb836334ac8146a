// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/phase_correlation/phase_correlation_cpu.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>
#include <vector>

#include "gpu-kernels/multiversion.h"
#include "gpu-kernels/phase_correlation/fourier_transform_cpu.h"
#include "gpu-kernels/phase_correlation/phase_correlation_tables.h"
#include "gpu-kernels/warp/row_sampler_cpu.h"
#include "gpu-kernels/warp/warp_coefficients.h"

namespace windhover {
namespace {

// Sixteen floats at a time; tile rows are multiples of it. Partial sums in a vector let the
// compiler use the processor's vectors for a sum without reordering one of scalars.
constexpr int kLanes = 16;
using Lanes = float __attribute__((vector_size(4 * kLanes), may_alias));

// Aligned to 64 bytes, as Lanes and FourierTransform ask for.
constexpr std::align_val_t kAlignment{64};
struct AlignedDelete {
  void operator()(float* memory) const { ::operator delete(memory, kAlignment); }
};
using FloatBuffer = std::unique_ptr<float[], AlignedDelete>;

FloatBuffer AllocateFloats(std::size_t count) {
  return FloatBuffer(static_cast<float*>(::operator new(count * sizeof(float), kAlignment)));
}

// values and seen become sums weighted with the window's row.
struct WeightedSums {
  float values = 0.0F;
  float seen = 0.0F;
};

WINDHOVER_MULTIVERSION
void SumRow(const float* values, const float* seen, const float* window_x, int width,
            WeightedSums* sums) {
  Lanes value_sum = {};
  Lanes seen_sum = {};
  for (int x = 0; x < width; x += kLanes) {
    const Lanes weight = *reinterpret_cast<const Lanes*>(window_x + x);
    value_sum += weight * *reinterpret_cast<const Lanes*>(values + x);
    seen_sum += weight * *reinterpret_cast<const Lanes*>(seen + x);
  }
  *sums = {};
  for (int i = 0; i < kLanes; ++i) {
    sums->values += value_sum[i];
    sums->seen += seen_sum[i];
  }
}

WINDHOVER_MULTIVERSION
void WindowRow(float* values, const float* seen, const float* window_x, float window_y, float mean,
               int width) {
  for (int x = 0; x < width; ++x) {
    values[x] = window_x[x] * window_y * seen[x] * (values[x] - mean);
  }
}

// Weighted, normalised cross-power spectrum (eq. 2.18, with the sign that puts the peak of
// current(x + d) = reference(x) at d).
WINDHOVER_MULTIVERSION
void CrossPower(const float* reference, const float* current, const float* weight, float damping,
                int bins, float* out) {
  for (int i = 0; i < bins; ++i) {
    const float real =
        current[2 * i] * reference[2 * i] + current[2 * i + 1] * reference[2 * i + 1];
    const float imaginary =
        current[2 * i + 1] * reference[2 * i] - current[2 * i] * reference[2 * i + 1];
    const float magnitude = std::sqrt(real * real + imaginary * imaginary);
    const float scale = weight[i] / (magnitude + damping);
    out[2 * i] = scale * real;
    out[2 * i + 1] = scale * imaginary;
  }
}

struct RowSummary {
  float highest;
  float sum_of_squares;
};

WINDHOVER_MULTIVERSION
void SummariseRow(const float* row, int width, RowSummary* summary) {
  Lanes highest = *reinterpret_cast<const Lanes*>(row);
  Lanes squares = {};
  for (int x = 0; x < width; x += kLanes) {
    const Lanes values = *reinterpret_cast<const Lanes*>(row + x);
    highest = values > highest ? values : highest;
    squares += values * values;
  }
  *summary = {highest[0], 0.0F};
  for (int i = 0; i < kLanes; ++i) {
    summary->highest = highest[i] > summary->highest ? highest[i] : summary->highest;
    summary->sum_of_squares += squares[i];
  }
}

class PhaseCorrelationCpu;

class TileSpectraCpu : public TileSpectra {
 public:
  TileSpectraCpu(const PhaseCorrelationCpu* owner, std::size_t tiles, std::size_t floats_per_tile)
      : owner_(owner),
        floats_per_tile_(floats_per_tile),
        values_(AllocateFloats(tiles * floats_per_tile)),
        coverage_(tiles, 0.0F),
        shifts_(tiles) {
    std::memset(values_.get(), 0, tiles * floats_per_tile * sizeof(float));
  }

  const PhaseCorrelationCpu* owner() const { return owner_; }
  float* spectrum(std::size_t tile) const { return values_.get() + tile * floats_per_tile_; }
  float& coverage(std::size_t tile) { return coverage_[tile]; }
  float coverage(std::size_t tile) const { return coverage_[tile]; }
  TileShift& shift(std::size_t tile) { return shifts_[tile]; }
  const TileShift& shift(std::size_t tile) const { return shifts_[tile]; }

 private:
  const PhaseCorrelationCpu* owner_;
  std::size_t floats_per_tile_;
  FloatBuffer values_;
  std::vector<float> coverage_;
  std::vector<TileShift> shifts_;
};

class PhaseCorrelationCpu : public PhaseCorrelation {
 public:
  explicit PhaseCorrelationCpu(const PhaseCorrelationSettings& settings)
      : settings_(settings),
        tables_(settings),
        samples_(tables_.tile_width * tables_.tile_height),
        bins_(tables_.spectrum_width * tables_.tile_height),
        tile_(AllocateFloats(samples_)),
        seen_(AllocateFloats(samples_)),
        spectrum_(AllocateFloats(2 * bins_)),
        window_x_(AllocateFloats(tables_.tile_width)),
        row_summaries_(tables_.tile_height),
        sampler_(tables_.tile_width),
        transform_(MakeFourierTransform(tables_.tile_width, tables_.tile_height)) {
    std::memcpy(window_x_.get(), tables_.window_x.data(), tables_.tile_width * sizeof(float));
    const int side = 2 * tables_.peak_radius + 1;
    neighbourhood_.resize(side * side);
  }

  const PhaseCorrelationSettings& settings() const override { return settings_; }

  std::unique_ptr<TileSpectra> MakeSpectra() const override {
    return std::make_unique<TileSpectraCpu>(this, settings_.tiles.size(), 2 * bins_);
  }

  void Transform(const GrayImage& picture, const Matrix3& picture_from_grid,
                 TileSpectra& spectra) override {
    auto& own = Own<TileSpectraCpu>(spectra);
    if (picture.empty()) throw std::invalid_argument("phase correlation: the picture is empty");
    MakeWarpCoefficients(picture_from_grid);  // refuses what is not finite
    const auto mapped = picture.Read();
    for (std::size_t i = 0; i < settings_.tiles.size(); ++i) {
      const TileSampling sampling = SampleTileAt(picture_from_grid, settings_.tiles[i],
                                                 tables_.tile_width, tables_.tile_height);
      own.shift(i) = sampling.shift;
      own.coverage(i) = FillTile(mapped, sampling.picture_from_tile);
      transform_->Forward(tile_.get(), own.spectrum(i));
    }
  }

  void Correlate(const TileSpectra& reference, const TileSpectra& current,
                 std::span<TilePeak> peaks) override {
    const auto& own_reference = Own<const TileSpectraCpu>(reference);
    const auto& own_current = Own<const TileSpectraCpu>(current);
    if (peaks.size() != settings_.tiles.size()) {
      throw std::invalid_argument("phase correlation: there must be one peak a tile");
    }
    for (std::size_t i = 0; i < peaks.size(); ++i) {
      CrossPower(own_reference.spectrum(i), own_current.spectrum(i), tables_.spectral_weight.data(),
                 tables_.damping, bins_, spectrum_.get());
      transform_->Inverse(spectrum_.get(), tile_.get());
      peaks[i] =
          MeasurePeak(tables_, FindPeak(), own_reference.coverage(i), own_current.coverage(i));
      peaks[i].dx += own_current.shift(i).dx - own_reference.shift(i).dx;
      peaks[i].dy += own_current.shift(i).dy - own_reference.shift(i).dy;
    }
  }

 private:
  template <typename OwnSpectra, typename Spectra>
  OwnSpectra& Own(Spectra& spectra) const {
    auto* own = dynamic_cast<OwnSpectra*>(&spectra);
    if (own == nullptr || own->owner() != this) {
      throw std::invalid_argument("phase correlation: spectra of another operator");
    }
    return *own;
  }

  // Leaves the windowed tile in tile_ and returns its coverage.
  float FillTile(const MappedImage<const std::uint8_t>& picture,
                 const WarpCoefficients& from_tile) {
    const int width = tables_.tile_width;
    WeightedSums sums;
    for (int y = 0; y < tables_.tile_height; ++y) {
      float* values = tile_.get() + y * width;
      float* seen = seen_.get() + y * width;
      sampler_.Sample(picture, from_tile, y, width, values, seen);
      WeightedSums row;
      SumRow(values, seen, window_x_.get(), width, &row);
      sums.values += tables_.window_y[y] * row.values;
      sums.seen += tables_.window_y[y] * row.seen;
    }
    const float mean = sums.seen > 0.0F ? sums.values / sums.seen : 0.0F;
    for (int y = 0; y < tables_.tile_height; ++y) {
      WindowRow(tile_.get() + y * width, seen_.get() + y * width, window_x_.get(),
                tables_.window_y[y], mean, width);
    }
    return std::min(sums.seen / tables_.window_sum, 1.0F);
  }

  // The highest sample of the surface in tile_ and what lies about it.
  PeakNeighbourhood FindPeak() {
    const int width = tables_.tile_width;
    const int height = tables_.tile_height;
    const int radius = tables_.peak_radius;
    const float* surface = tile_.get();
    PeakNeighbourhood peak;
    for (int y = 0; y < height; ++y) {
      SummariseRow(surface + y * width, width, &row_summaries_[y]);
      if (row_summaries_[y].highest > row_summaries_[peak.y].highest) peak.y = y;
    }
    const float* row = surface + peak.y * width;
    while (peak.x + 1 < width && row[peak.x] != row_summaries_[peak.y].highest) ++peak.x;

    float* out = neighbourhood_.data();
    for (int dy = -radius; dy <= radius; ++dy) {
      const int y = (peak.y + dy) & (height - 1);
      RowSummary& summary = row_summaries_[y];
      summary.sum_of_squares = 0.0F;
      for (int dx = -radius; dx <= radius; ++dx) {
        *out++ = surface[y * width + ((peak.x + dx) & (width - 1))];
      }
      for (int dx = radius + 1; dx < width - radius; ++dx) {
        const float value = surface[y * width + ((peak.x + dx) & (width - 1))];
        summary.sum_of_squares += value * value;
      }
    }
    double sum_of_squares = 0.0;
    for (const RowSummary& summary : row_summaries_) sum_of_squares += summary.sum_of_squares;
    peak.samples = neighbourhood_;
    peak.mean_square_outside =
        static_cast<float>(sum_of_squares / static_cast<double>(samples_ - neighbourhood_.size()));
    return peak;
  }

  const PhaseCorrelationSettings settings_;
  const PhaseCorrelationTables tables_;
  const int samples_;
  const int bins_;
  FloatBuffer tile_;
  FloatBuffer seen_;
  FloatBuffer spectrum_;
  FloatBuffer window_x_;
  std::vector<RowSummary> row_summaries_;
  std::vector<float> neighbourhood_;
  RowSampler sampler_;
  const std::unique_ptr<FourierTransform> transform_;
};

}  // namespace

std::unique_ptr<PhaseCorrelation> MakePhaseCorrelationCpu(
    const PhaseCorrelationSettings& settings) {
  return std::make_unique<PhaseCorrelationCpu>(settings);
}

}  // namespace windhover
