// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

namespace windhover::replay {

// By the ending of the name, in any case: jpg, jpeg, png, bmp, tif, tiff.
bool IsPicture(const std::filesystem::path& file);
// By the ending of the name, in any case: mp4, avi, mkv, mov, m4v, mpg, mpeg, mjpeg, ts, webm, wmv.
bool IsVideo(const std::filesystem::path& file);

// The videos in a folder, by name.
std::vector<std::filesystem::path> ListVideos(const std::filesystem::path& folder);

// The pictures in a folder whose names are numbered ("000001.jpg", "img000001.jpg",
// "frame0001.png"), in the order of the numbers, which may start anywhere. Pictures without a
// number are left out. Throws FormatError where a number in between is missing or comes twice, and
// where names differ in what stands before the number.
struct NumberedPictures {
  std::vector<std::filesystem::path> files;
  int first_number = 0;
};
NumberedPictures ListNumberedPictures(const std::filesystem::path& folder);

}  // namespace windhover::replay
