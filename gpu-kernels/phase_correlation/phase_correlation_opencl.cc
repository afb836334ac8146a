// SPDX-License-Identifier: Apache-2.0
#include "gpu-kernels/phase_correlation/phase_correlation_opencl.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "gpu-kernels/opencl/kernel.h"
#include "gpu-kernels/opencl/kernel_sources.h"
#include "gpu-kernels/phase_correlation/phase_correlation_tables.h"
#include "gpu-kernels/warp/warp_coefficients.h"

namespace windhover {
namespace {

using opencl::Buffer;
using opencl::Context;
using opencl::GlobalMemory;
using opencl::Kernel;
using opencl::LocalMemory;
using opencl::Program;
using opencl::Queue;

std::unique_ptr<Buffer> MakeFloats(const Context& context, std::size_t count) {
  return context.Allocate(count * sizeof(float));
}

template <typename T>
std::unique_ptr<Buffer> MakeTable(const Context& context, Queue& queue,
                                  const std::vector<T>& values) {
  auto buffer = context.Allocate(values.size() * sizeof(T));
  queue.EnqueueWrite(*buffer, values.data(), values.size() * sizeof(T));
  queue.Finish();
  return buffer;
}

// exp(-2 pi i k / side), real and imaginary part in turn.
std::vector<float> Twiddles(int side) {
  std::vector<float> values;
  for (int k = 0; k < side; ++k) {
    const double angle = -2.0 * std::numbers::pi * k / side;
    values.push_back(static_cast<float>(std::cos(angle)));
    values.push_back(static_cast<float>(std::sin(angle)));
  }
  return values;
}

// Where TransformLanes leaves each frequency: a split of a block by `radix` takes frequency
// radix * q + m to place q of sub-block m.
std::vector<cl_int> FrequencyOrder(int side) {
  std::vector<cl_int> order;
  for (int k = 0; k < side; ++k) {
    int place = 0;
    int rest = k;
    for (int block = side; block > 1;) {
      const int radix = block == 16 || block == 4 ? 4 : 8;
      block /= radix;
      place += rest % radix * block;
      rest /= radix;
    }
    order.push_back(place);
  }
  return order;
}

// The weights of the whole spectrum from those of its left half.
std::vector<float> FullSpectralWeight(const PhaseCorrelationTables& tables) {
  std::vector<float> full;
  for (int y = 0; y < tables.tile_height; ++y) {
    for (int x = 0; x < tables.tile_width; ++x) {
      const int bin = std::min(x, tables.tile_width - x);
      full.push_back(tables.spectral_weight[y * tables.spectrum_width + bin]);
    }
  }
  return full;
}

std::string Define(const char* name, int value) {
  return std::string("-D") + name + "=" + std::to_string(value) + " ";
}

class PhaseCorrelationOpenCl;

class TileSpectraOpenCl : public TileSpectra {
 public:
  TileSpectraOpenCl(const PhaseCorrelationOpenCl* owner, std::size_t tiles,
                    std::unique_ptr<Buffer> spectra_memory, std::unique_ptr<Buffer> coverage_memory)
      : owner(owner),
        spectra(std::move(spectra_memory)),
        coverage(std::move(coverage_memory)),
        shifts(tiles) {}

  const PhaseCorrelationOpenCl* const owner;
  const std::unique_ptr<Buffer> spectra;
  const std::unique_ptr<Buffer> coverage;
  std::vector<TileShift> shifts;
};

class PhaseCorrelationOpenCl : public PhaseCorrelation {
 public:
  PhaseCorrelationOpenCl(Context& context, const PhaseCorrelationSettings& settings,
                         const PhaseCorrelationLayout& layout)
      : settings_(settings),
        tables_(settings),
        layout_(layout),
        context_(context.shared_from_this()),
        pairs_((settings.tiles.size() + 1) / 2),
        samples_(static_cast<std::size_t>(tables_.tile_width) * tables_.tile_height),
        peak_group_(std::min(layout.peak_group, tables_.tile_height)),
        record_floats_(5 + PeakSide() * PeakSide()),
        queue_(context),
        window_x_(MakeTable(context, queue_, tables_.window_x)),
        window_y_(MakeTable(context, queue_, tables_.window_y)),
        spectral_weight_(MakeTable(context, queue_, FullSpectralWeight(tables_))),
        twiddle_x_(MakeTable(context, queue_, Twiddles(tables_.tile_width))),
        twiddle_y_(MakeTable(context, queue_, Twiddles(tables_.tile_height))),
        order_x_(MakeTable(context, queue_, FrequencyOrder(tables_.tile_width))),
        order_y_(MakeTable(context, queue_, FrequencyOrder(tables_.tile_height))),
        from_tile_(MakeFloats(context, 9 * settings.tiles.size())),
        row_sums_(MakeFloats(context, 2 * pairs_ * 2 * tables_.tile_height)),
        tiles_(MakeFloats(context, pairs_ * 2 * samples_)),
        columns_(MakeFloats(context, pairs_ * 2 * samples_)),
        records_(MakeFloats(context, settings.tiles.size() * record_floats_)),
        host_from_tile_(9 * settings.tiles.size()),
        host_records_(settings.tiles.size() * record_floats_),
        kernels_(MakeKernels()) {}

  const PhaseCorrelationSettings& settings() const override { return settings_; }

  std::unique_ptr<TileSpectra> MakeSpectra() const override {
    auto spectra = std::make_unique<TileSpectraOpenCl>(this, settings_.tiles.size(),
                                                       MakeFloats(*context_, pairs_ * 2 * samples_),
                                                       MakeFloats(*context_, 2 * pairs_));
    const auto clear = [](Buffer& buffer) {
      std::byte* bytes = buffer.Map(Access::kWrite);
      std::fill_n(bytes, buffer.size_bytes(), std::byte{0});
      buffer.Unmap(bytes);
    };
    clear(*spectra->spectra);
    clear(*spectra->coverage);
    return spectra;
  }

  void Transform(const GrayImage& picture, const Matrix3& picture_from_grid,
                 TileSpectra& spectra) override {
    auto& own = Own<TileSpectraOpenCl>(spectra);
    if (picture.empty()) throw std::invalid_argument("phase correlation: the picture is empty");
    MakeWarpCoefficients(picture_from_grid);  // refuses what is not finite
    for (std::size_t i = 0; i < settings_.tiles.size(); ++i) {
      const TileSampling sampling = SampleTileAt(picture_from_grid, settings_.tiles[i],
                                                 tables_.tile_width, tables_.tile_height);
      std::copy(sampling.picture_from_tile.begin(), sampling.picture_from_tile.end(),
                host_from_tile_.begin() + 9 * i);
      own.shifts[i] = sampling.shift;
    }
    queue_.EnqueueWrite(*from_tile_, host_from_tile_.data(),
                        host_from_tile_.size() * sizeof(float));
    kernels_.sample.Enqueue(queue_, SizeOf(tables_.tile_height / layout_.sample_rows, 2 * pairs_),
                            picture, picture.width(), picture.height(),
                            static_cast<cl_int>(picture.stride()), *from_tile_,
                            static_cast<cl_int>(settings_.tiles.size()), tables_.tile_width,
                            tables_.tile_height, *window_x_, *window_y_, *tiles_, *row_sums_);
    kernels_.transform_samples.Enqueue(
        queue_, ColumnsOf(tables_.tile_width), *tiles_, *row_sums_, tables_.tile_width, *window_x_,
        *window_y_, tables_.window_sum, *twiddle_y_, *order_y_, *own.coverage, *columns_);
    kernels_.transform_columns.Enqueue(queue_, ColumnsOf(tables_.tile_height), *columns_,
                                       tables_.tile_height, *twiddle_x_, *order_x_, *own.spectra);
    queue_.Finish();
  }

  void Correlate(const TileSpectra& reference, const TileSpectra& current,
                 std::span<TilePeak> peaks) override {
    const auto& own_reference = Own<const TileSpectraOpenCl>(reference);
    const auto& own_current = Own<const TileSpectraOpenCl>(current);
    if (peaks.size() != settings_.tiles.size()) {
      throw std::invalid_argument("phase correlation: there must be one peak a tile");
    }
    kernels_.transform_cross_power.Enqueue(
        queue_, ColumnsOf(tables_.tile_width), *own_reference.spectra, *own_current.spectra,
        tables_.tile_width, *spectral_weight_, tables_.damping, *twiddle_y_, *order_y_, *columns_);
    kernels_.transform_columns.Enqueue(queue_, ColumnsOf(tables_.tile_height), *columns_,
                                       tables_.tile_height, *twiddle_x_, *order_x_, *tiles_);
    const std::size_t group = peak_group_;
    kernels_.find_peak.Enqueue(
        queue_, {.global = {group * peaks.size(), 1, 1}, .local = {group, 1, 1}}, *tiles_,
        tables_.tile_width, tables_.tile_height, tables_.peak_radius, *own_reference.coverage,
        *own_current.coverage, *records_, LocalMemory{tables_.tile_height * sizeof(float)},
        LocalMemory{group * sizeof(float)}, LocalMemory{group * sizeof(cl_int)});
    queue_.Read(*records_, host_records_.data(), host_records_.size() * sizeof(float));
    for (std::size_t i = 0; i < peaks.size(); ++i) {
      peaks[i] =
          PeakFromRecord(std::span(host_records_).subspan(i * record_floats_, record_floats_));
      peaks[i].dx += own_current.shifts[i].dx - own_reference.shifts[i].dx;
      peaks[i].dy += own_current.shifts[i].dy - own_reference.shifts[i].dy;
    }
  }

 private:
  struct Kernels {
    Kernel<GlobalMemory, cl_int, cl_int, cl_int, GlobalMemory, cl_int, cl_int, cl_int, GlobalMemory,
           GlobalMemory, GlobalMemory, GlobalMemory>
        sample;
    Kernel<GlobalMemory, GlobalMemory, cl_int, GlobalMemory, GlobalMemory, cl_float, GlobalMemory,
           GlobalMemory, GlobalMemory, GlobalMemory>
        transform_samples;
    Kernel<GlobalMemory, GlobalMemory, cl_int, GlobalMemory, cl_float, GlobalMemory, GlobalMemory,
           GlobalMemory>
        transform_cross_power;
    Kernel<GlobalMemory, cl_int, GlobalMemory, GlobalMemory, GlobalMemory> transform_columns;
    Kernel<GlobalMemory, cl_int, cl_int, cl_int, GlobalMemory, GlobalMemory, GlobalMemory,
           LocalMemory, LocalMemory, LocalMemory>
        find_peak;
  };

  int PeakSide() const { return 2 * tables_.peak_radius + 1; }

  Program CompileTileProgram() {
    return context_->Compile(std::string(kLanesCl) + std::string(kBilinearCl) +
                                 std::string(kSampleTilesCl) + std::string(kFindPeakCl),
                             Define("V", layout_.lanes) + Define("ROWS", layout_.sample_rows) +
                                 Define("BATCH", std::max(layout_.sample_batch, layout_.lanes)) +
                                 Define("GROUP", peak_group_) + "-cl-mad-enable");
  }

  // One program a side, so that tiles of all shapes share them.
  Program CompileTransform(int side) {
    return context_->Compile(std::string(kLanesCl) + std::string(kTransformCl),
                             Define("V", layout_.lanes) + Define("N", side) + "-cl-mad-enable");
  }

  Kernels MakeKernels() {
    const Program tiles = CompileTileProgram();
    const Program columns = CompileTransform(tables_.tile_height);
    const Program rows = CompileTransform(tables_.tile_width);
    return {{tiles, "SampleTiles"},
            {columns, "TransformSamples"},
            {columns, "TransformCrossPower"},
            {rows, "TransformColumns"},
            {tiles, "FindPeak"}};
  }

  // `items` work-items a row of groups, `rows` of them.
  opencl::WorkSize SizeOf(int items, std::size_t rows) const {
    const auto row = static_cast<std::size_t>(items);
    return {.global = {row, rows, 1},
            .local = {std::min<std::size_t>(layout_.work_group, row), 1, 1}};
  }

  // One work-item for `lanes` of the columns, for all pairs of tiles.
  opencl::WorkSize ColumnsOf(int columns) const { return SizeOf(columns / layout_.lanes, pairs_); }

  template <typename OwnSpectra, typename Spectra>
  OwnSpectra& Own(Spectra& spectra) const {
    auto* own = dynamic_cast<OwnSpectra*>(&spectra);
    if (own == nullptr || own->owner != this) {
      throw std::invalid_argument("phase correlation: spectra of another operator");
    }
    return *own;
  }

  // The record's layout is that of find_peak.cl.
  TilePeak PeakFromRecord(std::span<const float> record) const {
    PeakNeighbourhood peak;
    peak.x = static_cast<int>(record[0]);
    peak.y = static_cast<int>(record[1]);
    peak.mean_square_outside = record[2];
    peak.samples = record.subspan(5);
    return MeasurePeak(tables_, peak, record[3], record[4]);
  }

  const PhaseCorrelationSettings settings_;
  const PhaseCorrelationTables tables_;
  const PhaseCorrelationLayout layout_;
  const std::shared_ptr<Context> context_;
  const std::size_t pairs_;
  const std::size_t samples_;
  const int peak_group_;
  const std::size_t record_floats_;
  Queue queue_;
  const std::unique_ptr<Buffer> window_x_;
  const std::unique_ptr<Buffer> window_y_;
  const std::unique_ptr<Buffer> spectral_weight_;
  const std::unique_ptr<Buffer> twiddle_x_;
  const std::unique_ptr<Buffer> twiddle_y_;
  const std::unique_ptr<Buffer> order_x_;
  const std::unique_ptr<Buffer> order_y_;
  const std::unique_ptr<Buffer> from_tile_;
  const std::unique_ptr<Buffer> row_sums_;
  const std::unique_ptr<Buffer> tiles_;    // samples of the tiles, or their correlation surfaces
  const std::unique_ptr<Buffer> columns_;  // what the first step of a transform leaves
  const std::unique_ptr<Buffer> records_;
  std::vector<float> host_from_tile_;
  std::vector<float> host_records_;
  Kernels kernels_;
};

}  // namespace

PhaseCorrelationLayout PhaseCorrelationLayout::For(const Context& context) {
  if (!context.is_cpu()) return {};
  return {.lanes = context.float_lanes(),
          .sample_rows = 8,
          .sample_batch = 64,
          .work_group = 1,
          .peak_group = 1};
}

std::unique_ptr<PhaseCorrelation> MakePhaseCorrelationOpenCl(
    Context& context, const PhaseCorrelationSettings& settings,
    const PhaseCorrelationLayout& layout) {
  return std::make_unique<PhaseCorrelationOpenCl>(context, settings, layout);
}

}  // namespace windhover
