// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "gpu-kernels/backend.h"
#include "service/vision/motion_evidence.h"
#include "service/vision/motion_window.h"

namespace windhover {

// The registered frames of a window over a ground of smooth random texture, on which a test paints
// what it likes, and the seeds that follow from them.
class MotionScene {
 public:
  using Pixels = std::vector<std::uint8_t>;

  MotionScene(int width, int height, std::vector<int> offsets_frames, unsigned seed = 1)
      : width_(width), height_(height), offsets_(std::move(offsets_frames)), random_(seed) {
    ground_ = Texture(width, height, 90, 40);
    frames_.assign(offsets_.size(), ground_);
  }

  static std::vector<int> Offsets(int first, int last) {
    std::vector<int> offsets;
    for (int i = first; i <= last; ++i) offsets.push_back(i);
    return offsets;
  }

  // Random grey values around `mean`, `range` wide, smoothed to a few px.
  Pixels Texture(int width, int height, int mean, int range) {
    Pixels noise(static_cast<std::size_t>(width) * height);
    for (auto& value : noise) value = static_cast<std::uint8_t>(random_() % 256);
    Pixels out(noise.size());
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        int sum = 0;
        int count = 0;
        for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v) {
          for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
            sum += noise[static_cast<std::size_t>(v) * width + u];
            ++count;
          }
        }
        const int value = mean + (sum / count - 128) * range / 64;
        out[static_cast<std::size_t>(y) * width + x] =
            static_cast<std::uint8_t>(std::clamp(value, 1, 255));
      }
    }
    return out;
  }

  int frames() const { return static_cast<int>(offsets_.size()); }
  int offset(int frame) const { return offsets_[frame]; }
  std::mt19937& random() { return random_; }

  void Set(int frame, int x, int y, int value) {
    if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
    frames_[frame][static_cast<std::size_t>(y) * width_ + x] = static_cast<std::uint8_t>(value);
  }
  int Get(int frame, int x, int y) const {
    return frames_[frame][static_cast<std::size_t>(y) * width_ + x];
  }

  // A textured rectangle whose top left corner is at `at_centre` in the centre frame and moves by
  // `velocity` px a frame; drawn at the nearest pixel, and only in frames where `visible(offset)`.
  void AddMover(double x, double y, int width, int height, double vx, double vy, int brightness,
                const std::function<bool(int)>& visible = {}) {
    const Pixels texture = Texture(width, height, brightness, 60);
    for (int f = 0; f < frames(); ++f) {
      if (visible && !visible(offsets_[f])) continue;
      const int left = static_cast<int>(std::lround(x + vx * offsets_[f]));
      const int top = static_cast<int>(std::lround(y + vy * offsets_[f]));
      for (int v = 0; v < height; ++v) {
        for (int u = 0; u < width; ++u) Set(f, left + u, top + v, texture[v * width + u]);
      }
    }
  }

  // Square specks of `side` px at random places, others in each frame.
  void AddSpecks(int per_frame, int side, int brightness) {
    for (int f = 0; f < frames(); ++f) {
      for (int i = 0; i < per_frame; ++i) {
        const int x = static_cast<int>(random_() % width_);
        const int y = static_cast<int>(random_() % height_);
        for (int v = 0; v < side; ++v) {
          for (int u = 0; u < side; ++u) Set(f, x + u, y + v, brightness);
        }
      }
    }
  }

  // Nobody has seen the ground in this rectangle of this frame.
  void Hide(int frame, int x, int y, int width, int height) {
    for (int v = y; v < y + height; ++v) {
      for (int u = x; u < x + width; ++u) Set(frame, u, v, 0);
    }
  }

  // The evidence for the frame with offset 0, the background being the ground.
  MotionEvidence Evidence(int threshold = 20) const {
    MotionEvidence evidence;
    evidence.frame_width = width_;
    evidence.frame_height = height_;
    evidence.background = ToImage(ground_);
    for (int f = 0; f < frames(); ++f) {
      auto seeds = std::make_shared<BitImage>(host_->MakeBitImage(width_, height_));
      const auto words = seeds->words.Write();
      for (int y = 0; y < height_; ++y) {
        std::fill_n(words.row(y), words.width(), 0U);
        for (int x = 0; x < width_; ++x) {
          const int value = Get(f, x, y);
          const int difference = value - ground_[static_cast<std::size_t>(y) * width_ + x];
          if (value != 0 && std::abs(difference) > threshold) {
            words.row(y)[x / 32] |= 1U << (x % 32);
          }
        }
      }
      if (offsets_[f] == 0) evidence.centre = evidence.samples.size();
      evidence.samples.push_back({ToImage(frames_[f]), seeds, offsets_[f]});
    }
    return evidence;
  }

 private:
  std::shared_ptr<const GrayImage> ToImage(const Pixels& pixels) const {
    auto image = std::make_shared<GrayImage>(host_->MakeImage<std::uint8_t>(width_, height_));
    const auto to = image->Write();
    for (int y = 0; y < height_; ++y) {
      std::copy_n(pixels.data() + static_cast<std::ptrdiff_t>(y) * width_, width_, to.row(y));
    }
    return image;
  }

  std::shared_ptr<Backend> host_ = Backend::Create("cpu");
  int width_;
  int height_;
  std::vector<int> offsets_;
  std::mt19937 random_;
  Pixels ground_;
  std::vector<Pixels> frames_;
};

// The evidence as the filters see it; holds the mappings.
class MappedScene {
 public:
  explicit MappedScene(const MotionEvidence& evidence)
      : centre(evidence.centre), ground_(evidence.background->Read()) {
    background = {ground_.data(), ground_.stride(), ground_.width(), ground_.height()};
    for (const MotionEvidence::Sample& sample : evidence.samples) {
      words_.push_back(sample.seeds->words.Read());
      pixels_.push_back(sample.registered->Read());
      window.push_back({{words_.back().data(), words_.back().stride(), sample.seeds->width,
                         sample.seeds->height},
                        {pixels_.back().data(), pixels_.back().stride(), pixels_.back().width(),
                         pixels_.back().height()},
                        sample.offset_frames});
    }
  }

  std::vector<WindowSample> window;
  std::size_t centre;
  GrayView background;

 private:
  MappedImage<const std::uint8_t> ground_;
  std::vector<MappedImage<const std::uint32_t>> words_;
  std::vector<MappedImage<const std::uint8_t>> pixels_;
};

inline int CountBits(const BitView& bits, int left, int top, int width, int height) {
  int count = 0;
  for (int y = top; y < top + height; ++y) {
    for (int x = left; x < left + width; ++x) count += bits.at(x, y) ? 1 : 0;
  }
  return count;
}

}  // namespace windhover
