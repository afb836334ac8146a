// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "service/vision/types.h"

namespace windhover::replay {

struct VocObject {
  std::string name;
  Box box;  // xmin, ymin and the differences to xmax and ymax
  bool occluded = false;
  bool truncated = false;
  bool difficult = false;
};

// One picture's annotation in Pascal VOC's XML (Everingham et al., "The PASCAL Visual Object
// Classes Challenge", development kit): annotation with size (width, height) and any number of
// object (name, bndbox with xmin, ymin, xmax, ymax, and flags that may be missing). Other elements
// are passed over.
struct VocAnnotation {
  int width = 0;   // px; 0: not said
  int height = 0;  // px; 0: not said
  std::vector<VocObject> objects;
};

// Throws FormatError with file and line.
VocAnnotation ReadVoc(const std::filesystem::path& file);

}  // namespace windhover::replay
