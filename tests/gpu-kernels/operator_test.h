// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "gpu-kernels/backend.h"
#include "gpu-kernels/decimate/decimate_opencl.h"
#include "gpu-kernels/difference_threshold/difference_threshold_opencl.h"
#include "gpu-kernels/opencl/context.h"
#include "gpu-kernels/opencl/device.h"
#include "gpu-kernels/opencl/row_layout.h"
#include "gpu-kernels/phase_correlation/phase_correlation_opencl.h"
#include "gpu-kernels/temporal_median/temporal_median_opencl.h"
#include "gpu-kernels/warp/warp_opencl.h"

namespace windhover {

// A plain picture in host memory, for references written to be read.
struct Picture {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;

  Picture(int w, int h) : width(w), height(h), pixels(static_cast<std::size_t>(w) * h) {}
  std::uint8_t& at(int x, int y) { return pixels[y * width + x]; }
  std::uint8_t at(int x, int y) const { return pixels[y * width + x]; }
  bool Has(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  bool operator==(const Picture&) const = default;
};

struct PictureSize {
  int width;
  int height;
};

// One pixel, less than a vector, off every power of two, a camera's size, wider than a work-group.
inline const std::vector<PictureSize> kOddSizes = {{1, 1},     {7, 3},   {1, 50},   {64, 1},
                                                   {33, 17},   {65, 31}, {128, 64}, {255, 3},
                                                   {641, 479}, {1283, 5}};

inline Picture ConstantPicture(PictureSize size, int grey) {
  Picture picture(size.width, size.height);
  for (auto& pixel : picture.pixels) pixel = static_cast<std::uint8_t>(grey);
  return picture;
}

inline Picture RandomPicture(PictureSize size, unsigned seed, int lowest = 0, int highest = 255) {
  Picture picture(size.width, size.height);
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> grey(lowest, highest);
  for (auto& pixel : picture.pixels) pixel = static_cast<std::uint8_t>(grey(random));
  return picture;
}

// 0 and 255 in random places.
inline Picture ExtremePicture(PictureSize size, unsigned seed) {
  Picture picture = RandomPicture(size, seed, 0, 1);
  for (auto& pixel : picture.pixels) pixel = pixel != 0 ? 255 : 0;
  return picture;
}

// The first OpenCL device there is.
inline opencl::Device OpenClDevice() {
  const std::vector<opencl::Device> devices = opencl::ListDevices();
  if (devices.empty()) throw std::runtime_error("there is no OpenCL device to test on");
  return devices[0];
}

// An OpenCL device with its kernels laid out as for another kind of device.
class LayoutBackend : public Backend {
 public:
  explicit LayoutBackend(const opencl::RowLayout& layout) : layout_(layout) {}

  const DeviceInfo& device() const override { return context_->device(); }
  std::unique_ptr<Memory> Allocate(std::size_t size_bytes) override {
    return context_->Allocate(size_bytes);
  }
  std::unique_ptr<Decimate> MakeDecimate() override {
    return MakeDecimateOpenCl(*context_, layout_);
  }
  std::unique_ptr<DifferenceThreshold> MakeDifferenceThreshold() override {
    return MakeDifferenceThresholdOpenCl(*context_, layout_);
  }
  std::unique_ptr<PhaseCorrelation> MakePhaseCorrelation(
      const PhaseCorrelationSettings& settings) override {
    return MakePhaseCorrelationOpenCl(*context_, settings, {});
  }
  std::unique_ptr<TemporalMedian> MakeTemporalMedian() override {
    return MakeTemporalMedianOpenCl(*context_, layout_);
  }
  std::unique_ptr<Warp> MakeWarp() override { return MakeWarpOpenCl(*context_, layout_); }
  void WarmUp(const std::function<void(const std::string&)>&) override {}

 private:
  const opencl::RowLayout layout_;
  const std::shared_ptr<opencl::Context> context_ =
      std::make_shared<opencl::Context>(OpenClDevice(), opencl::ProgramCache({}));
};

// The backends that every operator is tested on:
//   CpuTwin
//   OpenCl           the first OpenCL device
//   OpenClStandard   that device with vectors of no more than OpenCL's 16 elements
//   OpenClGpu        that device with kernels laid out as for a GPU
// There is no other way through these tests: where OpenCL has no device, they fail.
inline std::shared_ptr<Backend> BackendNamed(const std::string& name) {
  static std::map<std::string, std::shared_ptr<Backend>> backends;
  std::shared_ptr<Backend>& backend = backends[name];
  if (backend) return backend;
  if (name == "CpuTwin") {
    backend = Backend::Create("cpu");
  } else if (name == "OpenCl") {
    backend = Backend::Create(OpenClDevice().info.selector);
  } else if (name == "OpenClStandard") {
    backend = std::make_shared<LayoutBackend>(
        opencl::RowLayout{.byte_lanes = 16, .float_lanes = 4, .whole_rows = true});
  } else {
    backend = std::make_shared<LayoutBackend>(opencl::RowLayout{});
  }
  return backend;
}

class OperatorTest : public testing::TestWithParam<std::string> {
 protected:
  Backend& backend() const { return *backend_; }

  // The picture in an image of the backend, with rows `extra_stride` elements longer than need be
  // and with something in their padding.
  GrayImage Upload(const Picture& picture, int extra_stride = 0) const {
    GrayImage image = Make(picture.width, picture.height, extra_stride);
    const auto mapped = image.Write();
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < image.stride(); ++x) {
        mapped.row(y)[x] = x < picture.width ? picture.at(x, y) : 0xA5;
      }
    }
    return image;
  }

  GrayImage Make(int width, int height, int extra_stride = 0) const {
    const std::ptrdiff_t stride = (width + 63) / 64 * 64 + extra_stride;
    return GrayImage(backend_->Allocate(stride * height), width, height, stride);
  }

  static Picture Download(const GrayImage& image) {
    Picture picture(image.width(), image.height());
    const auto mapped = image.Read();
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < picture.width; ++x) picture.at(x, y) = mapped.at(x, y);
    }
    return picture;
  }

 private:
  std::shared_ptr<Backend> backend_ = BackendNamed(GetParam());
};

inline std::string BackendTestName(const testing::TestParamInfo<std::string>& info) {
  return info.param;
}

#define WINDHOVER_TEST_ON_ALL_BACKENDS(suite) \
  INSTANTIATE_TEST_SUITE_P(Backends, suite, testing::Values("CpuTwin", "OpenCl"), BackendTestName)

// Also for all layouts of the kernels that go through a picture row by row.
#define WINDHOVER_TEST_ON_ALL_LAYOUTS(suite)                                                    \
  INSTANTIATE_TEST_SUITE_P(Backends, suite,                                                     \
                           testing::Values("CpuTwin", "OpenCl", "OpenClStandard", "OpenClGpu"), \
                           BackendTestName)

// The first difference of two pictures, for the message of a failed test.
inline testing::AssertionResult SamePicture(const Picture& actual, const Picture& expected) {
  if (actual.width != expected.width || actual.height != expected.height) {
    return testing::AssertionFailure() << "sizes differ";
  }
  for (int y = 0; y < actual.height; ++y) {
    for (int x = 0; x < actual.width; ++x) {
      if (actual.at(x, y) != expected.at(x, y)) {
        return testing::AssertionFailure()
               << "at (" << x << ", " << y << ") of " << actual.width << "x" << actual.height
               << ": " << int{actual.at(x, y)} << ", expected " << int{expected.at(x, y)};
      }
    }
  }
  return testing::AssertionSuccess();
}

}  // namespace windhover
