// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "service/gstreamer/homography_meta.h"
#include "service/vision/homography.h"
#include "tests/gst-plugins/harness.h"
#include "tests/gst-plugins/test_video.h"

namespace windhover {
namespace {

constexpr int kWidth = 162;
constexpr int kHeight = 121;
constexpr char kRegister[] = "whregister device=cpu tile-columns=4 tile-rows=4";

FrameRegistration RegistrationOf(const BufferPtr& buffer) {
  const auto* meta = gst_buffer_get_windhover_homography_meta(buffer.get());
  if (meta == nullptr) {
    ADD_FAILURE() << "no homography";
    return {};
  }
  EXPECT_TRUE(meta->registration.previous_from_frame.allFinite());
  EXPECT_TRUE(meta->registration.corner_covariance.allFinite());
  EXPECT_TRUE(std::isfinite(meta->registration.residual_px));
  return meta->registration;
}

std::vector<FrameRegistration> RegistrationsOf(const std::vector<BufferPtr>& buffers) {
  std::vector<FrameRegistration> registrations;
  for (const BufferPtr& buffer : buffers) registrations.push_back(RegistrationOf(buffer));
  return registrations;
}

struct FormatCase {
  GstVideoFormat format;
  Layout layout;
};

void PrintTo(const FormatCase& c, std::ostream* out) {
  *out << gst_video_format_to_string(c.format);
}

class RegisterFormatTest : public testing::TestWithParam<FormatCase> {};

TEST_P(RegisterFormatTest, MeasuresTheMotionAndLeavesThePictureAlone) {
  TestVideo video(kWidth, kHeight, GetParam().format, GetParam().layout);
  Harness harness(kRegister);
  harness.SetCaps(video.Caps());
  constexpr int kFrames = 8;
  for (int t = 0; t < kFrames; ++t) ASSERT_EQ(harness.Push(video.Frame(t)), GST_FLOW_OK);
  const std::vector<BufferPtr> out = harness.PullAll();
  ASSERT_EQ(out.size(), static_cast<std::size_t>(kFrames));
  for (int t = 0; t < kFrames; ++t) {
    const BufferPtr expected = video.Frame(t);
    EXPECT_EQ(GST_BUFFER_PTS(out[t].get()), GST_BUFFER_PTS(expected.get()));
    EXPECT_EQ(GST_BUFFER_DURATION(out[t].get()), TestVideo::kFrameTime);
    EXPECT_EQ(GST_BUFFER_FLAGS(out[t].get()), GST_BUFFER_FLAGS(expected.get()));
    GstMapInfo map;
    ASSERT_TRUE(gst_buffer_map(expected.get(), &map, GST_MAP_READ));
    EXPECT_EQ(gst_buffer_get_size(out[t].get()), map.size);
    EXPECT_EQ(gst_buffer_memcmp(out[t].get(), 0, map.data, map.size), 0);
    gst_buffer_unmap(expected.get(), &map);

    const FrameRegistration r = RegistrationOf(out[t]);
    EXPECT_EQ(r.frame_number, static_cast<std::uint64_t>(t));
    EXPECT_EQ(r.quality, RegistrationQuality::kValid);
    EXPECT_EQ(r.starts_segment, t == 0);
    ASSERT_TRUE(r.anchor_from_frame.has_value());
    if (t == 0) continue;
    const Eigen::Matrix3d truth =
        InverseHomography(video.GroundFromFrame(t - 1)) * video.GroundFromFrame(t);
    EXPECT_LT(HomographyRms(r.previous_from_frame, truth, kWidth, kHeight), 0.5) << t;
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, RegisterFormatTest,
                         testing::Values(FormatCase{GST_VIDEO_FORMAT_GRAY8, Layout::kTight},
                                         FormatCase{GST_VIDEO_FORMAT_GRAY8, Layout::kWithMeta},
                                         FormatCase{GST_VIDEO_FORMAT_GRAY16_LE, Layout::kTight},
                                         FormatCase{GST_VIDEO_FORMAT_GRAY16_LE, Layout::kWithMeta},
                                         FormatCase{GST_VIDEO_FORMAT_GRAY16_BE, Layout::kTight},
                                         FormatCase{GST_VIDEO_FORMAT_GRAY16_BE, Layout::kWithMeta},
                                         FormatCase{GST_VIDEO_FORMAT_NV12, Layout::kTight},
                                         FormatCase{GST_VIDEO_FORMAT_NV12, Layout::kWithMeta},
                                         FormatCase{GST_VIDEO_FORMAT_I420, Layout::kTight},
                                         FormatCase{GST_VIDEO_FORMAT_I420, Layout::kWithMeta},
                                         FormatCase{GST_VIDEO_FORMAT_BGR, Layout::kTight},
                                         FormatCase{GST_VIDEO_FORMAT_BGR, Layout::kWithMeta},
                                         FormatCase{GST_VIDEO_FORMAT_BGRx, Layout::kTight},
                                         FormatCase{GST_VIDEO_FORMAT_BGRx, Layout::kWithMeta},
                                         FormatCase{GST_VIDEO_FORMAT_RGB, Layout::kTight},
                                         FormatCase{GST_VIDEO_FORMAT_RGB, Layout::kWithMeta},
                                         FormatCase{GST_VIDEO_FORMAT_RGBx, Layout::kTight},
                                         FormatCase{GST_VIDEO_FORMAT_RGBx, Layout::kWithMeta}),
                         [](const auto& info) {
                           return std::string(gst_video_format_to_string(info.param.format)) +
                                  (info.param.layout == Layout::kTight ? "Tight" : "Padded");
                         });

class RegisterElementTest : public testing::Test {
 protected:
  TestVideo video_{kWidth, kHeight};
};

TEST_F(RegisterElementTest, CentreModeHasNoAnchor) {
  Harness harness(std::string(kRegister) + " reference=centre");
  harness.SetCaps(video_.Caps());
  for (int t = 0; t < 3; ++t) harness.Push(video_.Frame(t));
  for (const FrameRegistration& r : RegistrationsOf(harness.PullAll())) {
    EXPECT_FALSE(r.anchor_from_frame.has_value());
    EXPECT_EQ(r.quality, RegistrationQuality::kValid);
  }
}

TEST_F(RegisterElementTest, BlackVideoIsLostWithoutNan) {
  Harness harness(kRegister);
  harness.SetCaps(video_.Caps());
  for (int t = 0; t < 5; ++t) ASSERT_EQ(harness.Push(video_.Black(t)), GST_FLOW_OK);
  const auto registrations = RegistrationsOf(harness.PullAll());
  ASSERT_EQ(registrations.size(), 5u);
  for (std::size_t t = 1; t < 5; ++t) {
    EXPECT_EQ(registrations[t].quality, RegistrationQuality::kLost) << t;
    EXPECT_TRUE(registrations[t].previous_from_frame.isIdentity(0.0));
  }
  const auto messages = harness.ElementMessages("windhover-registration");
  ASSERT_EQ(messages.size(), 1u) << "told once, not for each frame";
  EXPECT_STREQ(gst_structure_get_string(messages[0], "quality"), "lost");
  gst_structure_free(messages[0]);
}

enum class Break { kDiscont, kGap, kSegment, kStream, kSegmentDone, kGroupDone, kFlush };
std::string NameOf(Break kind) {
  constexpr const char* kNames[] = {"Discont",     "Gap",       "Segment", "Stream",
                                    "SegmentDone", "GroupDone", "Flush"};
  return kNames[static_cast<int>(kind)];
}
void PrintTo(Break kind, std::ostream* out) { *out << NameOf(kind); }

class RegisterBreakTest : public RegisterElementTest, public testing::WithParamInterface<Break> {};

TEST_P(RegisterBreakTest, StartsASegmentAndCountsOn) {
  Harness harness(kRegister);
  harness.SetCaps(video_.Caps());
  for (int t = 0; t < 4; ++t) harness.Push(video_.Frame(t));
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  segment.start = GST_SECOND;
  BufferPtr next = video_.Frame(4);
  switch (GetParam()) {
    case Break::kDiscont:
      GST_BUFFER_FLAG_SET(next.get(), GST_BUFFER_FLAG_DISCONT);
      break;
    case Break::kGap:
      EXPECT_TRUE(harness.PushEvent(gst_event_new_gap(GST_BUFFER_PTS(next.get()), GST_SECOND)));
      break;
    case Break::kSegment:
      EXPECT_TRUE(harness.PushEvent(gst_event_new_segment(&segment)));
      break;
    case Break::kStream:
      EXPECT_TRUE(harness.PushEvent(gst_event_new_stream_start("another")));
      break;
    case Break::kSegmentDone:
      EXPECT_TRUE(harness.PushEvent(gst_event_new_segment_done(GST_FORMAT_TIME, GST_SECOND)));
      break;
    case Break::kGroupDone:
      EXPECT_TRUE(harness.PushEvent(gst_event_new_stream_group_done(1)));
      break;
    case Break::kFlush:
      harness.Flush();
      break;
  }
  EXPECT_EQ(harness.Push(std::move(next)), GST_FLOW_OK);
  EXPECT_EQ(harness.Push(video_.Frame(5)), GST_FLOW_OK);
  const auto registrations = RegistrationsOf(harness.PullAll());
  ASSERT_EQ(registrations.size(), 6u);
  for (std::uint64_t t = 0; t < 6; ++t) {
    EXPECT_EQ(registrations[t].frame_number, t);
    EXPECT_EQ(registrations[t].starts_segment, t == 0 || t == 4);
  }
}

INSTANTIATE_TEST_SUITE_P(Breaks, RegisterBreakTest,
                         testing::Values(Break::kDiscont, Break::kGap, Break::kSegment,
                                         Break::kStream, Break::kSegmentDone, Break::kGroupDone,
                                         Break::kFlush),
                         [](const auto& info) { return NameOf(info.param); });

TEST_F(RegisterElementTest, TheSameSegmentAgainIsNoBreak) {
  Harness harness(kRegister);
  harness.SetCaps(video_.Caps());
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  for (int t = 0; t < 3; ++t) {
    harness.PushEvent(gst_event_new_segment(&segment));
    harness.Push(video_.Frame(t));
  }
  const auto registrations = RegistrationsOf(harness.PullAll());
  ASSERT_EQ(registrations.size(), 3u);
  EXPECT_FALSE(registrations[2].starts_segment);
}

TEST_F(RegisterElementTest, NewFrameSizeStartsASegmentAndCountsOn) {
  Harness harness(kRegister);
  harness.SetCaps(video_.Caps());
  for (int t = 0; t < 3; ++t) harness.Push(video_.Frame(t));
  TestVideo larger(200, 140);
  harness.SetCaps(larger.Caps());
  for (int t = 3; t < 6; ++t) EXPECT_EQ(harness.Push(larger.Frame(t)), GST_FLOW_OK);
  const auto out = harness.PullAll();
  ASSERT_EQ(out.size(), 6u);
  const auto registrations = RegistrationsOf(out);
  for (std::uint64_t t = 0; t < 6; ++t) {
    EXPECT_EQ(registrations[t].frame_number, t);
    EXPECT_EQ(registrations[t].starts_segment, t == 0 || t == 3);
    EXPECT_GE(registrations[t].anchor_number, t < 3 ? 0u : 3u);
  }
  EXPECT_EQ(gst_buffer_get_windhover_homography_meta(out[3].get())->width, 200);
}

TEST_F(RegisterElementTest, NewFormatOfTheSameSizeGoesOn) {
  Harness harness(kRegister);
  harness.SetCaps(video_.Caps());
  for (int t = 0; t < 3; ++t) harness.Push(video_.Frame(t));
  TestVideo colour(kWidth, kHeight, GST_VIDEO_FORMAT_BGR);
  harness.SetCaps(colour.Caps());
  for (int t = 3; t < 6; ++t) harness.Push(colour.Frame(t));
  const auto registrations = RegistrationsOf(harness.PullAll());
  ASSERT_EQ(registrations.size(), 6u);
  EXPECT_FALSE(registrations[3].starts_segment);
  EXPECT_EQ(registrations[3].quality, RegistrationQuality::kValid);
}

TEST_F(RegisterElementTest, FramesTooSmallAreOneClearError) {
  Harness harness("whregister device=cpu");
  harness.SetCaps("video/x-raw,format=GRAY8,width=64,height=48,framerate=25/1");
  const auto errors = harness.Errors();
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].domain, GST_STREAM_ERROR);
  EXPECT_THAT(errors[0].text, testing::HasSubstr("64x48"));
  TestVideo small(64, 48);
  EXPECT_EQ(harness.Push(small.Frame(0)), GST_FLOW_NOT_NEGOTIATED);
  EXPECT_TRUE(harness.Errors().empty());
}

// Adds to all pixels of a GRAY16_LE frame.
void AddTo(GstBuffer* buffer, int offset) {
  GstMapInfo map;
  ASSERT_TRUE(gst_buffer_map(buffer, &map, GST_MAP_READWRITE));
  for (gsize i = 0; i + 1 < map.size; i += 2) {
    const int value = GST_READ_UINT16_LE(map.data + i) + offset;
    GST_WRITE_UINT16_LE(map.data + i, static_cast<guint16>(value));
  }
  gst_buffer_unmap(buffer, &map);
}

TEST_F(RegisterElementTest, ThermalVideoRegistersAsItsTwinOf8Bits) {
  TestVideo thermal(kWidth, kHeight, GST_VIDEO_FORMAT_GRAY16_LE);
  Harness plain(kRegister), sixteen(kRegister);
  plain.SetCaps(video_.Caps());
  sixteen.SetCaps(thermal.Caps());
  for (int t = 0; t < 10; ++t) {
    ASSERT_EQ(plain.Push(video_.Frame(t)), GST_FLOW_OK);
    BufferPtr frame = thermal.Frame(t);
    // A hot pixel that blinks must not change what the others look like.
    const std::uint8_t hot[] = {0xff, 0xff};
    if (t % 2 == 1) gst_buffer_fill(frame.get(), 5000, hot, 2);
    ASSERT_EQ(sixteen.Push(std::move(frame)), GST_FLOW_OK);
  }
  const auto expected = RegistrationsOf(plain.PullAll());
  const auto actual = RegistrationsOf(sixteen.PullAll());
  ASSERT_EQ(actual.size(), expected.size());
  double plain_error = 0.0, thermal_error = 0.0;
  for (int t = 1; t < 10; ++t) {
    const Eigen::Matrix3d truth =
        InverseHomography(video_.GroundFromFrame(t - 1)) * video_.GroundFromFrame(t);
    plain_error += HomographyRms(expected[t].previous_from_frame, truth, kWidth, kHeight);
    thermal_error += HomographyRms(actual[t].previous_from_frame, truth, kWidth, kHeight);
    EXPECT_EQ(actual[t].quality, RegistrationQuality::kValid) << t;
    EXPECT_FALSE(actual[t].starts_segment) << t;
  }
  EXPECT_LT(thermal_error, 1.1 * plain_error + 0.01 * 9);
}

TEST_F(RegisterElementTest, ConstantThermalVideoIsLostWithoutNan) {
  TestVideo thermal(kWidth, kHeight, GST_VIDEO_FORMAT_GRAY16_LE);
  Harness harness(kRegister);
  harness.SetCaps(thermal.Caps());
  for (int t = 0; t < 3; ++t) ASSERT_EQ(harness.Push(thermal.Black(t)), GST_FLOW_OK);
  for (const FrameRegistration& r : RegistrationsOf(harness.PullAll())) {
    EXPECT_EQ(r.quality, RegistrationQuality::kLost);
  }
}

// A camera that calibrates itself and shows the same ground at other temperatures from then on.
TEST_F(RegisterElementTest, AStepOfTheThermalRangeStartsASegment) {
  TestVideo thermal(kWidth, kHeight, GST_VIDEO_FORMAT_GRAY16_LE);
  Harness harness(kRegister);
  harness.SetCaps(thermal.Caps());
  for (int t = 0; t < 8; ++t) {
    BufferPtr frame = thermal.Frame(t);
    if (t >= 4) AddTo(frame.get(), 5000);
    ASSERT_EQ(harness.Push(std::move(frame)), GST_FLOW_OK);
  }
  const auto registrations = RegistrationsOf(harness.PullAll());
  ASSERT_EQ(registrations.size(), 8u);
  for (std::size_t t = 0; t < 8; ++t) {
    EXPECT_EQ(registrations[t].starts_segment, t == 0 || t == 4) << t;
    EXPECT_EQ(registrations[t].quality, RegistrationQuality::kValid) << t;
    EXPECT_EQ(registrations[t].frame_number, t);
  }
}

constexpr char kSizeCaps[] = "video/x-raw,format=GRAY8,width=162,height=121,framerate=25/1";

TEST_F(RegisterElementTest, InterlacedVideoIsRefusedWithAHint) {
  for (const std::string mode : {"interleaved", "fields"}) {
    Harness harness(kRegister);
    harness.SetCaps(kSizeCaps + (",interlace-mode=" + mode));
    const auto errors = harness.Errors();
    ASSERT_EQ(errors.size(), 1u) << mode;
    EXPECT_EQ(errors[0].domain, GST_STREAM_ERROR);
    EXPECT_EQ(errors[0].code, GST_STREAM_ERROR_FORMAT);
    EXPECT_THAT(errors[0].text, testing::HasSubstr("162x121"));
    EXPECT_THAT(errors[0].text, testing::HasSubstr(mode));
    EXPECT_THAT(errors[0].text, testing::HasSubstr("Put 'deinterlace' before whregister"));
    EXPECT_EQ(harness.Push(video_.Frame(0)), GST_FLOW_NOT_NEGOTIATED);
  }
}

TEST_F(RegisterElementTest, ProgressiveFramesOfMixedVideoPassUpToTheFirstInterlacedOne) {
  Harness harness(kRegister);
  harness.SetCaps(std::string(kSizeCaps) + ",interlace-mode=mixed");
  for (int t = 0; t < 3; ++t) ASSERT_EQ(harness.Push(video_.Frame(t)), GST_FLOW_OK);
  EXPECT_TRUE(harness.Errors().empty());
  BufferPtr interlaced = video_.Frame(3);
  GST_BUFFER_FLAG_SET(interlaced.get(), GST_VIDEO_BUFFER_FLAG_INTERLACED);
  EXPECT_EQ(harness.Push(std::move(interlaced)), GST_FLOW_ERROR);
  const auto errors = harness.Errors();
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].domain, GST_STREAM_ERROR);
  EXPECT_THAT(errors[0].text, testing::HasSubstr("Put 'deinterlace' before whregister"));
  EXPECT_EQ(harness.PullAll().size(), 3u);
}

TEST_F(RegisterElementTest, BufferThatIsTooShortIsAnError) {
  Harness harness(kRegister);
  harness.SetCaps(video_.Caps());
  EXPECT_EQ(harness.Push(BufferPtr(gst_buffer_new_allocate(nullptr, 100, nullptr))),
            GST_FLOW_ERROR);
  EXPECT_EQ(harness.Errors().size(), 1u);
}

// A buffer that others hold too, as behind a tee: they must not see our metadata, and the pixels
// are not copied.
TEST_F(RegisterElementTest, SharedBuffersStayAsTheyAre) {
  Harness harness(kRegister);
  harness.SetCaps(video_.Caps());
  const BufferPtr held = video_.Frame(0);
  harness.Push(BufferPtr(gst_buffer_ref(held.get())));
  EXPECT_EQ(gst_buffer_get_windhover_homography_meta(held.get()), nullptr);
  const BufferPtr out = harness.Pull();
  ASSERT_NE(out, nullptr);
  EXPECT_NE(gst_buffer_get_windhover_homography_meta(out.get()), nullptr);
  EXPECT_EQ(gst_buffer_peek_memory(out.get(), 0), gst_buffer_peek_memory(held.get(), 0));
}

TEST_F(RegisterElementTest, SecondOneReplacesTheFirst) {
  Harness harness(std::string(kRegister) + " ! " + kRegister + " reference=centre");
  harness.SetCaps(video_.Caps());
  harness.Push(video_.Frame(0));
  const BufferPtr out = harness.Pull();
  ASSERT_NE(out, nullptr);
  gpointer state = nullptr;
  int metas = 0;
  while (gst_buffer_iterate_meta_filtered(
             out.get(), &state, gst_windhover_homography_meta_api_get_type()) != nullptr) {
    ++metas;
  }
  EXPECT_EQ(metas, 1);
  EXPECT_FALSE(RegistrationOf(out).anchor_from_frame.has_value());
}

TEST_F(RegisterElementTest, AddsNoLatency) {
  Harness harness(kRegister);
  harness.SetCaps(video_.Caps());
  gst_harness_set_upstream_latency(harness.get(), 7 * GST_MSECOND);
  EXPECT_EQ(harness.Latency(), 7 * GST_MSECOND);
}

}  // namespace
}  // namespace windhover
