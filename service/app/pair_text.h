// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "service/vision/types.h"

namespace windhover {

// Two pictures of one size and how they lie over each other. In `registration` picture a is the
// frame and picture b the one before it: previous_from_frame is b_from_a.
struct PicturePair {
  std::string a;  // names of the files
  std::string b;
  int width = 0;
  int height = 0;
  FrameRegistration registration;
};

// Several lines for people; without the homography where registration is lost.
std::string TextOf(const PicturePair& pair);
// One JSON object in one line, as README.md describes it.
std::string JsonOf(const PicturePair& pair);

}  // namespace windhover
