// SPDX-License-Identifier: Apache-2.0
#include "service/gstreamer/detection_meta.h"

#include <gst/video/video.h>
#include <gtest/gtest.h>

#include "gst-plugins/element.h"

namespace windhover {
namespace {

std::vector<Detection> Examples() {
  std::vector<Detection> detections(3);
  detections[0] = {1, {10.25, 20.5, 30.5, 8.0}, {1.5, -0.5}, 0.75, 12};
  detections[1] = {40000000000ull, {0.0, 0.0, 5.0, 5.0}, {0.0, 0.0}, 1.0, 1};
  detections[2] = {2, {600.0, 470.0, 60.0, 30.0}, {-2.0, 2.0}, 0.1, 3};  // reaches over the border
  return detections;
}

TEST(DetectionMeta, RoundTrip) {
  const BufferPtr buffer(gst_buffer_new());
  AddDetections(buffer.get(), Examples(), 640, 480);
  std::vector<Detection> read(5);
  GetDetections(buffer.get(), 640, 480, read);
  ASSERT_EQ(read.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    const Detection expected = Examples()[i];
    EXPECT_EQ(read[i].track_id, expected.track_id);
    EXPECT_NEAR(read[i].box.x, expected.box.x, 1e-9);
    EXPECT_NEAR(read[i].box.y, expected.box.y, 1e-9);
    EXPECT_NEAR(read[i].box.width, i == 2 ? 40.0 : expected.box.width, 1e-9);
    EXPECT_NEAR(read[i].box.height, i == 2 ? 10.0 : expected.box.height, 1e-9);
    EXPECT_TRUE(read[i].velocity_px.isApprox(expected.velocity_px, 1e-12));
    EXPECT_EQ(read[i].score, expected.score);
    EXPECT_EQ(read[i].age_frames, expected.age_frames);
  }
}

// What elements that know nothing of us read.
TEST(DetectionMeta, RegionAndStructures) {
  const BufferPtr buffer(gst_buffer_new());
  AddDetections(buffer.get(), Examples(), 640, 480);
  gpointer state = nullptr;
  auto* region = reinterpret_cast<GstVideoRegionOfInterestMeta*>(gst_buffer_iterate_meta_filtered(
      buffer.get(), &state, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE));
  ASSERT_NE(region, nullptr);
  EXPECT_STREQ(g_quark_to_string(region->roi_type), "moving-object");
  EXPECT_EQ(region->id, 1);
  EXPECT_EQ(region->x, 10u);
  EXPECT_EQ(region->y, 20u);
  EXPECT_EQ(region->w, 31u);
  EXPECT_EQ(region->h, 9u);
  const GstStructure* detection = gst_video_region_of_interest_meta_get_param(region, "detection");
  ASSERT_NE(detection, nullptr);
  double x_min = -1, x_max = -1, confidence = -1;
  EXPECT_TRUE(gst_structure_get(detection, "x_min", G_TYPE_DOUBLE, &x_min, "x_max", G_TYPE_DOUBLE,
                                &x_max, "confidence", G_TYPE_DOUBLE, &confidence, nullptr));
  EXPECT_DOUBLE_EQ(x_min, 10.25 / 640);
  EXPECT_DOUBLE_EQ(x_max, 40.75 / 640);
  EXPECT_EQ(confidence, 0.75);
  EXPECT_STREQ(gst_structure_get_string(detection, "label"), "moving-object");
  const GstStructure* object = gst_video_region_of_interest_meta_get_param(region, "object_id");
  int id = -1;
  ASSERT_NE(object, nullptr);
  EXPECT_TRUE(gst_structure_get_int(object, "id", &id));
  EXPECT_EQ(id, 1);
}

TEST(DetectionMeta, OfAScaledFrame) {
  const BufferPtr buffer(gst_buffer_new());
  AddDetections(buffer.get(), Examples(), 640, 480);
  std::vector<Detection> read;
  GetDetections(buffer.get(), 320, 480, read);
  ASSERT_EQ(read.size(), 3u);
  EXPECT_NEAR(read[0].box.x, 10.25 / 2, 1e-9);
  EXPECT_NEAR(read[0].box.y, 20.5, 1e-9);
  EXPECT_NEAR(read[0].velocity_px.x(), 0.75, 1e-9);
}

TEST(DetectionMeta, OtherRegionsAreLeftOut) {
  const BufferPtr buffer(gst_buffer_new());
  gst_buffer_add_video_region_of_interest_meta(buffer.get(), "face", 1, 2, 3, 4);
  gst_buffer_add_video_region_of_interest_meta(buffer.get(), kDetectionType, 1, 2, 3, 4);
  std::vector<Detection> read(2);
  GetDetections(buffer.get(), 640, 480, read);
  EXPECT_TRUE(read.empty());
}

}  // namespace
}  // namespace windhover
