// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>

namespace windhover::replay {

// Two pictures cut from one so that it fills both, with fresh sensor noise on each: what
// registration can reach, and whether it knows when it has not.
struct StressPair {
  cv::Mat reference;  // CV_8UC1
  cv::Mat frame;      // of the same size
  // Nothing where the two show different ground.
  std::optional<Eigen::Matrix3d> reference_from_frame;
};

// What is hard about a pair that should register. Limits: a shift of 35 % of the width, 10 degrees,
// 10 % of scale, a gain of 0.7 to 1.4, noise of 8 grey levels (otherwise kStressNoise).
enum class Stress : std::uint8_t { kShift, kRotation, kScale, kGain, kNoise, kCombined };
inline constexpr Stress kStresses[] = {Stress::kShift, Stress::kRotation, Stress::kScale,
                                       Stress::kGain,  Stress::kNoise,    Stress::kCombined};
const char* NameOf(Stress stress);

// Why a pair cannot or hardly register.
enum class Fault : std::uint8_t {
  kCut,       // the frame shows another place
  kBlack,     // the frame shows nothing
  kMirrored,  // the frame is mirrored: alike in all but geometry
  kBeyond,    // turned by 60 to 180 degrees and magnified by 1.6 to 2.5
  kBlurred,   // after a small motion, the frame is blurred by 8 to 15 px
};
inline constexpr Fault kFaults[] = {Fault::kCut, Fault::kBlack, Fault::kMirrored, Fault::kBeyond,
                                    Fault::kBlurred};
const char* NameOf(Fault fault);

// Standard deviation in grey levels of the noise put on every cut.
inline constexpr double kStressNoise = 2.0;

// `share` (0 to 1) is how far each alone goes towards its limit; combined, each is drawn up to its
// limit. The same seed gives the same pair. Nothing where the picture is too small for it.
std::optional<StressPair> CutStressPair(const cv::Mat& picture, cv::Size size, Stress stress,
                                        double share, std::uint64_t seed);

// `other` is a picture of another place; only kCut looks at it.
std::optional<StressPair> CutFaultPair(const cv::Mat& picture, const cv::Mat& other, cv::Size size,
                                       Fault fault, std::uint64_t seed);

// A small motion under this noise: a shift of up to 10 % of the width, 2 degrees, 2 % of scale.
std::optional<StressPair> CutMildPair(const cv::Mat& picture, cv::Size size, double noise_sigma,
                                      std::uint64_t seed);

// One seed from three numbers, each of which changes all of it.
std::uint64_t MixSeed(std::uint64_t a, std::uint64_t b, std::uint64_t c);

}  // namespace windhover::replay
