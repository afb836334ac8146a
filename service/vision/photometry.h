// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "gpu-kernels/image.h"

namespace windhover {

// Photometric registration (thesis 2.2.1): what a reference picture shows where a frame shows a
// grey value. Grey values are 0 to 255; the ways to such a mapping differ in what they must know:
//   FitGainBias (gain_bias_fit.h)  pictures that lie upon each other
//   ResponseMap                    the camera's response and the exposures, no pictures
//   HistogramMap                   pictures of the same ground, registered or not

// reference = gain * frame + bias (eq. 2.1), bias in grey levels.
struct GainBias {
  double gain = 1.0;
  double bias = 0.0;

  double operator()(double frame_value) const { return gain * frame_value + bias; }
};

// The mapping from the reference to the frame. The gain must not be 0.
GainBias Inverse(const GainBias& reference_from_frame);

// The mapping tau of eq. 2.1 as a table: entry u is the reference's grey value where the frame
// shows u; 0 to 255, never falling for a positive gain.
using IntensityMap = std::array<float, 256>;

// Values outside 0 to 255 are clipped.
IntensityMap ToIntensityMap(const GainBias& reference_from_frame);

// tau = f(t1 / t2 * f^-1) for a camera of response f (thesis 2.2.1). `log_exposure` is G = ln f^-1
// of eq. 4.3: the logarithm of the exposure, up to a constant, that gives each grey value.
// `exposure_ratio` is the reference's exposure over the frame's, > 0. Between the table's entries G
// is taken to be linear; what would be darker or brighter than it reaches is clipped. Throws
// std::invalid_argument where the table does not rise strictly or the ratio is not positive and
// finite.
IntensityMap ResponseMap(std::span<const double, 256> log_exposure, double exposure_ratio);

// How many pixels have each grey value.
using GreyHistogram = std::array<std::uint32_t, 256>;

// Of the pixels where `mask`, of the same size, is not 0; of all without one. Throws
// std::invalid_argument where the sizes differ.
GreyHistogram HistogramOf(const GrayImage& picture, const GrayImage* mask = nullptr);

// tau(u) = H1^-1(H2(u)) of the cumulative histograms H1 of the reference and H2 of the frame
// (Grossberg and Nayar; thesis 2.2.1). Both must see the same distribution of ground; the counts
// may differ. Pixels of one grey value are taken to lie at the middle of their ranks, so that equal
// histograms give the identity. Grey values that the frame does not show are interpolated, and
// beyond the ones that it shows the mapping goes on with slope 1, clipped. Never falls. Nothing
// where a histogram is empty.
std::optional<IntensityMap> HistogramMap(const GreyHistogram& reference,
                                         const GreyHistogram& frame);

}  // namespace windhover
