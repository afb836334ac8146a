// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>

#include "gpu-kernels/backend.h"
#include "service/vision/gain_bias_fit.h"
#include "service/vision/photometry.h"
#include "tests/support/synthetic_ground.h"

namespace windhover {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr int kWidth = 157;
constexpr int kHeight = 121;

GrayImage MakeImage(int width = kWidth, int height = kHeight) {
  static const std::shared_ptr<Backend> backend = Backend::Create("cpu");
  return backend->MakeImage<std::uint8_t>(width, height);
}

template <typename ValueAt>
GrayImage Paint(ValueAt value_at, int width = kWidth, int height = kHeight) {
  GrayImage picture = MakeImage(width, height);
  const auto pixels = picture.Write();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double value = std::round(value_at(x, y));
      pixels.at(x, y) = static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0));
    }
  }
  return picture;
}

// The same ground through `frame_from_scene`, with noise of its own in each picture.
GrayImage Scene(const GainBias& frame_from_scene, double noise_sigma, std::uint32_t seed) {
  static const SyntheticGround ground(7);
  GrayImage picture = MakeImage();
  ground.Render(Eigen::Matrix3d::Identity(), noise_sigma, seed, picture,
                [&](int, int, double value) { return frame_from_scene(value); });
  return picture;
}

bool NeverFalls(const IntensityMap& map) { return std::is_sorted(map.begin(), map.end()); }

TEST(GainBias, IsUndoneByItsInverse) {
  const GainBias q{1.3, -17.0};
  for (const double value : {0.0, 1.0, 100.5, 255.0}) {
    EXPECT_NEAR(Inverse(q)(q(value)), value, 1e-12);
  }
}

TEST(GainBias, BecomesATableThatClips) {
  const IntensityMap map = ToIntensityMap({1.5, -30.0});
  EXPECT_FLOAT_EQ(map[0], 0.0F);
  EXPECT_FLOAT_EQ(map[20], 0.0F);
  EXPECT_FLOAT_EQ(map[101], 121.5F);
  EXPECT_FLOAT_EQ(map[190], 255.0F);
  EXPECT_FLOAT_EQ(map[255], 255.0F);
}

TEST(GainBiasFit, Nominal) {
  for (const GainBias truth :
       {GainBias{1.0, 0.0}, GainBias{0.7, 20.0}, GainBias{1.4, -20.0}, GainBias{1.0, 15.0}}) {
    const auto fit = FitGainBias(Scene({1.0, 0.0}, 0.0, 1), Scene(Inverse(truth), 0.0, 2));
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->reference_from_frame.gain, truth.gain, 0.002);
    EXPECT_NEAR(fit->reference_from_frame.bias, truth.bias, 0.3);
    EXPECT_LT(fit->residual, 0.6);  // rounding to whole grey levels
    EXPECT_GT(fit->agreement, 0.99);
  }
}

// Least squares of one picture on the other would find a gain too small by the noise's share of the
// variance.
TEST(GainBiasFit, NoiseStability) {
  for (const double sigma : {2.0, 5.0, 8.0}) {
    const auto fit = FitGainBias(Scene({1.0, 0.0}, sigma, 1), Scene({1.0, 10.0}, sigma, 2));
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->reference_from_frame.gain, 1.0, 0.01) << sigma;
    EXPECT_NEAR(fit->reference_from_frame(138.0), 128.0, 0.5) << sigma;
    EXPECT_NEAR(fit->residual, sigma, 0.15 * sigma);
  }
}

TEST(GainBiasFit, SwappedPicturesGiveTheInverse) {
  const GrayImage a = Scene({1.0, 0.0}, 5.0, 1);
  const GrayImage b = Scene({0.8, 12.0}, 5.0, 2);
  const auto forth = FitGainBias(a, b);
  const auto back = FitGainBias(b, a);
  ASSERT_TRUE(forth && back);
  EXPECT_NEAR(back->reference_from_frame.gain, Inverse(forth->reference_from_frame).gain, 1e-4);
  EXPECT_NEAR(back->reference_from_frame.bias, Inverse(forth->reference_from_frame).bias, 1e-2);
}

// A third of the frame is something else: noise, one bright thing, or a thing with a texture of its
// own. The ground is in the majority and decides.
TEST(GainBiasFit, WhatIsOnOnePictureOnlyDoesNotCount) {
  const GainBias frame_from_reference{1.2, -20.0};
  const GrayImage reference = Scene({1.0, 0.0}, 2.0, 1);
  const GrayImage plain = Scene(frame_from_reference, 2.0, 2);
  const auto ground = plain.Read();
  std::mt19937 random(3);
  const std::function<double(int, int)> things[] = {
      [&](int, int) { return 1.0 + random() % 254; },
      [](int, int) { return 240.0; },
      [](int x, int y) { return 60.0 + 80.0 * ((x / 5 + y / 7) % 2); },
  };
  for (const auto& thing : things) {
    const GrayImage frame =
        Paint([&](int x, int y) { return x < kWidth / 3 ? thing(x, y) : ground.at(x, y); });
    const auto fit = FitGainBias(reference, frame);
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->reference_from_frame.gain, 1.0 / 1.2, 0.015);
    EXPECT_NEAR(fit->reference_from_frame(128.0), 148.0 / 1.2, 1.0);
    EXPECT_LT(fit->agreement, 0.75);
  }
}

TEST(GainBiasFit, TakesWhatTheMaskShows) {
  const GrayImage reference = Scene({1.0, 0.0}, 2.0, 1);
  const GrayImage left = Scene({1.2, 0.0}, 2.0, 2);
  const GrayImage right = Scene({0.8, 10.0}, 2.0, 3);
  const auto of_left = left.Read();
  const auto of_right = right.Read();
  const GrayImage frame =
      Paint([&](int x, int y) { return x < kWidth / 2 ? of_left.at(x, y) : of_right.at(x, y); });
  const GrayImage on_left = Paint([](int x, int) { return x < kWidth / 2 ? 1 : 0; });
  const GrayImage on_right = Paint([](int x, int) { return x < kWidth / 2 ? 0 : 255; });
  EXPECT_NEAR(FitGainBias(reference, frame, &on_left)->reference_from_frame.gain, 1 / 1.2, 0.01);
  EXPECT_NEAR(FitGainBias(reference, frame, &on_right)->reference_from_frame.gain, 1 / 0.8, 0.01);
}

// Half of the frame is clipped to white or has not been seen: the rest is as good without them.
TEST(GainBiasFit, LeavesOutWhatIsClippedOrUnseen) {
  const GrayImage reference = Scene({1.0, 0.0}, 0.0, 1);
  const GrayImage bright = Scene({2.0, 0.0}, 0.0, 2);
  const auto fit = FitGainBias(reference, bright);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->reference_from_frame.gain, 0.5, 0.005);
  const auto pixels = bright.Read();
  const GrayImage half = Paint([&](int x, int y) { return y < 40 ? 0 : pixels.at(x, y); });
  EXPECT_NEAR(FitGainBias(reference, half)->reference_from_frame.gain, 0.5, 0.005);
}

TEST(GainBiasFit, Degenerate) {
  const GrayImage picture = Scene({1.0, 0.0}, 2.0, 1);
  const GrayImage flat = Paint([](int, int) { return 100; });
  const GrayImage black = Paint([](int, int) { return 0; });
  EXPECT_FALSE(FitGainBias(picture, flat));
  EXPECT_FALSE(FitGainBias(flat, flat));
  EXPECT_FALSE(FitGainBias(picture, black));
  EXPECT_FALSE(FitGainBias(picture, Scene({-1.0, 255.0}, 2.0, 2)));  // a negative
  EXPECT_FALSE(FitGainBias(picture, picture, &black));               // masks all
  const SyntheticGround other(9);
  GrayImage elsewhere = MakeImage();
  other.Render(Eigen::Matrix3d::Identity(), 2.0, 1, elsewhere);
  EXPECT_FALSE(FitGainBias(picture, elsewhere));
  const GrayImage narrow = Paint([](int, int) { return 100; }, kWidth - 1);
  EXPECT_THROW(FitGainBias(picture, narrow), std::invalid_argument);
  EXPECT_THROW(FitGainBias(picture, picture, &narrow), std::invalid_argument);
}

// f(x) = 255 (x / 255)^(1 / gamma), so that ln f^-1 = gamma ln I.
std::array<double, 256> GammaResponse(double gamma) {
  std::array<double, 256> log_exposure;
  for (int value = 0; value < 256; ++value) {
    log_exposure[value] = gamma * std::log(std::max(value, 1) / 255.0) - (value == 0 ? gamma : 0.0);
  }
  return log_exposure;
}

TEST(ResponseMap, FollowsTheCamera) {
  const auto response = GammaResponse(2.2);
  const IntensityMap map = ResponseMap(response, 0.5);
  EXPECT_TRUE(NeverFalls(map));
  for (const int value : {20, 77, 128, 255}) {
    // Between the table's entries the logarithm is not quite linear.
    EXPECT_NEAR(map[value], value * std::pow(0.5, 1 / 2.2), 0.05) << value;
  }
}

TEST(ResponseMap, OfEqualExposuresIsTheIdentity) {
  const IntensityMap map = ResponseMap(GammaResponse(1.8), 1.0);
  for (int value = 0; value < 256; ++value) EXPECT_NEAR(map[value], value, 1e-4);
}

TEST(ResponseMap, ClipsWhatTheReferenceCannotShow) {
  const IntensityMap map = ResponseMap(GammaResponse(1.0), 4.0);
  EXPECT_NEAR(map[30], 120.0, 0.1);
  EXPECT_FLOAT_EQ(map[64], 255.0F);
  EXPECT_FLOAT_EQ(map[255], 255.0F);
  EXPECT_TRUE(NeverFalls(map));
}

TEST(ResponseMap, RefusesWhatIsNoResponse) {
  auto response = GammaResponse(2.2);
  for (const double ratio : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(ResponseMap(response, ratio), std::invalid_argument);
  }
  response[17] = response[16];
  EXPECT_THAT([&] { ResponseMap(response, 1.0); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("grey value 17")));
  response[17] = std::nan("");
  EXPECT_THROW(ResponseMap(response, 1.0), std::invalid_argument);
}

TEST(GreyHistogram, CountsUnderTheMask) {
  const GrayImage picture = Paint([](int x, int y) { return x < 10 ? 7 : y < 20 ? 0 : 255; });
  const GreyHistogram all = HistogramOf(picture);
  EXPECT_EQ(all[7], 10 * kHeight);
  EXPECT_EQ(all[0], 20 * (kWidth - 10));
  EXPECT_EQ(all[255], (kHeight - 20) * (kWidth - 10));
  const GrayImage mask = Paint([](int x, int y) { return x < 12 && y < 3 ? 1 : 0; });
  const GreyHistogram some = HistogramOf(picture, &mask);
  EXPECT_EQ(some[7], 30);
  EXPECT_EQ(some[0], 6);
  EXPECT_EQ(some[255], 0);
  const GrayImage narrow = Paint([](int, int) { return 1; }, kWidth - 1);
  EXPECT_THROW(HistogramOf(picture, &narrow), std::invalid_argument);
}

TEST(HistogramMap, OfEqualHistogramsIsTheIdentity) {
  const GreyHistogram histogram = HistogramOf(Scene({1.0, 0.0}, 0.0, 1));
  const auto map = HistogramMap(histogram, histogram);
  ASSERT_TRUE(map);
  for (int value = 0; value < 256; ++value) EXPECT_NEAR((*map)[value], value, 1e-4);
}

// The frame went through a curve that no gain and bias can undo, and sees the ground mirrored: the
// histograms do not mind.
TEST(HistogramMap, FindsACurveWithoutRegistration) {
  const auto curve = [](double value) { return 255.0 * std::pow(value / 255.0, 0.6); };
  const GrayImage reference = Scene({1.0, 0.0}, 0.0, 1);
  const auto pixels = reference.Read();
  const GrayImage frame = Paint([&](int x, int y) { return curve(pixels.at(kWidth - 1 - x, y)); });
  const auto map = HistogramMap(HistogramOf(reference), HistogramOf(frame));
  ASSERT_TRUE(map);
  EXPECT_TRUE(NeverFalls(*map));
  for (int value = 80; value <= 180; ++value) {
    EXPECT_NEAR((*map)[std::lround(curve(value))], value, 1.0) << value;
  }
}

// Only two grey values occur; what lies between is a straight line, what lies beyond goes on.
TEST(HistogramMap, InterpolatesEmptyBins) {
  GreyHistogram reference{};
  GreyHistogram frame{};
  reference[40] = 300;
  reference[120] = 100;
  frame[100] = 30;  // counts may differ
  frame[200] = 10;
  const auto map = HistogramMap(reference, frame);
  ASSERT_TRUE(map);
  EXPECT_FLOAT_EQ((*map)[100], 40.0F);
  EXPECT_FLOAT_EQ((*map)[150], 80.0F);
  EXPECT_FLOAT_EQ((*map)[200], 120.0F);
  EXPECT_FLOAT_EQ((*map)[90], 30.0F);
  EXPECT_FLOAT_EQ((*map)[0], 0.0F);
  EXPECT_FLOAT_EQ((*map)[255], 175.0F);
  EXPECT_TRUE(NeverFalls(*map));
}

TEST(HistogramMap, Degenerate) {
  GreyHistogram one{};
  one[50] = 4;
  EXPECT_FALSE(HistogramMap(one, {}));
  EXPECT_FALSE(HistogramMap({}, one));
  GreyHistogram other{};
  other[255] = 1;
  const auto map = HistogramMap(other, one);
  ASSERT_TRUE(map);
  EXPECT_FLOAT_EQ((*map)[50], 255.0F);
  EXPECT_TRUE(NeverFalls(*map));
}

}  // namespace
}  // namespace windhover
