// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "replay/format/format_error.h"
#include "replay/format/homographies.h"
#include "replay/format/horizon.h"
#include "replay/format/sequence.h"
#include "replay/format/text_lines.h"
#include "replay/readers/mask_boxes.h"
#include "replay/readers/recording.h"
#include "replay/readers/voc_annotation.h"
#include "tests/replay/picture_folder.h"
#include "tests/service/app_process.h"

// Each set in its own layout, by hand.

namespace windhover::replay {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

namespace fs = std::filesystem;

// The text of the FormatError that `action` throws.
template <typename Action>
std::string Complaint(Action&& action) {
  try {
    action();
  } catch (const FormatError& error) {
    return error.what();
  }
  return "(nothing thrown)";
}

std::string OpenComplaint(const fs::path& path) {
  return Complaint([&] { OpenRecording(path); });
}

void ExpectBox(const Label& label, int frame, std::int64_t id, const Box& box, double score) {
  EXPECT_EQ(label.box.frame, frame);
  EXPECT_EQ(label.box.id, id);
  EXPECT_EQ(label.box.box.x, box.x);
  EXPECT_EQ(label.box.box.y, box.y);
  EXPECT_EQ(label.box.box.width, box.width);
  EXPECT_EQ(label.box.box.height, box.height);
  EXPECT_EQ(label.box.score, score);
}

int CountFrames(const Recording& recording) {
  const std::unique_ptr<FrameSource> source = recording.open_frames();
  int frames = 0;
  while (!source->Next().empty()) ++frames;
  return frames;
}

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

std::string VocText(const std::string& objects) {
  return "<annotation>\n  <folder></folder>\n  <filename>frame0001.jpg</filename>\n  <size>\n"
         "    <width>64</width>\n    <height>48</height>\n    <depth></depth>\n  </size>\n"
         "  <segmented>0</segmented>\n" +
         objects + "</annotation>\n";
}

std::string VocObjectText(const std::string& box) {
  return "  <object>\n    <name>motion</name>\n    <occluded>1</occluded>\n    <bndbox>\n" + box +
         "    </bndbox>\n  </object>\n";
}

constexpr const char* kVocBox =
    "      <xmin>8.0</xmin>\n      <ymin>4.5</ymin>\n      <xmax>30.0</xmax>\n"
    "      <ymax>19.0</ymax>\n";

TEST(PesmodReader, ReadsAPascalVocFileAPicture) {
  const ScratchFolder folder;
  const fs::path sequence = folder / "Pexels-Welton";
  WritePictures(sequence / "images", "frame", 4, ".jpg", 3);
  const fs::path annotations = sequence / "annotations";
  WriteText(annotations / "frame0001.xml",
            VocText(VocObjectText(kVocBox) + VocObjectText(kVocBox)));
  WriteText(annotations / "frame0003.xml", VocText(""));
  const Recording recording = OpenRecording(sequence);
  EXPECT_EQ(recording.layout, "PESMOD");
  EXPECT_EQ(recording.labelling, Labelling::kMovers);
  ASSERT_EQ(recording.labels.size(), 2U);
  ExpectBox(recording.labels[1], 1, -1, {8, 4.5, 22, 14.5}, 1);
  EXPECT_EQ(recording.labels[1].category, "motion");
  EXPECT_EQ(recording.labels[1].occlusion, Occlusion::kPartial);
  EXPECT_THAT(recording.notes, ElementsAre(HasSubstr("1 pictures have no annotation")));
  EXPECT_EQ(CountFrames(recording), 3);

  WriteText(annotations / "frame0004.xml", VocText(""));
  EXPECT_THAT(OpenComplaint(sequence), HasSubstr("frame0004.xml: its picture is missing"));
  fs::remove(annotations / "frame0004.xml");
  WritePicture(sequence / "images" / "frame0001.jpg", 32, 48);
  EXPECT_THAT(OpenComplaint(sequence), HasSubstr("of a picture of 64x48 px"));
}

TEST(PesmodReader, MalformedXmlIsNamedByLine) {
  const ScratchFolder folder;
  const fs::path file = folder / "frame0001.xml";
  const auto complain = [&](const std::string& text) {
    WriteText(file, text);
    return Complaint([&] { ReadVoc(file); });
  };
  EXPECT_THAT(complain(VocText(VocObjectText("      <xmin>eight</xmin>\n"))),
              AllOf(HasSubstr("frame0001.xml:14:"), HasSubstr("xmin is no number: 'eight'")));
  EXPECT_THAT(complain(VocText(VocObjectText("      <xmin>8</xmin>\n"))),
              HasSubstr("an object lacks xmin, ymin, xmax or ymax"));
  EXPECT_THAT(complain("<annotation>\n  <object>\n</annotation>\n"), HasSubstr("frame0001.xml:3:"));
  EXPECT_THAT(complain("<annotation>\n  <object>\n"), HasSubstr("frame0001.xml:"));
  EXPECT_THAT(complain(""), HasSubstr("frame0001.xml:"));
  EXPECT_THAT(complain("<svg></svg>"), HasSubstr("the outermost element is 'svg'"));
  EXPECT_EQ(
      complain("<?xml version=\"1.0\"?>\n<!-- by hand -->\n" + VocText(VocObjectText(kVocBox))),
      "(nothing thrown)");
}

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

TEST(HorizonFormat, ComesBackAsWritten) {
  const ScratchFolder folder;
  const fs::path file = folder / "horizon.txt";
  WriteHorizons(file, {{0.6, 0.8, -120.25}, {0, 1, -3}});
  const std::vector<Eigen::Vector3d> read = ReadHorizons(file);
  ASSERT_EQ(read.size(), 2U);
  EXPECT_TRUE(read[0].isApprox(Eigen::Vector3d(0.6, 0.8, -120.25), 1e-15));
  const auto complain = [&](const char* text) {
    WriteText(file, text);
    return Complaint([&] { ReadHorizons(file); });
  };
  EXPECT_THAT(complain("1 0 1 -3\n3 0 1 -3\n"), HasSubstr("horizon.txt:2: expected frame 2"));
  EXPECT_THAT(complain("1 0 0 -3\n"), HasSubstr("a and b"));
  EXPECT_THAT(complain("1 0 1\n"), HasSubstr("expected 4 columns, got 3"));
}

}  // namespace
}  // namespace windhover::replay
