// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "replay/format/text_lines.h"
#include "replay/readers/mask_boxes.h"
#include "tests/replay/picture_folder.h"
#include "tests/replay/reader_checks.h"
#include "tests/service/app_process.h"

namespace windhover::replay {
namespace {

using testing::HasSubstr;

namespace fs = std::filesystem;

// . static, s shadow, o outside, u unknown, M moving.
cv::Mat MaskOf(const std::vector<std::string>& rows) {
  cv::Mat mask(static_cast<int>(rows.size()), static_cast<int>(rows.front().size()), CV_8UC1);
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = 0; x < mask.cols; ++x) {
      const char letter = rows[y][x];
      mask.at<unsigned char>(y, x) = letter == 's'   ? 50
                                     : letter == 'o' ? 85
                                     : letter == 'u' ? 170
                                     : letter == 'M' ? 255
                                                     : 0;
    }
  }
  return mask;
}

TEST(CdnetReader, ComponentsBecomeBoxes) {
  const std::vector<Label> labels = BoxesOfMask("gt.png",
                                                MaskOf({"ooo.........",  //
                                                        "ooo.uuuuu...",  //
                                                        "o...uMMMuss.",  //
                                                        "o...uMMMus..",  //
                                                        "o...uMMMu...",  //
                                                        "o...uuuuu..M"}),
                                                9);
  ASSERT_GE(labels.size(), 2U);
  ExpectBox(labels[0], 9, -1, {5, 2, 3, 3}, 1);
  ExpectBox(labels[1], 9, -1, {11, 5, 1, 1}, 0);
  double covered = 0;
  for (std::size_t i = 2; i < labels.size(); ++i) {
    EXPECT_EQ(labels[i].box.score, 0);
    covered += labels[i].box.box.width * labels[i].box.box.height;
    for (std::size_t other = 2; other < i; ++other) {
      const Box& a = labels[i].box.box;
      const Box& b = labels[other].box.box;
      EXPECT_FALSE(a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height &&
                   b.y < a.y + a.height);
    }
  }
  EXPECT_EQ(covered, 10 + 16);             // every o and u once
  EXPECT_EQ(labels.size(), 2U + 2U + 4U);  // two rectangles of o; top, left, right and bottom of u
}

TEST(CdnetReader, ReadsMasksWithinTheJudgedRange) {
  const ScratchFolder folder;
  const fs::path sequence = folder / "PTZ" / "continuousPan";
  WritePictures(sequence / "input", "in", 6, ".jpg", 3);
  fs::create_directories(sequence / "groundtruth");
  WriteText(sequence / "temporalROI.txt", "2 3\n");
  cv::Mat mask = cv::Mat::zeros(48, 64, CV_8UC1);
  mask(cv::Rect(10, 20, 6, 4)) = 255;
  ASSERT_TRUE(cv::imwrite((sequence / "groundtruth" / "gt000002.png").string(), mask));
  EXPECT_THAT(OpenComplaint(sequence), HasSubstr("gt000003.png: the mask is missing"));
  ASSERT_TRUE(cv::imwrite((sequence / "groundtruth" / "gt000003.png").string(), 0 * mask));
  const Recording recording = OpenRecording(sequence);
  EXPECT_EQ(recording.layout, "CDnet");
  EXPECT_EQ(recording.labelling, Labelling::kMovers);
  ASSERT_EQ(recording.labels.size(), 2U);
  ExpectBox(recording.labels[0], 1, -1, {0, 0, 64, 48}, 0);
  ExpectBox(recording.labels[1], 2, -1, {10, 20, 6, 4}, 1);
  mask.at<unsigned char>(0, 5) = 17;
  ASSERT_TRUE(cv::imwrite((sequence / "groundtruth" / "gt000002.png").string(), mask));
  EXPECT_THAT(OpenComplaint(sequence), HasSubstr("gt000002.png: has the value 17 at 5, 0"));
  WriteText(sequence / "temporalROI.txt", "2 4\n");
  EXPECT_THAT(OpenComplaint(sequence), HasSubstr("names pictures 2 to 4, but there are 1 to 3"));
  WriteText(sequence / "temporalROI.txt", "2\n");
  EXPECT_THAT(OpenComplaint(sequence), HasSubstr("temporalROI.txt:1:"));
}

}  // namespace
}  // namespace windhover::replay
