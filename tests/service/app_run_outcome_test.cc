// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include "service/app/run_outcome.h"

namespace windhover {
namespace {

using testing::HasSubstr;

RunOutcome Whole() {
  RunOutcome outcome;
  outcome.source = "flight.mp4";
  outcome.source_reach = {50, 2'000'000'000, 2'000'000'000, 0};
  outcome.frames_out = 50;
  outcome.published = outcome.received = {50, 50, 7};
  outcome.frames_per_second = 34.56;
  outcome.device = "CPU twin";
  return outcome;
}

TEST(RunOutcomeTest, SummaryIsOneLine) {
  EXPECT_EQ(Summary(Whole()),
            "flight.mp4: 50 frames in, 50 out; homographies 50 published, 50 received; detections "
            "50 published, 50 received; 7 boxes; 34.6 frames/s; CPU twin");
  EXPECT_EQ(Loss(Whole()), "");
}

TEST(RunOutcomeTest, EveryLossIsSeen) {
  const auto loss_of = [](auto change) {
    RunOutcome outcome = Whole();
    change(outcome);
    return Loss(outcome);
  };
  EXPECT_THAT(loss_of([](RunOutcome& o) { o.failed_samples = 2; }), HasSubstr("2 samples"));
  EXPECT_THAT(loss_of([](RunOutcome& o) { o.frames_out = 49; }), HasSubstr("49 came out"));
  EXPECT_THAT(loss_of([](RunOutcome& o) { o.published.homographies = 49; }),
              HasSubstr("49 samples of homographies published"));
  EXPECT_THAT(loss_of([](RunOutcome& o) { o.received.homographies = 49; }),
              HasSubstr("of homographies published and 49 received"));
  EXPECT_THAT(loss_of([](RunOutcome& o) { o.received.detections = 51; }),
              HasSubstr("of detections published and 51 received"));
  EXPECT_THAT(loss_of([](RunOutcome& o) { o.received.boxes = 6; }), HasSubstr("6 received"));
}

TEST(RunOutcomeTest, ASourceIsCutOffHalfASecondBeforeItsLength) {
  SourceReach reach = Whole().source_reach;
  EXPECT_EQ(CutOff(reach), "");
  reach.reached_ns = 1'500'000'001;
  EXPECT_EQ(CutOff(reach), "");
  reach.reached_ns = 1'500'000'000;
  EXPECT_EQ(CutOff(reach), "is cut off: it ends after 1.50 s of 2.00 s, 50 frames");
  reach.length_ns = 0;
  EXPECT_EQ(CutOff(reach), "");
  reach.missing_bytes = 12;
  EXPECT_EQ(CutOff(reach), "is cut off: 12 bytes are missing; it ends after 1.50 s, 50 frames");
}

}  // namespace
}  // namespace windhover
