// SPDX-License-Identifier: Apache-2.0
#include "replay/scoring/video_score.h"

#include <Eigen/LU>
#include <deque>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

#include "replay/format/format_error.h"
#include "replay/scoring/registration_score.h"

namespace windhover::replay {
namespace {

template <typename Value>
Summary SummaryOfEach(const std::vector<std::optional<GroundResidual>>& residuals, Value&& value) {
  std::vector<std::optional<double>> values;
  for (const std::optional<GroundResidual>& residual : residuals) {
    values.push_back(residual ? std::optional<double>(value(*residual)) : std::nullopt);
  }
  return SummaryOf(values);
}

void ScoreCycle(const cv::Mat& start, const cv::Mat& end, const Eigen::Matrix3d& start_from_end,
                const PairRegister& register_pair, VideoScore& score) {
  score.across_gap.push_back(MeasureGroundResidual(start, end, start_from_end));
  const std::optional<Eigen::Matrix3d> at_once = register_pair(start, end);
  if (!at_once) {
    ++score.unregistered;
    score.cycles_px.emplace_back();
    return;
  }
  score.cycles_px.push_back(RegistrationRms(start_from_end, *at_once, end.cols, end.rows));
}

}  // namespace

ResidualSummary SummaryOf(const std::vector<std::optional<GroundResidual>>& residuals) {
  ResidualSummary summary;
  summary.warped = SummaryOfEach(residuals, [](const GroundResidual& one) { return one.warped; });
  summary.unwarped =
      SummaryOfEach(residuals, [](const GroundResidual& one) { return one.unwarped; });
  summary.noise = SummaryOfEach(residuals, [](const GroundResidual& one) { return one.noise; });
  summary.misplacement_px =
      SummaryOfEach(residuals, [](const GroundResidual& one) { return one.misplacement_px(); });
  summary.without_common = static_cast<int>(residuals.size()) - summary.warped.count;
  return summary;
}

VideoScore ScoreVideo(FrameSource& source, const std::string& name,
                      const std::vector<Eigen::Matrix3d>& first_from_frame,
                      const VideoScoreOptions& options, const PairRegister& register_pair,
                      const std::function<void()>& on_frame) {
  if (options.gap < 1 || options.every < 1) {
    throw std::invalid_argument("gaps and steps are of at least 1 frame");
  }
  const auto gap = static_cast<std::size_t>(options.gap);
  const auto every = static_cast<std::size_t>(options.every);
  VideoScore score;
  score.gap = options.gap;
  std::deque<cv::Mat> pictures;  // the last ones, a cycle's at most
  std::size_t frames = 0;
  bool goes_on = false;
  for (cv::Mat frame = source.Next(); !frame.empty(); frame = source.Next()) {
    if (frames == first_from_frame.size()) {
      goes_on = !options.from_start;
      break;
    }
    if (pictures.size() > gap) pictures.pop_front();
    cv::cvtColor(frame, pictures.emplace_back(), cv::COLOR_BGR2GRAY);
    const auto from_now = [&](std::size_t earlier) -> Eigen::Matrix3d {
      return first_from_frame[frames - earlier].inverse() * first_from_frame[frames];
    };
    if (frames > 0) {
      score.consecutive.push_back(
          MeasureGroundResidual(*std::prev(pictures.end(), 2), pictures.back(), from_now(1)));
    }
    if (frames >= gap && (frames - gap) % every == 0) {
      ScoreCycle(pictures.front(), pictures.back(), from_now(gap), register_pair, score);
    }
    ++frames;
    on_frame();
  }
  if (goes_on || frames < first_from_frame.size()) {
    throw FormatError(name, (goes_on ? "has more than " : "has only ") + std::to_string(frames) +
                                " frames, but there are homographies of " +
                                std::to_string(first_from_frame.size()));
  }
  return score;
}

}  // namespace windhover::replay
