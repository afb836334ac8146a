// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/sample_frames.h"

#include <glib.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <opencv2/imgcodecs.hpp>

#include "replay/scoring/frame_match.h"

namespace windhover::replay {
namespace {

constexpr int kJpegQuality = 85;

std::vector<LabelledBox> InFrame(const std::vector<LabelledBox>& boxes, int frame) {
  std::vector<LabelledBox> found;
  std::copy_if(boxes.begin(), boxes.end(), std::back_inserter(found),
               [frame](const LabelledBox& box) { return box.frame == frame; });
  return found;
}

std::string JpegBase64(const cv::Mat& picture) {
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  const std::unique_ptr<char, decltype(&g_free)> text(g_base64_encode(jpeg.data(), jpeg.size()),
                                                      g_free);
  return text.get();
}

}  // namespace

bool IsSample(int frame, int frames) { return frame == frames / 3 || frame == 2 * frames / 3; }

SampleFrame MakeSample(const std::string& sequence, int frame, const cv::Mat& picture,
                       const std::vector<LabelledBox>& truth,
                       const std::vector<SampleView>& views) {
  SampleFrame sample = {sequence, frame, picture.cols, picture.rows, JpegBase64(picture), {}};
  const std::vector<LabelledBox> objects = InFrame(truth, frame);
  for (const SampleView& view : views) {
    SampleFrame::View& shown = sample.views.emplace_back();
    shown.title = view.title;
    const std::vector<LabelledBox> boxes = InFrame(view.boxes, frame);
    const FrameMatch match = MatchFrame(objects, boxes, kThesisOverlap);
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (match.detection_of_truth[i] != FrameMatch::kMiss) continue;
      shown.marks.push_back({SampleFrame::Kind::kMiss, objects[i].box});
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const int partner = match.truth_of_detection[i];
      if (partner == FrameMatch::kIgnored) continue;
      shown.marks.push_back(
          {partner == FrameMatch::kMiss ? SampleFrame::Kind::kFalseAlarm : SampleFrame::Kind::kHit,
           boxes[i].box});
    }
  }
  return sample;
}

}  // namespace windhover::replay
