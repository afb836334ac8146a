// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <string>

#include "service/app/option_settings.h"
#include "service/app/pending_file.h"
#include "service/gstreamer/source.h"
#include "service/options/option.h"
#include "service/options/options.h"
#include "service/options/overlay_options.h"
#include "service/options/publish_options.h"
#include "tests/service/app_process.h"

namespace windhover {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

void WriteFile(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

class SourceTest : public testing::Test {
 protected:
  void WriteSequence(const std::string& seqinfo, int pictures, const std::string& extension) {
    WriteFile(folder_ / "seq" / "seqinfo.ini", seqinfo);
    for (int number = 1; number <= pictures; ++number) {
      const std::string digits = std::to_string(1000000 + number).substr(1);
      WriteFile(folder_ / "seq" / "img1" / (digits + extension), "x");
    }
  }

  ScratchFolder folder_;
};

TEST_F(SourceTest, FileBecomesUri) {
  WriteFile(folder_ / "a flight.mp4", "x");
  const Source source = FindSource((folder_ / "a flight.mp4").string());
  EXPECT_EQ(source.uri, "file://" + folder_.path().string() + "/a%20flight.mp4");
  EXPECT_EQ(source.stem, "a flight");
  EXPECT_EQ(source.missing_bytes, 0);
}

TEST_F(SourceTest, UriStaysAsItIs) {
  const Source source = FindSource("rtsp://camera/live.sdp?x=1");
  EXPECT_EQ(source.uri, "rtsp://camera/live.sdp?x=1");
  EXPECT_EQ(source.stem, "live");
}

TEST_F(SourceTest, RefusesWhatIsNotThere) {
  EXPECT_THAT([&] { FindSource((folder_ / "none.mp4").string()); },
              ThrowsMessage<SourceError>(HasSubstr("none.mp4: no such file")));
  EXPECT_THAT([&] { FindSource("file://" + (folder_ / "none.mp4").string()); },
              ThrowsMessage<SourceError>(HasSubstr("no such file")));
}

TEST_F(SourceTest, RefusesEmptyFiles) {
  WriteFile(folder_ / "empty.mp4", "");
  EXPECT_THAT([&] { FindSource((folder_ / "empty.mp4").string()); },
              ThrowsMessage<SourceError>(HasSubstr("is empty")));
}

TEST_F(SourceTest, KnowsWhatAnAviFileLacks) {
  const std::string whole = std::string("RIFF\x10\x00\x00\x00", 8) + "AVI " + "123456789012";
  WriteFile(folder_ / "whole.avi", whole);
  WriteFile(folder_ / "cut.avi", whole.substr(0, 17));
  WriteFile(folder_ / "short.avi", "RIF");
  EXPECT_EQ(FindSource((folder_ / "whole.avi").string()).missing_bytes, 0);
  EXPECT_EQ(FindSource((folder_ / "cut.avi").string()).missing_bytes, 7);
  EXPECT_EQ(FindSource((folder_ / "short.avi").string()).missing_bytes, 0);
}

TEST_F(SourceTest, ReadsASequence) {
  WriteSequence(
      "[Sequence]\r\nname=seq\r\nimDir=img1\r\nframeRate = 12.5\r\nseqLength=3\r\n"
      "imExt=.jpg\r\n",
      3, ".jpg");
  const Source source = FindSource((folder_ / "seq").string() + "/");
  EXPECT_EQ(source.uri, "");
  EXPECT_EQ(source.stem, "seq");
  EXPECT_EQ(source.frames, 3);
  EXPECT_EQ(source.frame_rate_hz, 12.5);
  EXPECT_EQ(source.media_type, "image/jpeg");
  EXPECT_THAT(source.pattern, HasSubstr("/img1/%06d.jpg"));
}

TEST_F(SourceTest, RefusesBrokenSequences) {
  const std::string path = (folder_ / "seq").string();
  const std::string good = "frameRate=30\nseqLength=2\nimExt=.png\n";
  const auto refused_with = [&](const std::string& text) {
    EXPECT_THAT([&] { FindSource(path); }, ThrowsMessage<SourceError>(HasSubstr(text))) << text;
  };
  std::filesystem::create_directories(path);
  refused_with("without seqinfo.ini");
  WriteSequence(good, 1, ".png");
  refused_with("000002.png is missing");
  WriteSequence("frameRate=fast\nseqLength=1\n", 1, ".png");
  refused_with("must be numbers above 0");
  WriteSequence("frameRate=30\nseqLength=0\n", 1, ".png");
  refused_with("must be numbers above 0");
  WriteSequence("frameRate=30\nseqLength=1\nimExt=.bmp\n", 1, ".png");
  refused_with("'.bmp'");
}

TEST(OptionSettingTest, TakesWhatTheOptionsTake) {
  const OptionSetting setting = ParseOptionSetting("reference=centre");
  EXPECT_EQ(setting.name, "reference");
  EXPECT_EQ(setting.value, "centre");
  EXPECT_EQ(ParseOptionSetting("device=a:GPU:b=c").value, "a:GPU:b=c");
  EXPECT_EQ(ParseOptionSetting("stream=").value, "");
}

TEST(OptionSettingTest, RefusesTheRest) {
  EXPECT_THAT([] { ParseOptionSetting("threshold"); },
              ThrowsMessage<OptionError>(HasSubstr("option=value")));
  EXPECT_THAT([] { ParseOptionSetting("nonsense=1"); },
              ThrowsMessage<OptionError>(
                  testing::AllOf(HasSubstr("'nonsense'"), HasSubstr("threshold, tile-columns"))));
  EXPECT_THAT([] { ParseOptionSetting("threshold=0"); },
              ThrowsMessage<OptionError>(HasSubstr("1 to 255")));
  EXPECT_THAT([] { ParseOptionSetting("reference=middle"); },
              ThrowsMessage<OptionError>(HasSubstr("centre")));
}

TEST(OptionSettingTest, DescribesEveryOption) {
  const std::string text = "\n" + DescribeOptions();
  const auto expect_all_of = [&](const auto& options) {
    ForEachField<std::decay_t<decltype(options)>>([&](const auto& field) {
      const std::string name(field.name);
      EXPECT_THAT(text, HasSubstr("\n  " + name + "=" + OptionText(options, name) + "  ("));
      EXPECT_THAT(text, HasSubstr("\n      " + std::string(field.meaning) + "\n"));
    });
  };
  expect_all_of(DeviceOptions());
  expect_all_of(RegistrationOptions());
  expect_all_of(BackgroundOptions());
  expect_all_of(MotionOptions());
  expect_all_of(PublishOptions());
  expect_all_of(OverlayOptions());
}

TEST(PendingFileTest, LeavesNothingUnlessComplete) {
  ScratchFolder folder;
  {
    PendingFile file(folder / "a");
    std::ofstream(file.temporary()) << "half";
    EXPECT_THAT(folder.Names(), testing::ElementsAre(testing::MatchesRegex("a\\..*\\.part")));
  }
  EXPECT_THAT(folder.Names(), IsEmpty());
  {
    PendingFile file(folder / "a");
    std::ofstream(file.temporary()) << "whole";
    file.Complete();
  }
  EXPECT_THAT(folder.Names(), testing::ElementsAre("a"));
}

// As two runs into one folder write them.
TEST(PendingFileTest, TwoOfOneNameDoNotMeet) {
  ScratchFolder folder;
  const auto text = [&] {
    std::ifstream file(folder / "a");
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  PendingFile first(folder / "a");
  std::ofstream(first.temporary()) << "first";
  {
    PendingFile second(folder / "a");
    std::ofstream(second.temporary()) << "second";
    PendingFile third(folder / "a");
    std::ofstream(third.temporary()) << "third";
    second.Complete();
  }
  EXPECT_EQ(text(), "second");
  first.Complete();
  EXPECT_EQ(text(), "first");
  EXPECT_THAT(folder.Names(), testing::ElementsAre("a"));
}

}  // namespace
}  // namespace windhover
