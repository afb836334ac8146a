// SPDX-License-Identifier: Apache-2.0
#include "service/vision/feature_matching.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/features2d.hpp>
#include <stdexcept>
#include <utility>

namespace windhover {
namespace {

cv::NormTypes NormOf(const PictureFeatures& features) {
  return features.descriptors.type() == CV_8UC1 ? cv::NORM_HAMMING : cv::NORM_L2;
}

void CheckComparable(const PictureFeatures& a, const PictureFeatures& b) {
  if (a.descriptors.type() != b.descriptors.type() || a.descriptors.cols != b.descriptors.cols) {
    throw std::invalid_argument("features of two detectors cannot be matched");
  }
}

// A detector may describe a place twice, with two orientations; as two matches of the same error
// they would count for more than they know.
std::vector<FeatureMatch> OncePerPlace(std::vector<FeatureMatch> matches,
                                       const PictureFeatures& reference,
                                       const PictureFeatures& frame) {
  std::stable_sort(matches.begin(), matches.end(), [](const auto& a, const auto& b) {
    return a.frame != b.frame ? a.frame < b.frame : a.distance < b.distance;
  });
  matches.erase(std::unique(matches.begin(), matches.end(),
                            [](const auto& a, const auto& b) { return a.frame == b.frame; }),
                matches.end());
  const auto place = [&](const FeatureMatch& m) {
    const Eigen::Vector2d& x = reference.x_in_picture[m.reference];
    const Eigen::Vector2d& u = frame.x_in_picture[m.frame];
    return std::array{x.x(), x.y(), u.x(), u.y()};
  };
  std::stable_sort(matches.begin(), matches.end(),
                   [&](const auto& a, const auto& b) { return place(a) < place(b); });
  matches.erase(std::unique(matches.begin(), matches.end(),
                            [&](const auto& a, const auto& b) { return place(a) == place(b); }),
                matches.end());
  return matches;
}

// Finds the points of a picture that lie around a place.
class PointGrid {
 public:
  PointGrid(const PictureFeatures& features, double radius_px)
      : features_(features),
        cell_px_(std::max(radius_px, kLeastCellPx)),
        radius_px_(radius_px),
        columns_(static_cast<int>(features.width / cell_px_) + 1),
        rows_(static_cast<int>(features.height / cell_px_) + 1),
        cells_(static_cast<std::size_t>(columns_) * rows_) {
    for (int i = 0; i < features.size(); ++i) {
      const Eigen::Vector2d& x = features.x_in_picture[i];
      const int column = std::clamp(static_cast<int>(x.x() / cell_px_), 0, columns_ - 1);
      const int row = std::clamp(static_cast<int>(x.y() / cell_px_), 0, rows_ - 1);
      cells_[row * columns_ + column].push_back(i);
    }
  }

  template <typename Visit>
  void Around(const Eigen::Vector2d& x, Visit&& visit) const {
    if (!(x.x() > -cell_px_ && x.y() > -cell_px_ && x.x() < features_.width + cell_px_ &&
          x.y() < features_.height + cell_px_)) {
      return;
    }
    const int column = static_cast<int>(std::floor(x.x() / cell_px_));
    const int row = static_cast<int>(std::floor(x.y() / cell_px_));
    for (int j = std::max(row - 1, 0); j <= std::min(row + 1, rows_ - 1); ++j) {
      for (int i = std::max(column - 1, 0); i <= std::min(column + 1, columns_ - 1); ++i) {
        for (const int index : cells_[j * columns_ + i]) {
          if ((features_.x_in_picture[index] - x).norm() <= radius_px_) visit(index);
        }
      }
    }
  }

 private:
  static constexpr double kLeastCellPx = 8.0;  // smaller ones are empty mostly

  const PictureFeatures& features_;
  double cell_px_;
  double radius_px_;
  int columns_;
  int rows_;
  std::vector<std::vector<int>> cells_;
};

}  // namespace

std::vector<FeatureMatch> MatchByRatio(const PictureFeatures& reference,
                                       const PictureFeatures& frame, double ratio) {
  if (reference.size() == 0 || frame.size() == 0) return {};
  CheckComparable(reference, frame);
  std::vector<std::vector<cv::DMatch>> nearest;
  cv::BFMatcher(NormOf(reference)).knnMatch(reference.descriptors, frame.descriptors, nearest, 2);
  std::vector<FeatureMatch> matches;
  for (const std::vector<cv::DMatch>& two : nearest) {
    if (two.size() < 2 || !(two[0].distance < ratio * two[1].distance)) continue;
    matches.push_back({two[0].queryIdx, two[0].trainIdx, two[0].distance});
  }
  return OncePerPlace(std::move(matches), reference, frame);
}

std::vector<FeatureMatch> MatchGuided(const PictureFeatures& reference,
                                      const PictureFeatures& frame,
                                      const Eigen::Matrix3d& frame_from_reference, double radius_px,
                                      double ratio, double max_distance) {
  if (reference.size() == 0 || frame.size() == 0) return {};
  CheckComparable(reference, frame);
  const PointGrid grid(frame, radius_px);
  const cv::NormTypes norm = NormOf(reference);
  std::vector<FeatureMatch> matches;
  for (int i = 0; i < reference.size(); ++i) {
    const Eigen::Vector3d u = frame_from_reference * reference.x_in_picture[i].homogeneous();
    if (u.z() <= 0.0) continue;
    FeatureMatch best{i, -1, max_distance};
    double second = std::numeric_limits<double>::infinity();
    grid.Around(u.hnormalized(), [&](int candidate) {
      const double distance =
          cv::norm(reference.descriptors.row(i), frame.descriptors.row(candidate), norm);
      if (distance > best.distance) {
        second = std::min(second, distance);
        return;
      }
      if (best.frame >= 0) second = best.distance;
      best = {i, candidate, distance};
    });
    if (best.frame >= 0 && best.distance < ratio * second) matches.push_back(best);
  }
  return OncePerPlace(std::move(matches), reference, frame);
}

}  // namespace windhover
