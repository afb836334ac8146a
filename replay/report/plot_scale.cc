// SPDX-License-Identifier: Apache-2.0
#include "replay/report/plot_scale.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "replay/format/text_lines.h"

namespace windhover::replay {
namespace {

constexpr double kRound[] = {1, 2, 5, 10};
constexpr int kTicks = 5;  // about

// The largest round number that does not exceed `value`, which is positive; the smallest that is no
// less if `up`.
double RoundNumber(double value, bool up) {
  const double decade = std::pow(10, std::floor(std::log10(value)));
  const double digits = value / decade;
  constexpr double kSame = 1e-9;
  if (up) {
    return decade * *std::find_if(std::begin(kRound), std::end(kRound) - 1,
                                  [&](double round) { return round >= digits - kSame; });
  }
  return decade * *(std::upper_bound(std::begin(kRound), std::end(kRound), digits + kSame) - 1);
}

std::string Label(double value) { return NumberText(value, 4); }

}  // namespace

PlotScale::PlotScale(const PlotAxis& axis, const std::vector<double>& values) : log_(axis.log) {
  if (!axis.categories.empty()) {
    low_ = -0.5;
    high_ = static_cast<double>(axis.categories.size()) - 0.5;
    for (std::size_t i = 0; i < axis.categories.size(); ++i) {
      ticks_.push_back({At(static_cast<double>(i)), axis.categories[i]});
    }
    return;
  }
  std::vector<double> shown;
  std::copy_if(values.begin(), values.end(), std::back_inserter(shown),
               [this](double value) { return Shows(value); });
  if (axis.range) shown.insert(shown.end(), axis.range->begin(), axis.range->end());
  if (shown.empty()) shown = {1};
  const auto [least, most] = std::minmax_element(shown.begin(), shown.end());
  low_ = *least;
  high_ = *most;
  log_ ? MakeLogarithmic() : MakeLinear();
}

void PlotScale::MakeLinear() {
  low_ = std::min(low_, 0.0);
  if (!(high_ > low_)) high_ = low_ + 1;
  const double step = RoundNumber((high_ - low_) / kTicks, true);
  low_ = step * std::floor(low_ / step + 1e-9);
  high_ = step * std::ceil(high_ / step - 1e-9);
  const int steps = static_cast<int>(std::lround((high_ - low_) / step));
  for (int i = 0; i <= steps; ++i) {
    const double value = low_ + i * step;
    ticks_.push_back({At(value), Label(std::abs(value) < step / 2 ? 0 : value)});
  }
}

void PlotScale::MakeLogarithmic() {
  low_ = RoundNumber(low_, false);
  high_ = std::max(RoundNumber(high_, true), 2 * low_);
  const bool decades_only = std::log10(high_ / low_) > 3;
  const int last = static_cast<int>(std::floor(std::log10(high_) + 1e-9));
  for (int decade = static_cast<int>(std::floor(std::log10(low_) + 1e-9)); decade <= last;
       ++decade) {
    for (const double round : {1.0, 2.0, 5.0}) {
      const double value = round * std::pow(10, decade);
      if (value < low_ * 0.9999 || value > high_ * 1.0001) continue;
      ticks_.push_back({At(value), decades_only && round != 1 ? "" : Label(value)});
    }
  }
}

double PlotScale::At(double value) const {
  if (log_) return std::log(value / low_) / std::log(high_ / low_);
  return (value - low_) / (high_ - low_);
}

}  // namespace windhover::replay
