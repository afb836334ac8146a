// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "replay/readers/recording.h"

namespace windhover::replay {

// One object's box in each line: left, top, width, height; line i is of frame i. NaN in all
// columns, or 0 as width and height: it is not in the picture. Pixels are taken to count from 0, as
// the tracking toolkits that read these files do. Throws FormatError for the first malformed line,
// and for a blank one, which would shift all that follow.
std::vector<std::optional<Box>> ReadTargetBoxes(const std::filesystem::path& file);

// Makes them the recording's labels, of id 1. Throws FormatError where they are not as many as its
// frames, if that is certain.
void UseTargetBoxes(Recording& recording, const std::filesystem::path& file,
                    const std::vector<std::optional<Box>>& boxes);

}  // namespace windhover::replay
