// SPDX-License-Identifier: Apache-2.0
#include "replay/report/series_style.h"

#include <iterator>

#include "replay/report/markup.h"

namespace windhover::replay {
namespace {

constexpr const char* kMainColour = "#0072b2";
constexpr const char* kThesisColour = "#000000";
constexpr const char* kColours[] = {"#d55e00", "#009e73", "#cc79a7", "#e69f00",
                                    "#56b4e9", "#7a5c00", "#777777", "#6a3d9a"};
constexpr int kShapes = 6;

std::string Points(double x, double y, std::initializer_list<std::pair<double, double>> offsets) {
  std::string points;
  for (const auto& [dx, dy] : offsets) points += Px(x + dx) + "," + Px(y + dy) + " ";
  points.pop_back();
  return points;
}

}  // namespace

std::string SeriesStyle::Marker(double x, double y, double size) const {
  const double r = size * (main ? 5.5 : 4.2);
  const bool stroked = shape == 4 || shape == 5;
  const std::string paint = stroked || hollow
                                ? "' fill='none' stroke='" + colour + "' stroke-width='1.8'/>"
                                : "' fill='" + colour + "'/>";
  switch (shape) {
    case 0:
      return "<circle cx='" + Px(x) + "' cy='" + Px(y) + "' r='" + Px(r) + paint;
    case 1:
      return "<rect x='" + Px(x - 0.9 * r) + "' y='" + Px(y - 0.9 * r) + "' width='" + Px(1.8 * r) +
             "' height='" + Px(1.8 * r) + paint;
    case 2:
      return "<polygon points='" +
             Points(x, y, {{0, -1.15 * r}, {1.1 * r, 0.85 * r}, {-1.1 * r, 0.85 * r}}) + paint;
    case 3:
      return "<polygon points='" +
             Points(x, y, {{0, -1.25 * r}, {1.25 * r, 0}, {0, 1.25 * r}, {-1.25 * r, 0}}) + paint;
    case 4:
      return "<path d='M" + Points(x, y, {{-r, -r}, {r, r}}) + "M" +
             Points(x, y, {{-r, r}, {r, -r}}) + paint;
    default:
      return "<path d='M" + Points(x, y, {{-1.2 * r, 0}, {1.2 * r, 0}}) + "M" +
             Points(x, y, {{0, -1.2 * r}, {0, 1.2 * r}}) + paint;
  }
}

const SeriesStyle& SeriesStyles::For(const std::string& name) {
  const auto [found, is_new] = styles_.try_emplace(name);
  SeriesStyle& style = found->second;
  if (!is_new) return style;
  if (name == "windhover") {
    style = {kMainColour, 0, true, false};
  } else if (name.rfind("thesis", 0) == 0) {
    const int shape = name == "thesis" ? 0 : 1;
    style = {kThesisColour, shape, false, true};
  } else {
    style = {kColours[given_ % std::size(kColours)], 1 + given_ % (kShapes - 1), false, false};
    ++given_;
  }
  return style;
}

}  // namespace windhover::replay
