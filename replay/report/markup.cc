// SPDX-License-Identifier: Apache-2.0
#include "replay/report/markup.h"

#include <cmath>

#include "replay/format/text_lines.h"

namespace windhover::replay {

std::string Escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '\'':
        escaped += "&#39;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string Px(double value) { return NumberText(std::round(value * 100) / 100, 8); }

}  // namespace windhover::replay
