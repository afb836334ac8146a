// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "gpu-kernels/backend.h"

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

// The backends that every operator is tested on. There is no other way through these tests: where
// OpenCL has no device, the tests of that backend fail.
inline std::shared_ptr<Backend> BackendNamed(const std::string& name) {
  static const std::shared_ptr<Backend> cpu = Backend::Create("cpu");
  if (name == "CpuTwin") return cpu;
  static const std::shared_ptr<Backend> open_cl = [] {
    for (const DeviceInfo& device : Backend::Devices()) {
      if (device.kind != DeviceKind::kCpuTwin) return Backend::Create(device.Selector());
    }
    throw std::runtime_error("there is no OpenCL device to test on");
  }();
  return open_cl;
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
