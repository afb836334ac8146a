// SPDX-License-Identifier: Apache-2.0
#include "replay/baselines/object_extraction.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace windhover::replay {
namespace {

// MotionOptions::dilation_px: -1 takes 1 px for each so many rows.
constexpr int kRowsPerDilation = 400;

cv::Mat Square(int radius) {
  return cv::getStructuringElement(cv::MORPH_RECT, {2 * radius + 1, 2 * radius + 1});
}

// The box and area of the pixels of `map` under each label but 0, which is the background.
std::vector<MovingObject> Measure(const cv::Mat& map, const cv::Mat& labels, int count) {
  struct Extent {
    int left;
    int top;
    int right = -1;
    int bottom = -1;
    int area = 0;
  };
  std::vector<Extent> extents(count, {map.cols, map.rows});
  for (int y = 0; y < map.rows; ++y) {
    const auto* set = map.ptr<std::uint8_t>(y);
    const int* label = labels.ptr<int>(y);
    for (int x = 0; x < map.cols; ++x) {
      if (set[x] == 0) continue;
      Extent& extent = extents[label[x]];
      extent.left = std::min(extent.left, x);
      extent.top = std::min(extent.top, y);
      extent.right = std::max(extent.right, x);
      extent.bottom = std::max(extent.bottom, y);
      ++extent.area;
    }
  }
  std::vector<MovingObject> objects;
  for (int i = 1; i < count; ++i) {
    const Extent& extent = extents[i];
    if (extent.area == 0) continue;
    objects.push_back({{static_cast<double>(extent.left), static_cast<double>(extent.top),
                        extent.right - extent.left + 1.0, extent.bottom - extent.top + 1.0},
                       extent.area});
  }
  return objects;
}

}  // namespace

std::vector<MovingObject> ExtractObjects(const cv::Mat& map, const MotionOptions& options) {
  cv::Mat kept = map;
  if (options.erosion_px > 0) {
    // Outside the picture nothing differs.
    cv::erode(map, kept, Square(options.erosion_px), {-1, -1}, 1, cv::BORDER_CONSTANT, 0);
  }
  const int dilation =
      options.dilation_px >= 0 ? options.dilation_px : std::max(1, map.rows / kRowsPerDilation);
  cv::Mat grown;
  cv::dilate(kept, grown, Square(dilation));
  cv::Mat labels;
  const int count = cv::connectedComponents(grown, labels, 8, CV_32S);
  std::vector<MovingObject> objects = Measure(map, labels, count);
  const double largest = options.max_size * std::min(map.cols, map.rows);
  std::erase_if(objects, [&](const MovingObject& object) {
    return object.area_px < options.min_area_px ||
           std::max(object.box.width, object.box.height) > largest;
  });
  return objects;
}

}  // namespace windhover::replay
