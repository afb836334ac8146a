// SPDX-License-Identifier: Apache-2.0
#include "replay/app/picture_size.h"

#include <charconv>
#include <stdexcept>

namespace windhover::replay {

void ParseSize(const std::string& text, int& width, int& height) {
  const char* end = text.data() + text.size();
  const auto [after_width, width_error] = std::from_chars(text.data(), end, width);
  bool right = width_error == std::errc() && after_width != end && *after_width == 'x';
  if (right) {
    const auto [after_height, height_error] = std::from_chars(after_width + 1, end, height);
    right = height_error == std::errc() && after_height == end;
  }
  if (!right || width < 16 || height < 16 || width > 8192 || height > 8192) {
    throw std::invalid_argument("--size must be WIDTHxHEIGHT, 16 to 8192 px each, not '" + text +
                                "'");
  }
}

}  // namespace windhover::replay
