// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace windhover::replay {

// For text of HTML and SVG, and for attributes in single quotes, as this folder has them.
std::string Escaped(std::string_view text);

// A length or place in a drawing: two digits after the point at most, in the C locale.
std::string Px(double value);

}  // namespace windhover::replay
