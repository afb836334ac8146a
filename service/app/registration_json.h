// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "service/vision/types.h"

namespace windhover {

inline const char* NameOf(RegistrationQuality quality) {
  switch (quality) {
    case RegistrationQuality::kValid:
      return "valid";
    case RegistrationQuality::kDegraded:
      return "degraded";
    case RegistrationQuality::kLost:
      break;
  }
  return "lost";
}

// A list of N * N numbers.
template <int N>
nlohmann::ordered_json RowMajor(const Eigen::Matrix<double, N, N>& matrix) {
  auto numbers = nlohmann::ordered_json::array();
  for (int row = 0; row < N; ++row) {
    for (int column = 0; column < N; ++column) numbers.push_back(matrix(row, column));
  }
  return numbers;
}

}  // namespace windhover
