// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "replay/format/sequence.h"
#include "replay/format/text_lines.h"
#include "tests/replay/picture_folder.h"
#include "tests/replay/reader_checks.h"
#include "tests/service/app_process.h"

namespace windhover::replay {
namespace {

using testing::AllOf;
using testing::HasSubstr;

namespace fs = std::filesystem;

TEST(PlainReader, PicturesOfAnyNumberedName) {
  const ScratchFolder folder;
  WritePictures(folder / "a", "DJI_", 4, ".png", 3, 24);
  EXPECT_EQ(OpenRecording(folder / "a").frames, 3);
  EXPECT_EQ(OpenRecording(folder / "a").labelling, Labelling::kNone);
  WritePicture(folder / "a" / "other_0027.png");
  EXPECT_THAT(OpenComplaint(folder / "a"), HasSubstr("pictures of several kinds"));
  fs::remove(folder / "a" / "other_0027.png");
  WritePicture(folder / "a" / "DJI_00026.png");
  EXPECT_THAT(OpenComplaint(folder / "a"), HasSubstr("has the same number"));
  fs::remove(folder / "a" / "DJI_00026.png");
  WritePicture(folder / "a" / "DJI_0025.png", 65, 48);
  const Recording mixed = OpenRecording(folder / "a");
  EXPECT_THAT(Complaint([&] { CountFrames(mixed); }),
              AllOf(HasSubstr("DJI_0025.png"), HasSubstr("65x48"), HasSubstr("64x48")));
}

// So many frames, one picture after the other.
void WriteVideo(const fs::path& file, int frames) {
  std::string bytes;
  std::vector<unsigned char> picture;
  ASSERT_TRUE(cv::imencode(".jpg", cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(90)), picture));
  for (int i = 0; i < frames; ++i) bytes.append(picture.begin(), picture.end());
  WriteText(file, bytes);
}

TEST(PlainReader, AVideoWithOneTarget) {
  const ScratchFolder folder;
  const fs::path clip = folder / "clip";
  WriteVideo(clip / "clip_1.mjpeg", 3);
  WriteText(clip / "clip_1_groundtruth.txt", "14,7,10,5\n0,0,0,0\n15,7,10,5\n");
  const Recording recording = OpenRecording(clip);
  EXPECT_EQ(recording.name, "clip_1");
  EXPECT_EQ(recording.width, 64);
  EXPECT_EQ(recording.frames, 3);
  EXPECT_TRUE(recording.knows_frames);
  EXPECT_EQ(recording.labelling, Labelling::kOneTarget);
  ASSERT_EQ(recording.labels.size(), 2U);
  ExpectBox(recording.labels[1], 3, 1, {15, 7, 10, 5}, 1);
  EXPECT_EQ(CountFrames(recording), 3);
  EXPECT_EQ(OpenRecording(clip / "clip_1.mjpeg").labels.size(), 2U);
  EXPECT_FALSE(OpenRecordingWithoutTruth(clip).knows_frames);

  // Other lines than frames: seen at the latest when the frames are.
  WriteVideo(clip / "clip_1.mjpeg", 2);
  EXPECT_THAT(Complaint([&] { CountFrames(recording); }), HasSubstr("ends after 2"));
  WriteVideo(clip / "clip_1.mjpeg", 4);
  EXPECT_THAT(Complaint([&] { CountFrames(recording); }), HasSubstr("goes on"));
}

TEST(SequenceFormat, OneVideoStandsForThePictures) {
  const ScratchFolder folder;
  SequenceInfo info;
  info.name = "one";
  info.frames = 3;
  info.width = 64;
  info.height = 48;
  WriteSequenceInfo(folder.path(), info);
  EXPECT_THAT(OpenComplaint(folder.path()), HasSubstr("img1: is missing, and so is a video"));
  WriteVideo(folder / "one.mjpeg", 3);
  const Recording recording = OpenRecording(folder.path());
  EXPECT_EQ(recording.layout, "MOTChallenge");
  EXPECT_EQ(CountFrames(recording), 3);
  const std::unique_ptr<FrameSource> source = OpenFrames(folder.path());
  EXPECT_EQ(source->frames(), 3);
  EXPECT_TRUE(source->knows_frames());
  WriteVideo(folder / "one.mjpeg", 2);
  EXPECT_THAT(Complaint([&] { CountFrames(recording); }),
              HasSubstr("ends after 2, but the sequence is of 3 frames"));
  WriteVideo(folder / "two.mjpeg", 3);
  EXPECT_THAT(OpenComplaint(folder.path()), HasSubstr("several videos"));
}

}  // namespace
}  // namespace windhover::replay
