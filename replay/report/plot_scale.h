// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "replay/benchmarks/figures.h"

namespace windhover::replay {

struct PlotTick {
  double at;  // 0 to 1 along the axis
  std::string label;
};

// Where the values of an axis lie along it.
class PlotScale {
 public:
  // Holds `values` and the axis' range. A logarithmic axis cannot show values of 0 and less.
  PlotScale(const PlotAxis& axis, const std::vector<double>& values);

  bool Shows(double value) const { return !log_ || value > 0; }
  // 0 at the axis' start, 1 at its end.
  double At(double value) const;
  // The middles of the categories, or round values, at most about ten.
  const std::vector<PlotTick>& ticks() const { return ticks_; }

 private:
  void MakeLinear();
  void MakeLogarithmic();

  bool log_;
  double low_ = 0;
  double high_ = 1;
  std::vector<PlotTick> ticks_;
};

}  // namespace windhover::replay
