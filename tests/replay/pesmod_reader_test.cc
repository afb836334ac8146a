// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "replay/format/text_lines.h"
#include "replay/readers/voc_annotation.h"
#include "tests/replay/picture_folder.h"
#include "tests/replay/reader_checks.h"
#include "tests/service/app_process.h"

namespace windhover::replay {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

namespace fs = std::filesystem;

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

}  // namespace
}  // namespace windhover::replay
