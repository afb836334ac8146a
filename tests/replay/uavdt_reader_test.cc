// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "replay/format/text_lines.h"
#include "tests/replay/picture_folder.h"
#include "tests/replay/reader_checks.h"
#include "tests/service/app_process.h"

namespace windhover::replay {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

namespace fs = std::filesystem;

TEST(UavdtReader, MotHasThreeFiles) {
  const ScratchFolder folder;
  const fs::path sequence = folder / "UAV-benchmark-M" / "M0101";
  WritePictures(sequence, "img", 6, ".jpg", 3);
  const fs::path truth = folder / "UAV-benchmark-MOTD_v1.0" / "GT";
  WriteText(truth / "M0101_gt.txt",
            "1,1,14,7,10,5,1,1,-1\n2,1,13,7,10,5,1,1,-1\n1,2,0,30,9,4,1,1,-1\n");
  WriteText(truth / "M0101_gt_whole.txt",
            "1,1,14,7,10,5,1,1,1\n2,1,13,7,10,5,1,4,1\n1,2,0,30,9,4,2,2,3\n");
  WriteText(truth / "M0101_gt_ignore.txt", "1,17,40,0,20,10,1,-1,-1\n");
  const Recording recording = OpenRecording(sequence);
  EXPECT_EQ(recording.layout, "UAVDT MOT");
  EXPECT_EQ(recording.frame_rate_hz, 30);
  EXPECT_EQ(recording.labelling, Labelling::kObjects);
  ASSERT_EQ(recording.labels.size(), 4U);
  ExpectBox(recording.labels[0], 1, 1, {14, 7, 10, 5}, 1);
  EXPECT_EQ(recording.labels[0].category, "car");
  EXPECT_EQ(recording.labels[1].occlusion, Occlusion::kPartial);
  EXPECT_EQ(recording.labels[2].category, "bus");
  EXPECT_EQ(recording.labels[2].occlusion, Occlusion::kHeavy);
  EXPECT_TRUE(recording.labels[2].truncated);
  ExpectBox(recording.labels[3], 1, -1, {40, 0, 20, 10}, 0);
  EXPECT_THAT(FindRecordings(folder.path()), ElementsAre(sequence));
  WriteText(truth / "M0101_gt_ignore.txt", "1,17,40,0,20,10,1,-1,-1\n9,17,40,0,20,10,1,-1,-1\n");
  EXPECT_THAT(OpenComplaint(sequence), HasSubstr("M0101_gt_ignore.txt:2: is of frame 9"));
  fs::remove(truth / "M0101_gt_ignore.txt");
  WriteText(truth / "M0101_gt_whole.txt", "1,1,14,7,10,5,1,1,4\n");
  EXPECT_THAT(OpenComplaint(sequence), HasSubstr("M0101_gt_whole.txt:1: there is no category 4"));
}

TEST(UavdtReader, SotHasOneBoxALine) {
  const ScratchFolder folder;
  const fs::path sequence = folder / "UAV-benchmark-S" / "S0101";
  WritePictures(sequence, "img", 6, ".jpg", 2);
  const fs::path truth = folder / "UAV-benchmark-SOT_v1.0" / "anno" / "S0101_gt.txt";
  WriteText(truth, "14,7,10,5\n15,7,10,5\n");
  const Recording recording = OpenRecording(sequence);
  EXPECT_EQ(recording.layout, "UAVDT SOT");
  EXPECT_EQ(recording.labelling, Labelling::kOneTarget);
  ASSERT_EQ(recording.labels.size(), 2U);
  ExpectBox(recording.labels[1], 2, 1, {15, 7, 10, 5}, 1);
  WriteText(truth, "14,7,10,5\n");
  EXPECT_THAT(OpenComplaint(sequence), HasSubstr("has 1 lines, but the recording has 2 frames"));
  WriteText(truth, "14,7,10,5\n\n14,7,10,5\n");
  EXPECT_THAT(OpenComplaint(sequence), HasSubstr("S0101_gt.txt:2: is blank"));
}

}  // namespace
}  // namespace windhover::replay
