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

TEST(Uav123Reader, PartsOfOneFolderStandInTheList) {
  const ScratchFolder folder;
  const fs::path pictures = folder / "data_seq" / "UAV123" / "bird1";
  WritePictures(pictures, "", 6, ".jpg", 6);
  const fs::path annotation = folder / "anno" / "UAV123" / "bird1_2.txt";
  WriteText(annotation, "NaN,NaN,NaN,NaN\n14,7,10,5\n15,7,10,5\n");
  EXPECT_THAT(OpenComplaint(annotation),
              AllOf(HasSubstr("has 3 lines, but there are 6 pictures"), HasSubstr("configSeqs.m")));
  WriteText(
      folder / "configSeqs.m",
      "function seqs=configSeqs(type)\nseqUAV123_10fps={"
      "struct('name','bird1_2','path','D:\\data_seq\\bird1\\','startFrame',1,'endFrame',2)};\n"
      "seqUAV123={struct('name','bird1_1','path','D:\\data_seq\\bird1\\','startFrame',1,"
      "'endFrame',2,'nz',6,'ext','jpg','init_rect',[0,0,0,0]),...\n"
      "struct('name','bird1_2','path','D:\\data_seq\\UAV123\\bird1\\','startFrame',3,"
      "'endFrame',5,'nz',6,'ext','jpg','init_rect',[0,0,0,0])};\n");
  WritePicture(pictures / "000003.jpg", 64, 48, 33);
  const Recording recording = OpenRecording(annotation);
  EXPECT_EQ(recording.name, "bird1_2");
  EXPECT_EQ(recording.layout, "UAV123");
  EXPECT_EQ(recording.frames, 3);
  EXPECT_EQ(recording.frame_rate_hz, 30);
  ASSERT_EQ(recording.labels.size(), 2U);
  ExpectBox(recording.labels[0], 2, 1, {14, 7, 10, 5}, 1);
  EXPECT_NEAR(recording.open_frames()->Next().at<cv::Vec3b>(0, 0)[0], 33, 2);
  EXPECT_EQ(CountFrames(recording), 3);
  EXPECT_THAT(FindRecordings(folder.path()), ElementsAre(annotation));

  WriteText(annotation, "14,7,10,5\nNaN,7,10,5\n15,7,10,5\n");
  EXPECT_THAT(OpenComplaint(annotation), HasSubstr("bird1_2.txt:2: column 1 is no number: 'NaN'"));
  fs::remove(pictures / "000004.jpg");
  EXPECT_THAT(OpenComplaint(annotation), HasSubstr("picture 4 is missing"));
}

TEST(Uav123Reader, AFolderOfPicturesIsEnough) {
  const ScratchFolder folder;
  const fs::path pictures = folder / "data_seq" / "UAV123_10fps" / "bike1";
  WritePictures(pictures, "", 6, ".jpg", 2);
  WriteText(folder / "anno" / "UAV123_10fps" / "bike1.txt", "14,7,10,5\n15,7,10,5\n");
  const Recording recording = OpenRecording(pictures);
  EXPECT_EQ(recording.frame_rate_hz, 10);
  EXPECT_EQ(recording.labels.size(), 2U);
}

}  // namespace
}  // namespace windhover::replay
