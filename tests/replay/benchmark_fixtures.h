// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "replay/benchmarks/benchmark_progress.h"
#include "replay/benchmarks/figures.h"

namespace windhover::replay {

inline const BenchmarkProgress kSilent = {[](const std::string&) {}, [] {}};

// The figure, table or plot of that name.
template <typename T>
std::optional<T> Named(const std::vector<T>& all, const std::string& name) {
  for (const T& one : all) {
    if (one.name == name) return one;
  }
  return std::nullopt;
}

inline std::optional<double> ValueOf(const std::vector<Figure>& figures, const std::string& name) {
  const std::optional<Figure> figure = Named(figures, name);
  if (!figure) return std::nullopt;
  return figure->value;
}

// A ground of blobs at many scales.
inline cv::Mat Ground(std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat sum = cv::Mat::zeros(480, 640, CV_32F);
  for (int cell = 64; cell >= 2; cell /= 2) {
    cv::Mat coarse(480 / cell + 2, 640 / cell + 2, CV_32F);
    random.fill(coarse, cv::RNG::UNIFORM, -1, 1);
    cv::Mat fine;
    cv::resize(coarse, fine, {640, 480}, 0, 0, cv::INTER_CUBIC);
    sum += 12 * fine;
  }
  cv::Mat picture;
  sum.convertTo(picture, CV_8U, 1, 110);
  return picture;
}

}  // namespace windhover::replay
