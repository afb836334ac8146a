// SPDX-License-Identifier: Apache-2.0
#include "service/gstreamer/homography_meta.h"

#include <gst/video/video.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <memory>
#include <random>

#include "gst-plugins/element.h"
#include "gst-plugins/evidence_meta.h"
#include "service/gstreamer/registration_transform.h"
#include "service/vision/homography.h"
#include "service/vision/screen_pose.h"
#include "tests/gst-plugins/harness.h"
#include "tests/support/synthetic_ground.h"

namespace windhover {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;

FrameRegistration Example() {
  FrameRegistration r;
  r.frame_number = 7;
  r.anchor_number = 3;
  r.previous_from_frame = CameraMotion(kWidth, kHeight, 0.02, 1.01, 3.0, -2.0, 1e-5);
  r.anchor_from_frame = CameraMotion(kWidth, kHeight, 0.05, 0.98, -9.0, 5.0, -2e-5);
  r.corner_covariance = Matrix8d::Identity() * 0.04;
  r.corner_covariance(0, 1) = r.corner_covariance(1, 0) = 0.01;
  r.residual_px = 0.3;
  r.inliers = 30;
  r.tiles = 36;
  r.overlap = 0.9;
  r.quality = RegistrationQuality::kDegraded;
  return r;
}

void ExpectUnchangedNumbers(const FrameRegistration& a, const FrameRegistration& b) {
  EXPECT_EQ(a.frame_number, b.frame_number);
  EXPECT_EQ(a.anchor_number, b.anchor_number);
  EXPECT_EQ(a.inliers, b.inliers);
  EXPECT_EQ(a.tiles, b.tiles);
  EXPECT_EQ(a.overlap, b.overlap);
  EXPECT_EQ(a.quality, b.quality);
  EXPECT_EQ(a.starts_segment, b.starts_segment);
}

BufferPtr BufferWithMeta() {
  BufferPtr buffer(gst_buffer_new());
  gst_buffer_add_windhover_homography_meta(buffer.get(), Example(), kWidth, kHeight);
  return buffer;
}

TEST(HomographyMeta, CopiesTravelWithTheBuffer) {
  const BufferPtr buffer = BufferWithMeta();
  const BufferPtr copy(gst_buffer_copy(buffer.get()));
  const auto* meta = gst_buffer_get_windhover_homography_meta(copy.get());
  ASSERT_NE(meta, nullptr);
  EXPECT_EQ(meta->width, kWidth);
  EXPECT_EQ(meta->height, kHeight);
  EXPECT_EQ(meta->registration.previous_from_frame, Example().previous_from_frame);
  EXPECT_EQ(meta->registration.anchor_from_frame, Example().anchor_from_frame);
  EXPECT_EQ(meta->registration.corner_covariance, Example().corner_covariance);
  ExpectUnchangedNumbers(meta->registration, Example());
}

TEST(HomographyMeta, NoneWhereThereIsNone) {
  const BufferPtr buffer(gst_buffer_new());
  EXPECT_EQ(gst_buffer_get_windhover_homography_meta(buffer.get()), nullptr);
}

// The plugin holds this code a second time: both must mean the same type.
TEST(HomographyMeta, SharedBetweenModulesOfOneProcess) {
  const GType ours = gst_windhover_homography_meta_api_get_type();
  GstElement* element = gst_element_factory_make("whregister", nullptr);  // loads the plugin
  ASSERT_NE(element, nullptr);
  gst_object_unref(gst_object_ref_sink(element));
  EXPECT_EQ(g_type_from_name("GstWindhoverHomographyMetaAPI"), ours);
  EXPECT_EQ(gst_meta_get_info("GstWindhoverHomographyMeta"),
            gst_windhover_homography_meta_get_info());
}

struct PictureCase {
  const char* name;
  int crop_x, crop_y;
  int crop_width, crop_height;  // the picture before scaling
  int new_width, new_height;
};

void PrintTo(const PictureCase& c, std::ostream* out) { *out << c.name; }

class TransformTest : public testing::TestWithParam<PictureCase> {};

// A point of the new picture, taken back to the old one, through the old homography and forward
// again, lies where the new homography puts it.
TEST_P(TransformTest, HomographiesFollowThePicture) {
  const PictureCase& c = GetParam();
  const Eigen::Matrix3d new_from_old =
      ScaleOfPicture(c.crop_width, c.crop_height, c.new_width, c.new_height) *
      CropOfPicture(c.crop_x, c.crop_y);
  const FrameRegistration old = Example();
  const FrameRegistration now =
      RegistrationInNewPicture(old, new_from_old, kWidth, kHeight, c.new_width, c.new_height);
  ExpectUnchangedNumbers(old, now);
  const Eigen::Matrix3d old_from_new = new_from_old.inverse();
  for (const Eigen::Vector2d& x : PictureCorners(c.new_width, c.new_height)) {
    const Eigen::Vector2d x_in_old = Project(old_from_new, x);
    EXPECT_LT((Project(now.previous_from_frame, x) -
               Project(new_from_old, Project(old.previous_from_frame, x_in_old)))
                  .norm(),
              1e-9);
    EXPECT_LT((Project(*now.anchor_from_frame, x) -
               Project(new_from_old, Project(*old.anchor_from_frame, x_in_old)))
                  .norm(),
              1e-9);
  }
  EXPECT_DOUBLE_EQ(now.anchor_from_frame.value()(2, 2), 1.0);
}

// Against many draws of the old corners: the homography of each draw, seen at the new corners.
TEST_P(TransformTest, CovarianceFollowsThePicture) {
  const PictureCase& c = GetParam();
  const Eigen::Matrix3d new_from_old =
      ScaleOfPicture(c.crop_width, c.crop_height, c.new_width, c.new_height) *
      CropOfPicture(c.crop_x, c.crop_y);
  const FrameRegistration old = Example();
  const Matrix8d predicted =
      RegistrationInNewPicture(old, new_from_old, kWidth, kHeight, c.new_width, c.new_height)
          .corner_covariance;

  const auto old_corners = PictureCorners(kWidth, kHeight);
  const auto new_corners = PictureCorners(c.new_width, c.new_height);
  const Matrix8d factor = old.corner_covariance.llt().matrixL();
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto corners_of = [&](const Eigen::Matrix3d& anchor_from_frame) {
    Eigen::Matrix<double, 8, 1> put;
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector2d in_old = Project(new_from_old.inverse(), new_corners[i]);
      put.segment<2>(2 * i) = Project(new_from_old, Project(anchor_from_frame, in_old));
    }
    return put;
  };
  const auto truth = corners_of(*old.anchor_from_frame);
  constexpr int kDraws = 20000;
  Matrix8d sum = Matrix8d::Zero();
  for (int draw = 0; draw < kDraws; ++draw) {
    const Eigen::Matrix<double, 8, 1> noise =
        factor * Eigen::Matrix<double, 8, 1>::NullaryExpr([&] { return normal(random); });
    std::array<PointMatch, 4> matches;
    for (int i = 0; i < 4; ++i) {
      matches[i].x_in_frame = old_corners[i];
      matches[i].x_in_reference =
          Project(*old.anchor_from_frame, old_corners[i]) + noise.segment<2>(2 * i);
    }
    const auto drawn = HomographyByDlt(matches, {});
    ASSERT_TRUE(drawn.has_value());
    const Eigen::Matrix<double, 8, 1> error = corners_of(*drawn) - truth;
    sum += error * error.transpose();
  }
  const Matrix8d measured = sum / kDraws;
  EXPECT_LT((measured - predicted).norm(), 0.05 * predicted.norm()) << measured << "\n\n"
                                                                    << predicted;
}

INSTANTIATE_TEST_SUITE_P(
    Pictures, TransformTest,
    testing::Values(PictureCase{"Same", 0, 0, kWidth, kHeight, kWidth, kHeight},
                    PictureCase{"Half", 0, 0, kWidth, kHeight, kWidth / 2, kHeight / 2},
                    PictureCase{"Uneven", 0, 0, kWidth, kHeight, 500, 100},
                    PictureCase{"Crop", 40, 30, 200, 150, 200, 150},
                    PictureCase{"CropAndScale", 16, 60, 240, 100, 480, 300}),
    [](const auto& info) { return info.param.name; });

TEST(RegistrationTransform, LostStaysTheIdentity) {
  FrameRegistration lost;
  lost.quality = RegistrationQuality::kLost;
  const FrameRegistration scaled = RegistrationInNewPicture(
      lost, ScaleOfPicture(kWidth, kHeight, 100, 100), kWidth, kHeight, 100, 100);
  EXPECT_TRUE(scaled.previous_from_frame.isIdentity(1e-12));
  EXPECT_TRUE(scaled.corner_covariance.isZero(0.0));
  EXPECT_FALSE(scaled.anchor_from_frame.has_value());
}

// Poses of the frame, of the frame before and of the anchor, each on its own screen.
struct Screens {
  Eigen::Matrix3d frame = CameraMotion(kWidth, kHeight, 0.03, 1.05, 12.0, -4.0, 1e-5);
  Eigen::Matrix3d previous = CameraMotion(kWidth, kHeight, 0.02, 1.0, 10.0, -2.0);
  Eigen::Matrix3d anchor = CameraMotion(kWidth, kHeight, -0.01, 1.1, 1.0, 0.0, -1e-5);

  ScreenPose Pose(const FrameRegistration& registration) const {
    ScreenPose pose;
    pose.screen_from_frame = frame;
    pose.previous_screen_from_screen =
        previous * registration.previous_from_frame * frame.inverse();
    pose.previous_screen_from_screen /= pose.previous_screen_from_screen(2, 2);
    pose.continues = true;
    pose.reference_screen_from_reference = anchor;
    pose.anchor_number = 5;
    return pose;
  }
};

TEST(RegistrationOnScreen, HomographiesLeadFromScreenToScreen) {
  const Screens screens;
  const FrameRegistration old = Example();
  const FrameRegistration now = RegistrationOnScreen(old, screens.Pose(old), kWidth, kHeight);
  EXPECT_EQ(now.anchor_number, 5u);
  EXPECT_EQ(now.frame_number, old.frame_number);
  EXPECT_EQ(now.quality, old.quality);
  for (const Eigen::Vector2d& x : PictureCorners(kWidth, kHeight)) {
    const Eigen::Vector2d on_screen = Project(screens.frame, x);
    EXPECT_LT((Project(now.previous_from_frame, on_screen) -
               Project(screens.previous, Project(old.previous_from_frame, x)))
                  .norm(),
              1e-9);
    EXPECT_LT((Project(*now.anchor_from_frame, on_screen) -
               Project(screens.anchor, Project(*old.anchor_from_frame, x)))
                  .norm(),
              1e-9);
  }
}

// Against many draws of where the measured homography puts the frame's corners.
TEST(RegistrationOnScreen, CovarianceFollows) {
  const Screens screens;
  const FrameRegistration old = Example();
  const FrameRegistration now = RegistrationOnScreen(old, screens.Pose(old), kWidth, kHeight);
  const Matrix8d factor = old.corner_covariance.llt().matrixL();
  const auto corners = PictureCorners(kWidth, kHeight);
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  constexpr int kDraws = 20000;
  Matrix8d sum = Matrix8d::Zero();
  for (int draw = 0; draw < kDraws; ++draw) {
    const Eigen::Matrix<double, 8, 1> noise =
        factor * Eigen::Matrix<double, 8, 1>::NullaryExpr([&] { return normal(random); });
    auto put = corners;
    for (int i = 0; i < 4; ++i) {
      put[i] = Project(*old.anchor_from_frame, corners[i]) + noise.segment<2>(2 * i);
    }
    const Eigen::Matrix3d drawn = HomographyOfCorners(put, kWidth, kHeight);
    Eigen::Matrix<double, 8, 1> error;
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector2d in_frame = Project(screens.frame.inverse(), corners[i]);
      error.segment<2>(2 * i) = Project(screens.anchor, Project(drawn, in_frame)) -
                                Project(*now.anchor_from_frame, corners[i]);
    }
    sum += error * error.transpose();
  }
  const Matrix8d measured = sum / kDraws;
  EXPECT_LT((measured - now.corner_covariance).norm(), 0.05 * measured.norm());
}

TEST(RegistrationOnScreen, AFrameThatDoesNotContinueStartsASegment) {
  FrameRegistration old = Example();
  ScreenPose pose = Screens().Pose(old);
  pose.continues = false;
  pose.anchor_number = old.frame_number;
  const FrameRegistration now = RegistrationOnScreen(old, pose, kWidth, kHeight);
  EXPECT_TRUE(now.starts_segment);
  EXPECT_TRUE(now.previous_from_frame.isIdentity(0.0));
  EXPECT_TRUE(now.anchor_from_frame->isIdentity(0.0));
  EXPECT_TRUE(now.corner_covariance.isZero(0.0));
  EXPECT_EQ(now.anchor_number, old.frame_number);
}

// The real scaler and the real cropper.
TEST(HomographyMeta, VideoscaleKeepsItRight) {
  Harness harness("videoscale ! capsfilter caps=video/x-raw,width=160,height=120");
  harness.SetCaps("video/x-raw,format=GRAY8,width=320,height=240,framerate=25/1");
  BufferPtr buffer(gst_buffer_new_allocate(nullptr, kWidth * kHeight, nullptr));
  gst_buffer_memset(buffer.get(), 0, 0, kWidth * kHeight);
  gst_buffer_add_windhover_homography_meta(buffer.get(), Example(), kWidth, kHeight);
  ASSERT_EQ(harness.Push(std::move(buffer)), GST_FLOW_OK);
  const BufferPtr scaled = harness.Pull();
  ASSERT_NE(scaled, nullptr);
  const auto* meta = gst_buffer_get_windhover_homography_meta(scaled.get());
  ASSERT_NE(meta, nullptr);
  EXPECT_EQ(meta->width, 160);
  EXPECT_EQ(meta->height, 120);
  const FrameRegistration expected = RegistrationInNewPicture(
      Example(), ScaleOfPicture(kWidth, kHeight, 160, 120), kWidth, kHeight, 160, 120);
  EXPECT_TRUE(meta->registration.previous_from_frame.isApprox(expected.previous_from_frame, 1e-12));
  EXPECT_TRUE(meta->registration.corner_covariance.isApprox(expected.corner_covariance, 1e-12));
}

TEST(HomographyMeta, ScalerOfACroppedBuffer) {
  const BufferPtr from = BufferWithMeta();
  GstVideoCropMeta* crop = gst_buffer_add_video_crop_meta(from.get());
  *crop = {crop->meta, 40, 30, 200, 150};
  GstVideoInfo in, out;
  gst_video_info_set_format(&in, GST_VIDEO_FORMAT_GRAY8, 200, 150);
  gst_video_info_set_format(&out, GST_VIDEO_FORMAT_GRAY8, 400, 450);
  GstVideoMetaTransform transform = {&in, &out};
  const BufferPtr to(gst_buffer_new());
  auto* old = gst_buffer_get_windhover_homography_meta(from.get());
  ASSERT_TRUE(old->meta.info->transform_func(
      to.get(), &old->meta, from.get(), gst_video_meta_transform_scale_get_quark(), &transform));
  const auto* meta = gst_buffer_get_windhover_homography_meta(to.get());
  ASSERT_NE(meta, nullptr);
  const FrameRegistration expected = RegistrationInNewPicture(
      Example(), ScaleOfPicture(200, 150, 400, 450) * CropOfPicture(40, 30), kWidth, kHeight, 400,
      450);
  EXPECT_TRUE(meta->registration.previous_from_frame.isApprox(expected.previous_from_frame, 1e-12));
}

// A cropper that tells no one what it cuts off must not carry numbers that are wrong now.
TEST(HomographyMeta, VideocropDropsIt) {
  Harness harness("videocrop left=20 top=10");
  harness.SetCaps("video/x-raw,format=GRAY8,width=320,height=240,framerate=25/1");
  BufferPtr buffer(gst_buffer_new_allocate(nullptr, kWidth * kHeight, nullptr));
  gst_buffer_memset(buffer.get(), 0, 0, kWidth * kHeight);
  gst_buffer_add_windhover_homography_meta(buffer.get(), Example(), kWidth, kHeight);
  ASSERT_EQ(harness.Push(std::move(buffer)), GST_FLOW_OK);
  const BufferPtr cropped = harness.Pull();
  ASSERT_NE(cropped, nullptr);
  EXPECT_EQ(gst_buffer_get_windhover_homography_meta(cropped.get()), nullptr);
}

TEST(EvidenceMeta, FreedWithTheBufferOrWhenTaken) {
  auto evidence = std::make_shared<const MotionEvidence>();
  const std::weak_ptr<const MotionEvidence> watch = evidence;
  BufferPtr buffer(gst_buffer_new());
  AddEvidence(buffer.get(), std::move(evidence));
  BufferPtr copy(gst_buffer_copy(buffer.get()));
  EXPECT_EQ(watch.use_count(), 2);
  EXPECT_EQ(TakeEvidence(copy.get()), watch.lock());
  EXPECT_EQ(TakeEvidence(copy.get()), nullptr);
  EXPECT_EQ(watch.use_count(), 1);
  buffer.reset();
  EXPECT_TRUE(watch.expired());
}

TEST(EvidenceMeta, DoesNotPassAScaler) {
  Harness harness("videoscale ! capsfilter caps=video/x-raw,width=160,height=120");
  harness.SetCaps("video/x-raw,format=GRAY8,width=320,height=240,framerate=25/1");
  BufferPtr buffer(gst_buffer_new_allocate(nullptr, kWidth * kHeight, nullptr));
  gst_buffer_memset(buffer.get(), 0, 0, kWidth * kHeight);
  AddEvidence(buffer.get(), std::make_shared<const MotionEvidence>());
  ASSERT_EQ(harness.Push(std::move(buffer)), GST_FLOW_OK);
  const BufferPtr scaled = harness.Pull();
  ASSERT_NE(scaled, nullptr);
  EXPECT_EQ(TakeEvidence(scaled.get()), nullptr);
}

}  // namespace
}  // namespace windhover
