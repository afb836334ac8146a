// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "service/app/sample_text.h"
#include "tests/service/dds_samples.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;

std::vector<std::string> Keys(const Json& json) {
  std::vector<std::string> keys;
  for (const auto& item : json.items()) keys.push_back(item.key());
  return keys;
}

DetectionsSample SampleOfDetections() {
  DetectionsSample sample;
  sample.stream = "alpha";
  sample.frame_number = 7;
  sample.pts_ns = 233333333;
  sample.width = 640;
  sample.height = 480;
  sample.detections = {SampleDetection(1), SampleDetection(2)};
  return sample;
}

HomographySample SampleOfHomography(bool anchor) {
  HomographySample sample;
  sample.stream = "alpha";
  sample.pts_ns = 0;
  sample.width = 640;
  sample.height = 480;
  sample.registration = SampleRegistration(6, anchor);
  return sample;
}

TEST(JsonLineTest, HomographyHasTheseFieldsInThisOrder) {
  const std::string line = JsonLine(SampleOfHomography(true));
  EXPECT_THAT(line, EndsWith("}\n"));
  const Json json = Json::parse(line);
  EXPECT_THAT(Keys(json), ElementsAre("type", "stream", "frame", "pts_ns", "width", "height",
                                      "quality", "starts_segment", "change", "previous_from_frame",
                                      "anchor_from_frame", "anchor", "corner_covariance_px2",
                                      "inliers", "tiles", "residual_px", "overlap"));
  EXPECT_EQ(json["type"], "homography");
  EXPECT_EQ(json["frame"], 6);
  EXPECT_EQ(json["pts_ns"], 0);
  EXPECT_EQ(json["quality"], "valid");
  EXPECT_EQ(json["anchor"], 3);
  const FrameRegistration registration = SampleRegistration(6, true);
  for (int i = 0; i < 9; ++i) {
    EXPECT_EQ(json["previous_from_frame"][i], registration.previous_from_frame(i / 3, i % 3));
    EXPECT_EQ(json["anchor_from_frame"][i], (*registration.anchor_from_frame)(i / 3, i % 3));
  }
  ASSERT_EQ(json["corner_covariance_px2"].size(), 64);
  for (int i = 0; i < 64; ++i) {
    EXPECT_EQ(json["corner_covariance_px2"][i], registration.corner_covariance(i / 8, i % 8));
  }
}

TEST(JsonLineTest, WithoutAnchorItsFieldsAreNull) {
  const Json json = Json::parse(JsonLine(SampleOfHomography(false)));
  EXPECT_TRUE(json["anchor_from_frame"].is_null());
  EXPECT_TRUE(json["anchor"].is_null());
}

TEST(JsonLineTest, DetectionsHaveTheseFieldsInThisOrder) {
  const Json json = Json::parse(JsonLine(SampleOfDetections()));
  EXPECT_THAT(Keys(json), ElementsAre("type", "stream", "frame", "pts_ns", "width", "height",
                                      "omitted", "detections"));
  EXPECT_EQ(json["type"], "detections");
  ASSERT_EQ(json["detections"].size(), 2);
  const Json& one = json["detections"][1];
  EXPECT_THAT(Keys(one), ElementsAre("track", "x", "y", "width", "height", "velocity_x_px",
                                     "velocity_y_px", "score", "age_frames"));
  const Detection detection = SampleDetection(2);
  EXPECT_EQ(one["track"], 2);
  EXPECT_EQ(one["x"], detection.box.x);
  EXPECT_EQ(one["height"], detection.box.height);
  EXPECT_EQ(one["velocity_y_px"], detection.velocity_px.y());
  EXPECT_EQ(one["score"], detection.score);
  EXPECT_EQ(one["age_frames"], detection.age_frames);
}

TEST(JsonLineTest, FramesWithoutDetectionsHaveAnEmptyList) {
  DetectionsSample sample = SampleOfDetections();
  sample.detections.clear();
  sample.pts_ns = -1;
  const Json json = Json::parse(JsonLine(sample));
  EXPECT_TRUE(json["detections"].is_array());
  EXPECT_TRUE(json["detections"].empty());
  EXPECT_TRUE(json["pts_ns"].is_null());
}

// Nothing but finite numbers and null may come out, whatever a foreign publisher sends.
TEST(JsonLineTest, NumbersThatAreNotFiniteBecomeNull) {
  HomographySample sample = SampleOfHomography(true);
  sample.registration.residual_px = std::numeric_limits<double>::quiet_NaN();
  sample.registration.previous_from_frame(1, 1) = std::numeric_limits<double>::infinity();
  const Json json = Json::parse(JsonLine(sample));
  EXPECT_TRUE(json["residual_px"].is_null());
  EXPECT_TRUE(json["previous_from_frame"][4].is_null());
}

TEST(JsonLineTest, NamesOfStreamsCannotBreakALine) {
  DetectionsSample sample = SampleOfDetections();
  sample.stream = "two\nlines \"quoted\" \xff";
  const std::string line = JsonLine(sample);
  EXPECT_EQ(line.find('\n'), line.size() - 1);
  EXPECT_EQ(Json::parse(line)["stream"], "two\nlines \"quoted\" \xef\xbf\xbd");
}

TEST(JsonLineTest, EndsAndPublishersAreLinesToo) {
  EXPECT_EQ(JsonEndLine("a", Topic::kDetections, Subscriber::EndReason::kEnded),
            "{\"type\":\"end\",\"stream\":\"a\",\"topic\":\"detections\",\"reason\":\"ended\"}\n");
  EXPECT_EQ(JsonEndLine("a", Topic::kHomography, Subscriber::EndReason::kLost),
            "{\"type\":\"end\",\"stream\":\"a\",\"topic\":\"homography\",\"reason\":\"lost\"}\n");
  EXPECT_EQ(JsonPublishersLine(2), "{\"type\":\"publishers\",\"publishers\":2}\n");
}

TEST(TextLineTest, SaysWhatMatters) {
  EXPECT_THAT(TextLine(SampleOfHomography(true)),
              HasSubstr("alpha frame 6 at 0.000 s: homography valid"));
  EXPECT_THAT(TextLine(SampleOfDetections()), HasSubstr("2 detections: #1"));
  EXPECT_EQ(TextPublishersLine(1), "1 publisher\n");
}

}  // namespace
}  // namespace windhover
