// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "replay/format/text_lines.h"
#include "tests/replay/picture_folder.h"
#include "tests/replay/reader_checks.h"
#include "tests/service/app_process.h"

namespace windhover::replay {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

namespace fs = std::filesystem;

TEST(VisDroneReader, ReadsTenColumns) {
  const ScratchFolder folder;
  const fs::path sequence = folder / "sequences" / "uav0000013_00000_v";
  WritePictures(sequence, "", 7, ".jpg", 2);
  const fs::path annotation = folder / "annotations" / "uav0000013_00000_v.txt";
  WriteText(annotation,
            "1,0,0,20,17,19,1,4,0,0\n2,0,4,20,17,19,1,4,1,2\n1,3,30,8,4,9,1,1,0,1\n"
            "1,5,2,2,40,10,0,0,0,0\n1,6,50,30,6,5,0,11,0,0\n2,7,50,30,6,0,1,4,0,0\n");
  const Recording recording = OpenRecording(sequence);
  EXPECT_EQ(recording.layout, "VisDrone");
  EXPECT_EQ(recording.name, "uav0000013_00000_v");
  EXPECT_EQ(recording.frames, 2);
  EXPECT_EQ(recording.width, 64);
  EXPECT_FALSE(recording.frame_rate_hz);
  EXPECT_EQ(recording.labelling, Labelling::kObjects);
  ASSERT_EQ(recording.labels.size(), 5U);
  ExpectBox(recording.labels[0], 1, 0, {0, 20, 17, 19}, 1);
  EXPECT_EQ(recording.labels[0].category, "car");
  EXPECT_TRUE(recording.labels[1].truncated);
  EXPECT_EQ(recording.labels[1].occlusion, Occlusion::kHeavy);
  EXPECT_EQ(recording.labels[2].occlusion, Occlusion::kPartial);
  ExpectBox(recording.labels[3], 1, -1, {2, 2, 40, 10}, 0);
  EXPECT_EQ(recording.labels[3].category, "ignored region");
  ExpectBox(recording.labels[4], 1, 6, {50, 30, 6, 5}, 0);
  EXPECT_THAT(recording.notes, ElementsAre(HasSubstr("1 boxes have no area")));
  EXPECT_EQ(CountFrames(recording), 2);
  EXPECT_THAT(FindRecordings(folder.path()), ElementsAre(sequence));

  const auto complain = [&](const char* text) {
    WriteText(annotation, text);
    return OpenComplaint(sequence);
  };
  const char* good = "1,0,0,20,17,19,1,4,0,0\n";
  EXPECT_THAT(
      complain("1,0,0,20,17,19,1,4,0,0\n1,0,0,20,17,19,1,4\n"),
      AllOf(HasSubstr("uav0000013_00000_v.txt:2:"), HasSubstr("expected 10 columns, got 8")));
  EXPECT_THAT(complain("1,0,x,20,17,19,1,4,0,0\n"), AllOf(HasSubstr(":1:"), HasSubstr("'x'")));
  EXPECT_THAT(complain("3,0,0,20,17,19,1,4,0,0\n"), HasSubstr("is of frame 3, but"));
  EXPECT_THAT(complain("1,0,0,20,17,19,1,12,0,0\n"), HasSubstr("no category 12"));
  EXPECT_THAT(complain("1,0,0,20,-17,19,1,4,0,0\n"), HasSubstr("must not be below 0"));
  EXPECT_EQ(complain(good), "(nothing thrown)");
  WritePictures(sequence, "", 7, ".jpg", 1, 4);
  EXPECT_THAT(OpenComplaint(sequence), HasSubstr("picture 3 is missing before 0000004.jpg"));
}

}  // namespace
}  // namespace windhover::replay
