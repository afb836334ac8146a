// SPDX-License-Identifier: Apache-2.0
// Registers a picture to itself shifted by 5 px and prints where its top left corner lies.
#include <cstdio>
#include <random>

#include "gpu-kernels/backend.h"
#include "service/vision/registration.h"

int main() {
  constexpr int kWidth = 320;
  constexpr int kHeight = 240;
  constexpr int kShift = 5;
  std::mt19937 random(1);
  std::vector<std::uint8_t> scene((kWidth + kShift) * kHeight);
  for (std::uint8_t& grey : scene) grey = static_cast<std::uint8_t>(60 + random() % 120);

  const auto backend = windhover::Backend::Create("cpu");
  windhover::StreamRegistration registration(backend, kWidth, kHeight, {});
  windhover::FrameRegistration found;
  for (const int shift : {0, kShift}) {
    auto frame = backend->MakeImage<std::uint8_t>(kWidth, kHeight);
    {
      const auto pixels = frame.Write();
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          pixels.at(x, y) = scene[y * (kWidth + kShift) + x + shift];
        }
      }
    }
    found = registration.Register(frame);
  }
  std::printf("%.1f %.1f\n", found.previous_from_frame(0, 2), found.previous_from_frame(1, 2));
  return found.quality == windhover::RegistrationQuality::kValid ? 0 : 1;
}
