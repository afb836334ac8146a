// SPDX-License-Identifier: Apache-2.0
// Times every operator on the CPU twin and on the device that Backend::Create chooses, alone, at
// 640 x 480. Usage: kernels_bench [rounds]

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "gpu-kernels/backend.h"
#include "gpu-kernels/decimate/decimate.h"
#include "gpu-kernels/difference_threshold/difference_threshold.h"
#include "gpu-kernels/phase_correlation/phase_correlation.h"
#include "gpu-kernels/temporal_median/temporal_median.h"
#include "gpu-kernels/warp/warp.h"

namespace windhover {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;
// A small turn and a shift, as between frames of a flight.
constexpr Matrix3 kMotion = {1.0, 0.004, 0.3, -0.004, 1.0, 0.4, 1e-6, 0.0, 1.0};

double ProcessMs() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// Prints median and 99th percentile of the time on the clock, and the mean processor time of all
// threads, which other programs disturb less.
void Time(const char* name, int rounds, const std::function<void()>& run) {
  for (int i = 0; i < 5; ++i) run();
  std::vector<double> times;
  const double process_start = ProcessMs();
  for (int i = 0; i < rounds; ++i) {
    const auto start = std::chrono::steady_clock::now();
    run();
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
    times.push_back(time.count());
  }
  const double process = (ProcessMs() - process_start) / rounds;
  std::sort(times.begin(), times.end());
  std::printf("  %-44s %8.3f %8.3f %8.3f\n", name, times[times.size() / 2],
              times[times.size() * 99 / 100], process);
}

GrayImage Noise(Backend& backend, unsigned seed) {
  GrayImage image = backend.MakeImage<std::uint8_t>(kWidth, kHeight);
  const auto mapped = image.Write();
  std::mt19937 random(seed);
  for (int i = 0; i < mapped.stride() * kHeight; ++i) {
    mapped.data()[i] = static_cast<std::uint8_t>(1 + random() % 255);
  }
  return image;
}

// 6 x 6 tiles that cover the picture.
PhaseCorrelationSettings Tiles(int side) {
  PhaseCorrelationSettings settings;
  settings.tile_width = side;
  settings.tile_height = side;
  for (int i = 0; i < 36; ++i) {
    settings.tiles.push_back({i % 6 * (kWidth - side) / 5, i / 6 * (kHeight - side) / 5});
  }
  return settings;
}

void TimePhaseCorrelation(Backend& backend, int side, int rounds, const GrayImage& image) {
  const auto correlation = backend.MakePhaseCorrelation(Tiles(side));
  const auto reference = correlation->MakeSpectra();
  const auto current = correlation->MakeSpectra();
  std::vector<TilePeak> peaks(36);
  const std::string tiles = ", 36 tiles of " + std::to_string(side) + " px";
  correlation->Transform(image, kIdentity3, *reference);
  Time(("transform" + tiles).c_str(), rounds,
       [&] { correlation->Transform(image, kMotion, *current); });
  Time(("correlate" + tiles).c_str(), rounds,
       [&] { correlation->Correlate(*reference, *current, peaks); });
}

void TimeAll(Backend& backend, int rounds) {
  std::printf("%s: median, 99th percentile, processor time, ms\n",
              backend.device().Describe().c_str());
  std::vector<GrayImage> frames;
  std::vector<const GrayImage*> window;
  for (unsigned i = 0; i < 21; ++i) frames.push_back(Noise(backend, i));
  for (const GrayImage& frame : frames) window.push_back(&frame);
  GrayImage result = Noise(backend, 0);

  for (const int side : {64, 128}) TimePhaseCorrelation(backend, side, rounds, frames[0]);
  const auto warp = backend.MakeWarp();
  Time("warp", rounds, [&] { warp->Run(frames[0], kMotion, result); });
  const auto decimate = backend.MakeDecimate();
  GrayImage half = backend.MakeImage<std::uint8_t>(kWidth / 2, kHeight / 2);
  Time("decimation by 2", rounds, [&] { decimate->Run(frames[0], 2, half); });
  const auto median = backend.MakeTemporalMedian();
  Time("temporal median of 21", rounds, [&] { median->Run(window, 5, result); });
  const auto difference = backend.MakeDifferenceThreshold();
  BitImage seeds = backend.MakeBitImage(kWidth, kHeight);
  Time("difference threshold", rounds,
       [&] { difference->Run(frames[0], result, {.threshold = 20}, seeds); });
  Time("difference threshold with gradient", rounds, [&] {
    difference->Run(frames[0], result, {.threshold = 20, .gradient_gain_px = 0.5F}, seeds);
  });
  Time("mapping for reading", rounds, [&] { frames[0].Read(); });
}

}  // namespace
}  // namespace windhover

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 200;
  const auto twin = windhover::Backend::Create("cpu");
  windhover::TimeAll(*twin, rounds);
  const auto device = windhover::Backend::Create();
  if (device->device().selector != "cpu") windhover::TimeAll(*device, rounds);
  return 0;
}
