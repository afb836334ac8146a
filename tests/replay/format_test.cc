// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <Eigen/LU>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "replay/format/frame_source.h"
#include "replay/format/homographies.h"
#include "replay/format/horizon.h"
#include "replay/format/labels.h"
#include "replay/format/pending_folder.h"
#include "replay/format/sequence.h"
#include "replay/format/text_lines.h"
#include "tests/replay/complaint.h"
#include "tests/service/app_process.h"

namespace windhover::replay {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string Content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(SequenceFormat, InfoComesBackAsWritten) {
  const ScratchFolder folder;
  SequenceInfo info;
  info.name = "01-outskirts";
  info.frame_rate_hz = 29.97;
  info.frames = 7;
  info.width = 640;
  info.height = 480;
  WriteSequenceInfo(folder.path(), info);
  const SequenceInfo read = ReadSequenceInfo(folder.path());
  EXPECT_EQ(read.name, info.name);
  EXPECT_EQ(read.frame_rate_hz, info.frame_rate_hz);
  EXPECT_EQ(read.frames, 7);
  EXPECT_EQ(read.width, 640);
  EXPECT_EQ(read.height, 480);
  EXPECT_EQ(FramePath("s", read, 12), std::filesystem::path("s/img1/000012.png"));
}

TEST(SequenceFormat, ReadsTheFilesThatOthersWrite) {
  const ScratchFolder folder;
  WriteText(folder.path() / "seqinfo.ini",
            "[Sequence]\r\nname=MOT17-02\r\nimDir=img1\r\nframeRate=30\r\nseqLength=600\r\n"
            "imWidth=1920\r\nimHeight=1080\r\nimExt=.jpg\r\n\r\n");
  const SequenceInfo info = ReadSequenceInfo(folder.path());
  EXPECT_EQ(info.frames, 600);
  EXPECT_EQ(FramePath(".", info, 600).filename(), "000600.jpg");
}

TEST(SequenceFormat, BadInfoIsNamedWithLineAndReason) {
  const ScratchFolder folder;
  EXPECT_THAT(Complaint([&] { ReadSequenceInfo(folder.path()); }), HasSubstr("cannot be read"));
  const auto complain = [&](const char* text) {
    WriteText(folder.path() / "seqinfo.ini", text);
    return Complaint([&] { ReadSequenceInfo(folder.path()); });
  };
  EXPECT_THAT(complain("[Sequence]\nseqLength=no\n"),
              AllOf(HasSubstr("seqinfo.ini:2:"), HasSubstr("'no'")));
  EXPECT_THAT(complain("[Sequence]\nnonsense\n"), HasSubstr("seqinfo.ini:2:"));
  EXPECT_THAT(complain("seqLength=5\nimWidth=4\n"), HasSubstr("imHeight is missing"));
  EXPECT_THAT(complain("frameRate=0\n"), HasSubstr(":1:"));
}

TEST(LabelFormat, BoxesAreOneBasedInTheFileAndZeroBasedInside) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "gt" / "gt.txt";
  WriteTruthBoxes(file, {{3, 17, {0, 9.5, 20, 10.25}, 1.0, 0.5}});
  EXPECT_EQ(Content(file), "3,17,1,10.5,20,10.25,1,1,0.5\n");
  const std::vector<LabelledBox> boxes = ReadBoxes(file);
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_EQ(boxes[0].frame, 3);
  EXPECT_EQ(boxes[0].id, 17);
  EXPECT_EQ(boxes[0].box.x, 0);
  EXPECT_EQ(boxes[0].box.y, 9.5);
  EXPECT_EQ(boxes[0].box.width, 20);
  EXPECT_EQ(boxes[0].box.height, 10.25);
  EXPECT_EQ(boxes[0].visible, 0.5);
}

TEST(LabelFormat, DetectionsHaveTenColumns) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "det.txt";
  WriteDetections(file, {{1, 2, {3, 4, 5, 6}, 0.25}});
  EXPECT_EQ(Content(file), "1,2,4,5,5,6,0.25,-1,-1,-1\n");
  EXPECT_EQ(ReadDetections(file).front().score, 0.25);
  // The form of the MOTChallenge's own public detections.
  WriteText(file,
            "1,-1,1359.1,413.27,120.26,362.77,2.3092\n\n2,-1,571.03,402.13,104.56,315.68,1.5\n");
  EXPECT_EQ(ReadDetections(file).size(), 2U);
}

TEST(LabelFormat, JsonLinesOfTheSubscriberAreRead) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "detections.jsonl";
  WriteText(file, R"({"type":"homography","stream":"a","frame":0})"
                  "\n"
                  R"({"type":"detections","stream":"a","frame":0,"detections":[]})"
                  "\n"
                  R"({"type":"detections","stream":"a","frame":1,"detections":[)"
                  R"({"track":5,"x":1.5,"y":2,"width":3,"height":4,"score":0.75}]})"
                  "\n"
                  R"({"type":"end","stream":"a","topic":"detections","reason":"ended"})"
                  "\n");
  const std::vector<LabelledBox> boxes = ReadDetections(file);
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_EQ(boxes[0].frame, 2);
  EXPECT_EQ(boxes[0].id, 5);
  EXPECT_EQ(boxes[0].box.x, 1.5);
  EXPECT_EQ(boxes[0].score, 0.75);
  WriteText(file, "{\"type\":\"detections\"\n");
  EXPECT_THAT(Complaint([&] { ReadDetections(file); }), HasSubstr("detections.jsonl:1:"));
  WriteText(file,
            "{\"type\":\"detections\",\"stream\":\"a\",\"frame\":0,\"detections\":[]}\n"
            "{\"type\":\"detections\",\"stream\":\"b\",\"frame\":0,\"detections\":[]}\n");
  EXPECT_THAT(Complaint([&] { ReadDetections(file); }),
              AllOf(HasSubstr("detections.jsonl:2:"), HasSubstr("second stream")));
}

TEST(LabelFormat, MalformedLinesAreNamedWithLineAndReason) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "gt.txt";
  const auto complain = [&](const char* text) {
    WriteText(file, text);
    return Complaint([&] { ReadBoxes(file); });
  };
  const char* good = "1,1,1,1,5,5,1\n";
  EXPECT_THAT(complain((std::string(good) + "1,2,3\n").c_str()),
              AllOf(HasSubstr("gt.txt:2:"), HasSubstr("got 3")));
  EXPECT_THAT(complain("1,1,1,one,5,5,1\n"), AllOf(HasSubstr(":1:"), HasSubstr("column 4")));
  EXPECT_THAT(complain("1,1,1,nan,5,5,1\n"), HasSubstr("column 4"));
  EXPECT_THAT(complain("0,1,1,1,5,5,1\n"), HasSubstr("frame number"));
  EXPECT_THAT(complain("1.5,1,1,1,5,5,1\n"), HasSubstr("frame number"));
  EXPECT_THAT(complain("1,1,1,1,0,5,1\n"), HasSubstr("above 0"));
  EXPECT_THAT(complain("1,1,1,1,5,5,\n"), HasSubstr("column 7"));
}

TEST(HomographyFormat, KeepsEveryBit) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "homography.txt";
  Eigen::Matrix3d matrix;
  matrix << 0.99 / 3, -1e-3 / 7, 12.1 / 9, 1.0 / 3, 1.01, -7e5 / 3, 1e-7 / 3, -2e-6 / 7, 1;
  WriteHomographies(file, {Eigen::Matrix3d::Identity(), matrix});
  const std::vector<Eigen::Matrix3d> read = ReadHomographies(file);
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0], Eigen::Matrix3d::Identity());
  EXPECT_EQ(read[1], matrix);
}

TEST(HomographyFormat, MalformedLinesAreNamedWithLineAndReason) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "homography.txt";
  const auto complain = [&](const char* text) {
    WriteText(file, text);
    return Complaint([&] { ReadHomographies(file); });
  };
  EXPECT_THAT(complain("1 1 0 0 0 1 0 0 0\n"), AllOf(HasSubstr(":1:"), HasSubstr("got 9")));
  EXPECT_THAT(complain("1 1 0 0 0 1 0 0 0 1\n3 1 0 0 0 1 0 0 0 1\n"),
              AllOf(HasSubstr(":2:"), HasSubstr("expected frame 2")));
  EXPECT_THAT(complain("1 1 0 0 0 x 0 0 0 1\n"), HasSubstr("column 6"));
  EXPECT_THAT(complain("1 0 0 0 0 1 0 0 0 1\n"), HasSubstr("inverse"));
}

// A sequence as the renderer leaves it.
void WriteRendered(const std::filesystem::path& sequence, const std::string& name) {
  SequenceInfo info;
  info.name = name;
  info.rendered_by = kRenderer;
  info.frames = 1;
  info.width = 32;
  info.height = 24;
  WriteSequenceInfo(sequence, info);
  WriteText(FramePath(sequence, info, 1), "a picture\n");
  WriteText(MoversPath(sequence), "");
  WriteText(DecoysPath(sequence), "");
  WriteText(HomographiesPath(sequence), "");
  WriteText(HorizonPath(sequence), "");
}

TEST(HorizonFormat, ComesBackAsWritten) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder / "horizon.txt";
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

TEST(PendingFolder, AppearsOnlyWhenComplete) {
  const ScratchFolder folder;
  const std::filesystem::path final_path = folder.path() / "flight";
  {
    const PendingFolder pending(final_path);
    WriteText(pending.path() / "seqinfo.ini", "half\n");
  }
  EXPECT_TRUE(folder.Names().empty());
  std::filesystem::create_directory(final_path);
  for (const char* name : {"first", "second"}) {
    PendingFolder pending(final_path / "");
    WriteRendered(pending.path(), name);
    pending.Commit();
    EXPECT_EQ(ReadSequenceInfo(final_path).name, name);
  }
  EXPECT_EQ(folder.Names(), std::vector<std::string>{"flight"});
}

TEST(PendingFolder, ReplacesWhatALinkLeadsTo) {
  const ScratchFolder folder;
  WriteRendered(folder / "flight", "first");
  std::filesystem::create_directory_symlink(folder / "flight", folder / "link");
  PendingFolder pending(folder / "link");
  WriteRendered(pending.path(), "second");
  pending.Commit();
  EXPECT_EQ(ReadSequenceInfo(folder / "flight").name, "second");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
}

TEST(PendingFolder, NeverReplacesWhatItHasNotRendered) {
  const ScratchFolder folder;
  const std::filesystem::path sequence = folder / "flight";
  const auto complain = [&] { return Complaint([&] { PendingFolder{sequence}; }); };
  WriteRendered(sequence, "ours");
  EXPECT_EQ(complain(), "(nothing thrown)");
  for (const char* file : {"notes.txt", "det/det.txt", "img1/notes.png", "img1/000001.jpg",
                           "img1/more/000002.png", "gt/boxes.txt"}) {
    WriteText(sequence / file, "mine\n");
    const std::string top = std::string(file).substr(0, std::string(file).rfind('/'));
    EXPECT_THAT(complain(), AllOf(HasSubstr("not replaced"), HasSubstr(top))) << file;
    EXPECT_EQ(Content(sequence / file), "mine\n");
    std::filesystem::remove(sequence / file);
    if (top == "det" || top == "img1/more") std::filesystem::remove(sequence / top);
    EXPECT_EQ(complain(), "(nothing thrown)") << file;
  }
  SequenceInfo others = ReadSequenceInfo(sequence);
  others.rendered_by.clear();
  WriteSequenceInfo(sequence, others);
  EXPECT_THAT(complain(), AllOf(HasSubstr("not replaced"), HasSubstr("renderedBy")));
  EXPECT_TRUE(std::filesystem::exists(FramePath(sequence, others, 1)));
}

// The number of a process that has ended.
pid_t DeadProcess() {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  return child;
}

TEST(PendingFolder, RemovesWhatKilledProgramsHaveLeft) {
  const ScratchFolder folder;
  const std::string dead = std::to_string(DeadProcess());
  WriteText(folder / (".flight.pending-" + dead) / "seqinfo.ini", "half\n");
  WriteText(folder / ".flight.pending-1" / "seqinfo.ini", "of a program that runs\n");
  WriteText(folder / (".flight.pending-" + dead + "a") / "letter.txt", "not ours\n");
  WriteText(folder / (".flight2.pending-" + dead) / "seqinfo.ini", "of another name\n");
  WriteRendered(folder / (".flight.old-" + dead), "moved away by a program that was killed then");
  { const PendingFolder pending(folder / "flight"); }
  EXPECT_THAT(folder.Names(), testing::UnorderedElementsAre("flight", ".flight.pending-1",
                                                            ".flight.pending-" + dead + "a",
                                                            ".flight2.pending-" + dead));
  EXPECT_THAT(ReadSequenceInfo(folder / "flight").name, HasSubstr("moved away"));
  WriteRendered(folder / (".flight.old-" + dead), "what has been replaced");
  { const PendingFolder pending(folder / "flight"); }
  EXPECT_FALSE(std::filesystem::exists(folder / (".flight.old-" + dead)));
  EXPECT_THAT(ReadSequenceInfo(folder / "flight").name, HasSubstr("moved away"));
}

TEST(PendingFolder, NeverReplacesWhatIsNoSequence) {
  const ScratchFolder folder;
  WriteText(folder.path() / "home" / "letter.txt", "dear\n");
  EXPECT_THAT(Complaint([&] { PendingFolder(folder.path() / "home"); }), HasSubstr("no sequence"));
  EXPECT_THAT(Complaint([&] { PendingFolder(folder.path() / "home" / "letter.txt"); }),
              HasSubstr("no folder"));
  EXPECT_EQ(Content(folder.path() / "home" / "letter.txt"), "dear\n");
}

TEST(FrameSource, NamesWhatIsMissingOrWrong) {
  const ScratchFolder folder;
  EXPECT_THAT(Complaint([&] { OpenFrames(folder.path() / "none"); }), HasSubstr("does not exist"));
  EXPECT_THAT(Complaint([&] { OpenFrames(folder.path()); }), HasSubstr("seqinfo.ini"));
  WriteText(folder.path() / "text.mp4", "no video\n");
  EXPECT_THAT(Complaint([&] { OpenFrames(folder.path() / "text.mp4"); }), HasSubstr("no video"));

  SequenceInfo info;
  info.frames = 3;
  info.width = 32;
  info.height = 24;
  WriteSequenceInfo(folder.path(), info);
  std::filesystem::create_directories(folder.path() / "img1");
  cv::imwrite(FramePath(folder.path(), info, 1).string(), cv::Mat(24, 32, CV_8UC3, cv::Scalar(7)));
  cv::imwrite(FramePath(folder.path(), info, 2).string(), cv::Mat(24, 30, CV_8UC3, cv::Scalar(7)));
  const std::unique_ptr<FrameSource> source = OpenFrames(folder.path());
  EXPECT_EQ(source->frames(), 3);
  EXPECT_EQ(source->Next().size(), cv::Size(32, 24));
  EXPECT_THAT(Complaint([&] { source->Next(); }),
              AllOf(HasSubstr("000002.png"), HasSubstr("30x24")));
  EXPECT_THAT(Complaint([&] { source->Next(); }),
              AllOf(HasSubstr("000003.png"), HasSubstr("missing")));
  EXPECT_TRUE(source->Next().empty());
}

}  // namespace
}  // namespace windhover::replay
