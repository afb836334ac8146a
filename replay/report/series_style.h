// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

namespace windhover::replay {

// What a series looks like: told apart by shape as well as by colour, and the colours by those who
// see few of them (Okabe and Ito, "Color Universal Design", 2008).
struct SeriesStyle {
  std::string colour;
  int shape = 0;
  bool main = false;    // the product: larger
  bool hollow = false;  // not measured here

  // An SVG element; `size` 1 is that of a point that stands alone.
  std::string Marker(double x, double y, double size) const;
};

// One style for each name, the same wherever the name is met.
class SeriesStyles {
 public:
  const SeriesStyle& For(const std::string& name);

 private:
  std::map<std::string, SeriesStyle> styles_;
  int given_ = 0;
};

}  // namespace windhover::replay
