// SPDX-License-Identifier: Apache-2.0
#include <gst/gst.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <opencv2/core.hpp>
#include <thread>
#include <vector>

#include "replay/offline/pipeline_run.h"
#include "replay/render/parallel.h"
#include "replay/render/renderer.h"
#include "replay/scoring/motion_score.h"
#include "replay/scoring/registration_score.h"
#include "service/gstreamer/detection_meta.h"
#include "service/gstreamer/homography_meta.h"

// The whole way on the embedded flight: rendered frames into the real elements, what comes out of
// them against the truth.

namespace windhover::replay {
namespace {

constexpr double kLeastPrecision = 0.9;
constexpr double kLeastRecall = 0.7;
constexpr double kMostRmsPx = 0.5;

struct Flight {
  FlightPlan plan = FindFlightPlan("flight");
  std::vector<cv::Mat> bgr;
  std::vector<FrameTruth> truth;
};

// Rendered once for all tests of the program.
const Flight& TheFlight() {
  static const Flight flight = [] {
    Flight made;
    const int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    const Renderer renderer(made.plan, threads);
    made.bgr.resize(made.plan.frames);
    made.truth.resize(made.plan.frames);
    ForEachInParallel(made.plan.frames, threads, [&](int i) {
      made.bgr[i] = renderer.Frame(i);
      made.truth[i] = renderer.Truth(i);
    });
    return made;
  }();
  return flight;
}

struct Outcome {
  std::vector<FrameRegistration> registrations;
  std::vector<GstClockTime> pts;
  std::vector<LabelledBox> boxes;
};

Outcome RunElements(const std::string& reference) {
  const Flight& flight = TheFlight();
  Outcome outcome;
  std::vector<Detection> detections;
  const PipelineSettings settings = {"whregister ! queue ! whbackground ! queue ! whmotion",
                                     {{"reference", reference}}};
  PlayThroughPipeline(flight.bgr, flight.plan.frame_rate_hz, settings, [&](GstBuffer* buffer) {
    outcome.pts.push_back(GST_BUFFER_PTS(buffer));
    const GstWindhoverHomographyMeta* meta = gst_buffer_get_windhover_homography_meta(buffer);
    if (meta != nullptr) outcome.registrations.push_back(meta->registration);
    GetDetections(buffer, flight.plan.width, flight.plan.height, detections);
    for (const Detection& detection : detections) {
      outcome.boxes.push_back({static_cast<int>(outcome.pts.size()),
                               static_cast<std::int64_t>(detection.track_id), detection.box,
                               detection.score});
    }
  });
  return outcome;
}

void ExpectEveryFrameOnceInOrder(const Outcome& outcome) {
  const std::size_t frames = TheFlight().bgr.size();
  ASSERT_EQ(outcome.pts.size(), frames);
  ASSERT_EQ(outcome.registrations.size(), frames);
  for (std::size_t i = 0; i < frames; ++i) {
    EXPECT_EQ(outcome.pts[i], i * GST_SECOND / 25);
    EXPECT_EQ(outcome.registrations[i].frame_number, i);
  }
}

// Each frame's own previous_from_frame over all ground that both frames see.
void ExpectExactRegistration(const Outcome& outcome) {
  const Flight& flight = TheFlight();
  for (std::size_t i = 1; i < outcome.registrations.size(); ++i) {
    const Eigen::Matrix3d truth =
        flight.truth[i - 1].first_from_frame.inverse() * flight.truth[i].first_from_frame;
    EXPECT_LE(RegistrationRms(outcome.registrations[i].previous_from_frame, truth,
                              flight.plan.width, flight.plan.height)
                  .value(),
              kMostRmsPx)
        << "frame " << i;
    EXPECT_NE(outcome.registrations[i].quality, RegistrationQuality::kLost) << "frame " << i;
  }
}

void ExpectMoversFound(const Outcome& outcome) {
  std::vector<LabelledBox> truth;
  for (std::size_t i = 0; i < outcome.pts.size(); ++i) {
    const std::vector<LabelledBox>& movers = TheFlight().truth[i].movers;
    truth.insert(truth.end(), movers.begin(), movers.end());
  }
  const MotionScore score = ScoreMotion(truth, outcome.boxes, kThesisOverlap);
  ASSERT_GT(score.truth, 0);
  ASSERT_GT(score.detections, 0);
  EXPECT_GE(*score.precision(), kLeastPrecision) << score.hits << " of " << score.detections;
  EXPECT_GE(*score.recall(), kLeastRecall) << score.hits << " of " << score.truth;
}

TEST(EndToEnd, AnchorModeFindsTheMoversOfTheFlight) {
  const Outcome outcome = RunElements("anchor");
  ExpectEveryFrameOnceInOrder(outcome);
  ExpectExactRegistration(outcome);
  ExpectMoversFound(outcome);
}

TEST(EndToEnd, CentreModeFindsTheMoversOfTheFlight) {
  const Outcome outcome = RunElements("centre");
  ExpectEveryFrameOnceInOrder(outcome);
  ExpectExactRegistration(outcome);
  ExpectMoversFound(outcome);
}

}  // namespace
}  // namespace windhover::replay
