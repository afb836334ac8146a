// SPDX-License-Identifier: Apache-2.0
#include "gst-plugins/screen_metadata.h"

#include <gst/video/video.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "gst-plugins/element.h"
#include "gst-plugins/evidence_meta.h"
#include "service/gstreamer/detection_meta.h"
#include "service/gstreamer/homography_meta.h"
#include "tests/support/synthetic_ground.h"

namespace windhover {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;

ScreenPose PoseOf(const Eigen::Matrix3d& screen_from_frame) {
  ScreenPose pose;
  pose.screen_from_frame = screen_from_frame;
  pose.continues = true;
  return pose;
}

BufferPtr Carried(const BufferPtr& from, const ScreenPose& pose) {
  BufferPtr to(gst_buffer_new());
  CarryMetadata(from.get(), pose, kWidth, kHeight, to.get());
  return to;
}

TEST(ScreenMetadata, DetectionsFollow) {
  const Eigen::Matrix3d quarter_turn = CameraMotion(kWidth, kHeight, M_PI / 2, 1.0, 10.0, 0.0);
  const BufferPtr from(gst_buffer_new());
  AddDetections(from.get(), {{17, {150.0, 100.0, 20.0, 10.0}, {3.0, 1.0}, 0.75, 5}}, kWidth,
                kHeight);
  const BufferPtr to = Carried(from, PoseOf(quarter_turn));
  std::vector<Detection> detections;
  GetDetections(to.get(), kWidth, kHeight, detections);
  ASSERT_EQ(detections.size(), 1u);
  const Detection& d = detections[0];
  EXPECT_EQ(d.track_id, 17u);
  EXPECT_EQ(d.age_frames, 5);
  EXPECT_DOUBLE_EQ(d.score, 0.75);
  // The centre (159.5, 104.5) lies 15 px above the picture's: after the turn to its right.
  EXPECT_NEAR(d.box.x + 0.5 * (d.box.width - 1.0), 159.5 + 15.0 + 10.0, 1e-6);
  EXPECT_NEAR(d.box.y + 0.5 * (d.box.height - 1.0), 119.5, 1e-6);
  EXPECT_NEAR(d.box.width, 10.0, 1e-6);
  EXPECT_NEAR(d.box.height, 20.0, 1e-6);
  EXPECT_NEAR(d.velocity_px.x(), -1.0, 1e-6);
  EXPECT_NEAR(d.velocity_px.y(), 3.0, 1e-6);
  const auto* region = gst_buffer_get_video_region_of_interest_meta_id(to.get(), 17);
  ASSERT_NE(region, nullptr);
  EXPECT_LE(region->x, d.box.x);
  EXPECT_GE(region->x + region->w, d.box.x + d.box.width);
}

TEST(ScreenMetadata, RegionsAreClippedAndThoseOffTheScreenLeftOut) {
  const BufferPtr from(gst_buffer_new());
  gst_buffer_add_video_region_of_interest_meta(from.get(), "house", 0, 50, 40, 20)->id = 3;
  gst_buffer_add_video_region_of_interest_meta(from.get(), "house", 0, 50, 25, 20)->id = 4;
  const BufferPtr to = Carried(from, PoseOf(CameraMotion(kWidth, kHeight, 0.0, 1.0, -30.0, 0.0)));
  EXPECT_EQ(gst_buffer_get_n_meta(to.get(), GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE), 1u);
  const auto* region = gst_buffer_get_video_region_of_interest_meta_id(to.get(), 3);
  ASSERT_NE(region, nullptr);
  EXPECT_STREQ(g_quark_to_string(region->roi_type), "house");
  EXPECT_EQ(region->x, 0u);
  EXPECT_EQ(region->y, 50u);
  EXPECT_EQ(region->w, 10u);
  EXPECT_EQ(region->h, 20u);
}

TEST(ScreenMetadata, HomographiesAreToldForTheScreen) {
  const BufferPtr from(gst_buffer_new());
  FrameRegistration registration;
  registration.frame_number = 9;
  registration.previous_from_frame = CameraMotion(kWidth, kHeight, 0.0, 1.0, 8.0, 0.0);
  gst_buffer_add_windhover_homography_meta(from.get(), registration, kWidth, kHeight);
  ScreenPose held = PoseOf(CameraMotion(kWidth, kHeight, 0.0, 1.0, 8.0, 0.0));
  const BufferPtr to = Carried(from, held);
  const auto* meta = gst_buffer_get_windhover_homography_meta(to.get());
  ASSERT_NE(meta, nullptr);
  EXPECT_EQ(meta->registration.frame_number, 9u);
  EXPECT_TRUE(meta->registration.previous_from_frame.isIdentity(1e-9)) << "the ground is held";
}

TEST(ScreenMetadata, OtherMetadataStaysWhereItFitsAnyPicture) {
  const BufferPtr from(gst_buffer_new());
  GstCaps* clock = gst_caps_new_empty_simple("timestamp/x-test");
  gst_buffer_add_reference_timestamp_meta(from.get(), clock, 7, GST_CLOCK_TIME_NONE);
  gst_caps_unref(clock);
  gst_buffer_add_video_crop_meta(from.get())->width = 7;
  AddEvidence(from.get(), std::make_shared<MotionEvidence>());
  const BufferPtr to = Carried(from, PoseOf(Eigen::Matrix3d::Identity()));
  const auto* stamp = gst_buffer_get_reference_timestamp_meta(to.get(), nullptr);
  ASSERT_NE(stamp, nullptr);
  EXPECT_EQ(stamp->timestamp, 7u);
  EXPECT_EQ(gst_buffer_get_video_crop_meta(to.get()), nullptr);
  EXPECT_EQ(TakeEvidence(to.get()), nullptr);
}

}  // namespace
}  // namespace windhover
