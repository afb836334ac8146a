// SPDX-License-Identifier: Apache-2.0
#include "replay/readers/mask_boxes.h"

#include <array>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>

#include "replay/format/format_error.h"

namespace windhover::replay {
namespace {

constexpr int kStatic = 0;
constexpr int kShadow = 50;
constexpr int kOutside = 85;
constexpr int kUnknown = 170;
constexpr int kMoving = 255;

void CheckValues(const std::filesystem::path& file, const cv::Mat& mask) {
  std::array<bool, 256> known{};
  for (const int value : {kStatic, kShadow, kOutside, kUnknown, kMoving}) known[value] = true;
  for (int y = 0; y < mask.rows; ++y) {
    const auto* row = mask.ptr<unsigned char>(y);
    for (int x = 0; x < mask.cols; ++x) {
      if (known[row[x]]) continue;
      throw FormatError(file, "has the value " + std::to_string(row[x]) + " at " +
                                  std::to_string(x) + ", " + std::to_string(y) +
                                  "; 0, 50, 85, 170 and 255 mean something");
    }
  }
}

Label MakeLabel(int frame, const cv::Rect& area, double score, const char* category) {
  Label label;
  label.box.frame = frame;
  label.box.box = {static_cast<double>(area.x), static_cast<double>(area.y),
                   static_cast<double>(area.width), static_cast<double>(area.height)};
  label.box.score = score;
  label.category = category;
  return label;
}

// [first, second) along a row.
std::vector<std::pair<int, int>> Runs(const unsigned char* row, int width) {
  std::vector<std::pair<int, int>> runs;
  for (int x = 0; x < width; ++x) {
    if (row[x] != kOutside && row[x] != kUnknown) continue;
    const int start = x;
    while (x < width && (row[x] == kOutside || row[x] == kUnknown)) ++x;
    runs.emplace_back(start, x);
  }
  return runs;
}

// Rectangles that do not overlap and cover 85 and 170: a run that the next row repeats grows down.
std::vector<cv::Rect> CoverUnjudged(const cv::Mat& mask) {
  std::vector<cv::Rect> done;
  std::vector<cv::Rect> open;
  for (int y = 0; y <= mask.rows; ++y) {
    std::vector<std::pair<int, int>> runs;
    if (y < mask.rows) runs = Runs(mask.ptr<unsigned char>(y), mask.cols);
    std::vector<cv::Rect> next;
    std::size_t before = 0;
    for (const auto& [start, end] : runs) {
      while (before < open.size() && open[before].x < start) done.push_back(open[before++]);
      const bool repeats = before < open.size() && open[before].x == start &&
                           open[before].x + open[before].width == end;
      next.push_back(repeats ? open[before++] : cv::Rect(start, y, end - start, 0));
      ++next.back().height;
    }
    done.insert(done.end(), open.begin() + static_cast<std::ptrdiff_t>(before), open.end());
    open = std::move(next);
  }
  return done;
}

}  // namespace

std::vector<Label> BoxesOfMask(const std::filesystem::path& file, const cv::Mat& mask, int frame) {
  CheckValues(file, mask);
  std::vector<Label> labels;
  cv::Mat components;
  cv::Mat statistics;
  cv::Mat centres;
  const int count =
      cv::connectedComponentsWithStats(mask == kMoving, components, statistics, centres, 8, CV_32S);
  for (int i = 1; i < count; ++i) {
    const cv::Rect area(
        statistics.at<int>(i, cv::CC_STAT_LEFT), statistics.at<int>(i, cv::CC_STAT_TOP),
        statistics.at<int>(i, cv::CC_STAT_WIDTH), statistics.at<int>(i, cv::CC_STAT_HEIGHT));
    const bool counts = area.width >= kLeastMaskSide && area.height >= kLeastMaskSide;
    labels.push_back(MakeLabel(frame, area, counts ? 1 : 0, "motion"));
  }
  for (const cv::Rect& area : CoverUnjudged(mask)) {
    labels.push_back(MakeLabel(frame, area, 0, "not judged"));
  }
  return labels;
}

}  // namespace windhover::replay
