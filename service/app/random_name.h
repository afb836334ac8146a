// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace windhover {

// 16 hexadecimal digits that no other call has got, in any process on any machine. (The number of a
// process is not of that kind: containers that share files or a network have the same ones.)
std::string RandomName();

}  // namespace windhover
