// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

namespace windhover {

// Reads any picture file that OpenCV can, as 8-bit grey. 16-bit pictures are shown in their own
// robust range (service/vision/gray_range.h). Throws std::runtime_error, which names the file,
// where there is none or it cannot be read.
cv::Mat ReadGrayPicture(const std::string& path);

// Writes a PNG file, whatever the name's extension. Throws std::runtime_error, which names the
// file.
void WritePng(const std::filesystem::path& path, const cv::Mat& picture);

}  // namespace windhover
