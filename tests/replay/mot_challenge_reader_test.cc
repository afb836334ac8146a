// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "replay/format/homographies.h"
#include "replay/format/horizon.h"
#include "replay/format/sequence.h"
#include "replay/format/text_lines.h"
#include "tests/replay/picture_folder.h"
#include "tests/replay/reader_checks.h"
#include "tests/service/app_process.h"

namespace windhover::replay {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

namespace fs = std::filesystem;

void WriteMotChallenge(const fs::path& folder, int frames) {
  WritePictures(folder / "img1", "", 6, ".jpg", frames);
  WriteText(folder / "seqinfo.ini",
            "[Sequence]\nname=MOT17-02\nimDir=img1\nframeRate=30\nseqLength=" +
                std::to_string(frames) + "\nimWidth=64\nimHeight=48\nimExt=.jpg\n");
}

TEST(MotChallengeReader, ClassesTellWhatCannotMove) {
  const ScratchFolder folder;
  WriteMotChallenge(folder.path(), 3);
  WriteText(MoversPath(folder.path()),
            "1,1,11,21,5,6,1,1,0.8\n2,1,12,21,5,6,1,1,1\n1,2,31,21,5,6,1,7,1\n"
            "3,3,1,1,5,6,0,3,0.5\n");
  const Recording recording = OpenRecording(folder.path());
  EXPECT_EQ(recording.name, "MOT17-02");
  EXPECT_EQ(recording.frames, 3);
  EXPECT_EQ(recording.frame_rate_hz, 30);
  EXPECT_EQ(recording.labelling, Labelling::kObjects);
  EXPECT_FALSE(recording.labels_move);
  ASSERT_EQ(recording.labels.size(), 4U);
  ExpectBox(recording.labels[0], 1, 1, {10, 20, 5, 6}, 1);
  EXPECT_EQ(recording.labels[0].category, "pedestrian");
  EXPECT_EQ(recording.labels[0].box.visible, 0.8);
  ExpectBox(recording.labels[2], 1, 2, {30, 20, 5, 6}, 0);
  EXPECT_EQ(recording.labels[2].category, "static person");
  ExpectBox(recording.labels[3], 3, 3, {0, 0, 5, 6}, 0);
  EXPECT_EQ(recording.labels[3].category, "car");
  EXPECT_EQ(CountFrames(recording), 3);
}

TEST(MotChallengeReader, OurOwnTruthIsOfMovers) {
  const ScratchFolder folder;
  WriteMotChallenge(folder.path(), 2);
  WriteText(MoversPath(folder.path()), "1,1,11,21,5,6,1,1,1\n2,1,12,21,5,6,0,1,0.3\n");
  WriteText(DecoysPath(folder.path()), "1,4,31,21,5,6,1,1,1\n");
  WriteHomographies(HomographiesPath(folder.path()),
                    {Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity()});
  WriteHorizons(HorizonPath(folder.path()), {{0, 1, -7}, {0, 1, -8}});
  const Recording recording = OpenRecording(folder.path());
  EXPECT_EQ(recording.labelling, Labelling::kMovers);
  EXPECT_TRUE(recording.labels_move);
  EXPECT_EQ(recording.Truth().size(), 2U);
  EXPECT_EQ(recording.Truth()[1].score, 0);
  EXPECT_EQ(recording.decoys.size(), 1U);
  EXPECT_EQ(recording.first_from_frame->size(), 2U);
  EXPECT_EQ(recording.horizons->at(1).z(), -8);
  WriteHorizons(HorizonPath(folder.path()), {{0, 1, -7}});
  EXPECT_THAT(OpenComplaint(folder.path()), HasSubstr("is of 1 frames"));
}

TEST(MotChallengeReader, WhatIsMissingIsNamed) {
  const ScratchFolder folder;
  WriteMotChallenge(folder.path(), 3);
  WriteText(MoversPath(folder.path()), "4,1,11,21,5,6,1,1,1\n");
  EXPECT_THAT(OpenComplaint(folder.path()), HasSubstr("a box in frame 4"));
  // Without truth nothing of it is opened.
  EXPECT_THAT(OpenRecordingWithoutTruth(folder.path()).labels, IsEmpty());
  fs::remove(folder / "img1" / "000002.jpg");
  EXPECT_THAT(OpenComplaint(folder.path()), HasSubstr("000002.jpg: is missing"));
  EXPECT_THAT(OpenComplaint(folder / "nowhere"), HasSubstr("does not exist"));
  EXPECT_THAT(OpenComplaint(folder / "gt"), HasSubstr("no recording of a set that is known"));
}

}  // namespace
}  // namespace windhover::replay
