// SPDX-License-Identifier: Apache-2.0
#include "replay/format/media_files.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <string>
#include <string_view>

#include "replay/format/format_error.h"

namespace windhover::replay {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 6> kPictures = {".jpg", ".jpeg", ".png",
                                                       ".bmp", ".tif",  ".tiff"};
constexpr std::array<std::string_view, 11> kVideos = {
    ".mp4", ".avi", ".mkv", ".mov", ".m4v", ".mpg", ".mpeg", ".mjpeg", ".ts", ".webm", ".wmv"};
// More digits than any frame number has, and still an int.
constexpr std::size_t kMostDigits = 9;

template <typename Endings>
bool EndsInOneOf(const fs::path& file, const Endings& endings) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

}  // namespace

bool IsPicture(const fs::path& file) { return EndsInOneOf(file, kPictures); }

bool IsVideo(const fs::path& file) { return EndsInOneOf(file, kVideos); }

std::vector<fs::path> ListVideos(const fs::path& folder) {
  std::vector<fs::path> videos;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && IsVideo(entry.path())) videos.push_back(entry.path());
  }
  std::sort(videos.begin(), videos.end());
  return videos;
}

NumberedPictures ListNumberedPictures(const fs::path& folder) {
  std::map<int, fs::path> numbered;
  std::string prefix;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (!IsPicture(entry.path()) || !entry.is_regular_file()) continue;
    const std::string stem = entry.path().stem().string();
    const std::size_t before = stem.find_last_not_of("0123456789");
    const std::size_t start = before == std::string::npos ? 0 : before + 1;
    const std::size_t digits = stem.size() - start;
    if (digits == 0 || digits > kMostDigits) continue;
    if (numbered.empty()) prefix = stem.substr(0, start);
    if (prefix != stem.substr(0, start)) {
      throw FormatError(folder, "holds pictures of several kinds: '" + prefix + "...' and '" +
                                    stem.substr(0, start) + "...'");
    }
    const auto [place, is_new] = numbered.emplace(std::stoi(stem.substr(start)), entry.path());
    if (!is_new) {
      throw FormatError(entry.path(),
                        "has the same number as " + place->second.filename().string());
    }
  }
  NumberedPictures pictures;
  for (const auto& [number, file] : numbered) {
    if (pictures.files.empty()) pictures.first_number = number;
    const int expected = pictures.first_number + static_cast<int>(pictures.files.size());
    if (number != expected) {
      throw FormatError(folder, "picture " + std::to_string(expected) + " is missing before " +
                                    file.filename().string());
    }
    pictures.files.push_back(file);
  }
  return pictures;
}

}  // namespace windhover::replay
