// SPDX-License-Identifier: Apache-2.0
// Agreement of the phase correlation's twins, for all layouts of the OpenCL kernels.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "gpu-kernels/opencl/context.h"
#include "gpu-kernels/phase_correlation/phase_correlation_opencl.h"
#include "tests/gpu-kernels/phase_correlation_scene.h"

namespace windhover {
namespace {

// What the twins may differ by: offsets by half of what the contract allows; heights and noise by
// what samples that fall within rounding of the picture's border may make. Valid flags are compared
// but where a value lies at its threshold.
void ExpectTwins(const TilePeak& a, const TilePeak& b, const std::string& what) {
  SCOPED_TRACE(what);
  EXPECT_NEAR(a.coverage, b.coverage, 1e-3);
  EXPECT_NEAR(a.height, b.height, 1e-4 + 0.02 * std::abs(a.height));
  EXPECT_NEAR(a.noise, b.noise, 1e-4 + 0.05 * a.noise);
  const bool at_threshold = std::abs(a.height - 10.0F * a.noise) < 0.05F * a.height ||
                            std::abs(a.coverage - 0.25F) < 1e-3F;
  if (!at_threshold) {
    EXPECT_EQ(a.valid, b.valid);
  }
  if (!a.valid || !b.valid) return;
  EXPECT_NEAR(a.dx, b.dx, 0.01);
  EXPECT_NEAR(a.dy, b.dy, 0.01);
  const float scale = std::max(a.covariance_xx, a.covariance_yy);
  EXPECT_NEAR(a.covariance_xx, b.covariance_xx, 0.05 * scale);
  EXPECT_NEAR(a.covariance_xy, b.covariance_xy, 0.05 * scale);
  EXPECT_NEAR(a.covariance_yy, b.covariance_yy, 0.05 * scale);
}

// The twins on the same pictures, for an OpenCL layout and tile sides.
struct TwinCase {
  std::string name;
  PhaseCorrelationLayout layout;
  std::vector<PictureSize> sides;
};

void PrintTo(const TwinCase& twin_case, std::ostream* out) { *out << twin_case.name; }

class PhaseCorrelationTwinTest : public testing::TestWithParam<TwinCase> {};

TEST_P(PhaseCorrelationTwinTest, TwinsAgree) {
  const std::vector<opencl::Device> devices = opencl::ListDevices();
  ASSERT_FALSE(devices.empty()) << "this test needs an OpenCL device";
  const auto context = std::make_shared<opencl::Context>(
      devices.front(), opencl::ProgramCache(opencl::ProgramCache::DefaultFolder()));
  const auto cpu = BackendNamed("CpuTwin");
  const auto fill = [](GrayImage image, const Picture& picture) {
    const auto mapped = image.Write();
    for (int y = 0; y < picture.height; ++y) {
      std::copy_n(&picture.pixels[y * picture.width], picture.width, mapped.row(y));
    }
    return image;
  };
  const auto on_cpu = [&](const Picture& picture) {
    return fill(cpu->MakeImage<std::uint8_t>(picture.width, picture.height), picture);
  };
  const auto on_device = [&](const Picture& picture) {
    const int stride = (picture.width + 63) / 64 * 64;
    return fill(GrayImage(context->Allocate(stride * picture.height), picture.width, picture.height,
                          stride),
                picture);
  };
  const std::vector<Pair> pairs = AllPairs();
  for (const PictureSize side : GetParam().sides) {
    PhaseCorrelationSettings settings =
        Settings(side.width, side.height, SomeTiles(side.width, side.height));
    for (const float peak_sigma : {0.8F, 0.0F}) {
      settings.peak_sigma_px = peak_sigma;
      const auto cpu_twin = cpu->MakePhaseCorrelation(settings);
      const auto open_cl = MakePhaseCorrelationOpenCl(*context, settings, GetParam().layout);
      for (const Pair& pair : pairs) {
        if (!pair.well_conditioned) continue;
        const auto expected = Correlate(*cpu_twin, pair, on_cpu);
        const auto actual = Correlate(*open_cl, pair, on_device);
        for (std::size_t i = 0; i < expected.size(); ++i) {
          ExpectTwins(expected[i], actual[i],
                      pair.name + ", " + std::to_string(side.width) + "x" +
                          std::to_string(side.height) + ", tile " + std::to_string(i) + ", sigma " +
                          std::to_string(peak_sigma));
        }
      }
    }
  }
}

// As on CPUs with vectors of 16, 8 and 4, and as on GPUs.
INSTANTIATE_TEST_SUITE_P(
    Layouts, PhaseCorrelationTwinTest,
    testing::Values(
        TwinCase{
            "Lanes16Small",
            {.lanes = 16, .sample_rows = 8, .sample_batch = 64, .work_group = 1, .peak_group = 1},
            {{16, 16}, {32, 64}, {64, 32}}},
        TwinCase{
            "Lanes16Large",
            {.lanes = 16, .sample_rows = 8, .sample_batch = 64, .work_group = 1, .peak_group = 1},
            {{128, 128}, {256, 128}, {128, 256}, {512, 16}}},
        TwinCase{
            "Lanes8",
            {.lanes = 8, .sample_rows = 8, .sample_batch = 64, .work_group = 1, .peak_group = 1},
            {{64, 64}, {32, 64}}},
        TwinCase{
            "Lanes4",
            {.lanes = 4, .sample_rows = 16, .sample_batch = 16, .work_group = 4, .peak_group = 2},
            {{32, 32}, {32, 64}}},
        TwinCase{
            "Lanes2",
            {.lanes = 2, .sample_rows = 1, .sample_batch = 2, .work_group = 16, .peak_group = 32},
            {{32, 32}, {64, 32}}},
        TwinCase{"Lanes1", {}, {{64, 64}, {32, 64}}}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace windhover
