// SPDX-License-Identifier: Apache-2.0
#include <glib.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <utility>
#include <vector>

#include "replay/benchmarks/figures.h"
#include "replay/benchmarks/sample_frames.h"
#include "replay/format/format_error.h"
#include "replay/format/text_lines.h"
#include "replay/report/measured_document.h"
#include "replay/report/page.h"
#include "replay/report/plot_scale.h"
#include "tests/replay/complaint.h"
#include "tests/service/app_process.h"

namespace windhover::replay {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;

// What a page consists of, in the order in which elements begin.
struct Element {
  std::string name;
  std::map<std::string, std::string> attributes;
  std::string text;  // directly in it
};

struct Elements {
  std::vector<Element> all;
  std::vector<std::size_t> open;

  std::vector<std::string> Texts(const std::string& name) const {
    std::vector<std::string> texts;
    for (const Element& element : all) {
      if (element.name == name) texts.push_back(element.text);
    }
    return texts;
  }
  std::size_t Count(const std::string& name) const { return Texts(name).size(); }
  std::size_t CountOfClass(const std::string& name) const {
    std::size_t count = 0;
    for (const Element& element : all) {
      const auto found = element.attributes.find("class");
      if (found != element.attributes.end() && found->second == name) ++count;
    }
    return count;
  }
};

void Begin(GMarkupParseContext*, const char* name, const char** names, const char** values,
           void* data, GError**) {
  auto& elements = *static_cast<Elements*>(data);
  Element element = {name, {}, {}};
  for (; *names != nullptr; ++names, ++values) element.attributes[*names] = *values;
  elements.open.push_back(elements.all.size());
  elements.all.push_back(std::move(element));
}

void End(GMarkupParseContext*, const char*, void* data, GError**) {
  static_cast<Elements*>(data)->open.pop_back();
}

void Text(GMarkupParseContext*, const char* text, std::size_t size, void* data, GError**) {
  auto& elements = *static_cast<Elements*>(data);
  if (!elements.open.empty()) elements.all[elements.open.back()].text.append(text, size);
}

// Fails where the page is not well-formed.
Elements Parse(const std::string& html) {
  const GMarkupParser parser = {Begin, End, Text, nullptr, nullptr};
  Elements elements;
  GMarkupParseContext* context =
      g_markup_parse_context_new(&parser, static_cast<GMarkupParseFlags>(0), &elements, nullptr);
  GError* error = nullptr;
  if (!g_markup_parse_context_parse(context, html.data(), static_cast<gssize>(html.size()),
                                    &error) ||
      !g_markup_parse_context_end_parse(context, &error)) {
    ADD_FAILURE() << error->message;
    g_error_free(error);
  }
  g_markup_parse_context_free(context);
  return elements;
}

BenchmarkDocument HandMade() {
  BenchmarkDocument document;
  document.device = "CPU <twin> & more";
  document.dataset_sha256 = "0123456789abcdef0123";
  document.options = {{"frames", "60"}, {"k", "10"}};
  document.figures = {{"registration.rms_px.01", 0.0625, "px"}, {"registration.failures", 3, ""}};
  document.tables = {{"registration.t",
                      "Table <1>",
                      {"sequence", "of", "windhover", "pairs"},
                      {{"01", "windhover", 0.1234567890123, 59}, {"01", "thesis", 0.5, {}}},
                      3,
                      true}};
  document.plots = {{"registration.t",
                     "A plot",
                     {"sequence", false, {"01", "02"}, {}},
                     {"RMS, px", true, {}, {}},
                     {{"", {{"windhover", false, {{0, 0.05, 0.09}, {1, 0, {}}}}}}}},
                    {"registration.curves",
                     "Curves",
                     {"recall, %", false, {}, {{0, 100}}},
                     {"precision, %", false, {}, {{0, 100}}},
                     {{"a", {{"FD", true, {{10, 90, {}}, {50, 40, {}}}}}}, {"b", {}}}}};
  document.samples = {{"01",
                       20,
                       64,
                       48,
                       "/9j/4A==",
                       {{"FD",
                         {{SampleFrame::Kind::kHit, {1, 2, 10, 5}},
                          {SampleFrame::Kind::kFalseAlarm, {30, 30, 4, 4}},
                          {SampleFrame::Kind::kFalseAlarm, {40, 30, 4, 4}}}},
                        {"windhover", {{SampleFrame::Kind::kMiss, {1, 2, 10, 5}}}}}}};
  document.left_out = {"figure 2.7: there is no a1"};
  return document;
}

class Report : public testing::Test {
 protected:
  std::filesystem::path Write(const std::string& name, const std::string& text) const {
    WriteText(folder_ / name, text);
    return folder_ / name;
  }
  MeasuredDocument Measured(const BenchmarkDocument& document) const {
    return ReadMeasured(Write("bench.json", JsonText(document)));
  }
  std::string ReadComplaint(const std::string& text) const {
    return Complaint([&] { ReadMeasured(Write("bench.json", text)); });
  }

  ScratchFolder folder_;
};

TEST_F(Report, ReadsWhatBenchWrites) {
  const MeasuredDocument read = Measured(HandMade());
  EXPECT_GE(read.machine.cores, 1);
  // All of the content, to the last digit.
  EXPECT_EQ(nlohmann::json::parse(JsonText(read.content)),
            nlohmann::json::parse(JsonText(HandMade())));
  EXPECT_EQ(read.content.tables[0].rows, HandMade().tables[0].rows);
}

TEST_F(Report, IsWellFormedAndLoadsNothing) {
  const std::string html = PageHtml({Measured(HandMade())});
  EXPECT_THAT(html, StartsWith("<!DOCTYPE html>"));
  const Elements page = Parse(html);
  EXPECT_EQ(page.Count("html"), 1);
  for (const Element& element : page.all) {
    EXPECT_THAT(element.name, Not(testing::AnyOf("script", "link", "iframe", "object", "img")));
    for (const auto& [name, value] : element.attributes) {
      EXPECT_NE(name, "src");
      EXPECT_THAT(value, Not(HasSubstr("://")));
      if (name == "href") {
        EXPECT_THAT(value, testing::AnyOf(StartsWith("#"), StartsWith("data:image/jpeg;base64,")));
      }
    }
  }
  ASSERT_THAT(page.Texts("style"), SizeIs(1));
  EXPECT_THAT(page.Texts("style")[0], AllOf(Not(HasSubstr("url(")), Not(HasSubstr("@import"))));
  // Text from the document is text in the page.
  EXPECT_THAT(page.Texts("td"), Contains("CPU <twin> & more"));
  EXPECT_THAT(page.Texts("caption"), Contains("Table <1>"));
}

TEST_F(Report, TablesHoldTheDocumentsNumbers) {
  const Elements page = Parse(PageHtml({Measured(HandMade())}));
  std::vector<double> values;
  for (const Element& element : page.all) {
    if (element.name == "data") values.push_back(*ParseNumber(element.attributes.at("value")));
  }
  EXPECT_THAT(values, ElementsAre(0.1234567890123, 59, 0.5));
  EXPECT_THAT(page.Texts("data"), ElementsAre("0.123", "59", "0.500"));
  EXPECT_EQ(page.CountOfClass("none"), 1);
  EXPECT_EQ(page.CountOfClass("best"), 1);  // a row's only number is not
  EXPECT_THAT(page.Texts("span"),
              AllOf(Contains("registration.rms_px.01"), Contains("0.0625 px"), Contains("3")));
  EXPECT_THAT(page.Texts("li"), ElementsAre("figure 2.7: there is no a1"));
}

TEST_F(Report, PlotsShowEveryPointThatTheirAxesCan) {
  const Elements page = Parse(PageHtml({Measured(HandMade())}));
  EXPECT_EQ(page.CountOfClass("plot"), 2);
  // The marker of 0.05 and that in the legend; a logarithmic axis has no place for 0.
  EXPECT_EQ(page.Count("circle"), 2);
  EXPECT_EQ(page.CountOfClass("whisker"), 2);
  EXPECT_EQ(page.CountOfClass("curve"), 1);
  EXPECT_THAT(page.Texts("text"), AllOf(Contains("RMS, px"), Contains("recall, %"),
                                        Contains("precision, %"), Contains("02"), Contains("b")));
}

TEST_F(Report, SamplesShowHitsFalseAlarmsAndMisses) {
  const Elements page = Parse(PageHtml({Measured(HandMade())}));
  // One more of each is in the legend.
  EXPECT_EQ(page.CountOfClass("mark hit"), 2);
  EXPECT_EQ(page.CountOfClass("mark false-alarm"), 3);
  EXPECT_EQ(page.CountOfClass("mark miss"), 2);
  EXPECT_EQ(page.Count("image"), 1);
  EXPECT_EQ(page.Count("use"), 1);
  EXPECT_THAT(page.Texts("p"), AllOf(Contains("FD: 1 hit, 2 false alarms, 0 misses"),
                                     Contains("windhover: 0 hits, 0 false alarms, 1 miss")));
}

TEST_F(Report, LeavesOutWhatADocumentDoesNotHave) {
  const std::string bare =
      R"({"machine": {"processor": "P", "cores": 2, "memory_gib": 8}, "device": "D",
          "dataset_sha256": null, "options": {},
          "figures": [{"name": "pipeline.fps.640x480", "value": 30, "unit": "frames/s"}]})";
  const Elements page = Parse(PageHtml({ReadMeasured(Write("speed.json", bare))}));
  EXPECT_EQ(page.Count("figure"), 0);
  EXPECT_EQ(page.Count("data"), 0);
  EXPECT_THAT(page.Texts("h2"), ElementsAre("Pipeline"));
  EXPECT_THAT(page.Texts("h3"), ElementsAre("All figures"));
}

TEST_F(Report, ErrorsNameTheFileAndWhatIsWrong) {
  EXPECT_THAT(ReadComplaint(""), AllOf(HasSubstr("bench.json: "), HasSubstr("parse error")));
  EXPECT_THAT(ReadComplaint("{\n\"machine\": {,"), HasSubstr("line 2"));
  EXPECT_THAT(ReadComplaint("[]"), HasSubstr("is no object"));
  EXPECT_THAT(ReadComplaint("{}"), HasSubstr("'machine'"));
  const nlohmann::json good = nlohmann::json::parse(JsonText(HandMade()));
  const auto with = [&](const char* place, const nlohmann::json& value) {
    nlohmann::json bad = good;
    bad[nlohmann::json::json_pointer(place)] = value;
    return ReadComplaint(bad.dump());
  };
  EXPECT_EQ(with("/device", "other"), "(nothing thrown)");
  EXPECT_THAT(with("/figures/0/value", "much"), HasSubstr("/figures/0/value"));
  EXPECT_THAT(with("/figures", 7), HasSubstr("figures is no list"));
  EXPECT_THAT(with("/tables/0/rows/0", {1, 2}), HasSubstr("row of 2 cells under 4 columns"));
  EXPECT_THAT(with("/tables/0/rows/0/2", true), HasSubstr("/tables/0/rows/0/2"));
  EXPECT_THAT(with("/plots/0/panels/0/series/0/points/0", {1}), HasSubstr("points/0"));
  EXPECT_THAT(with("/samples/0/views/0/marks/0/kind", "wonder"), HasSubstr("'wonder'"));
  EXPECT_THAT(with("/options/k", 10), HasSubstr("/options/k"));
  EXPECT_THROW(ReadMeasured(folder_ / "nowhere.json"), FormatError);
}

TEST_F(Report, RefusesAFigureMeasuredTwice) {
  const MeasuredDocument a = Measured(HandMade());
  MeasuredDocument b = a;
  b.file = "other.json";
  const auto complaint = [&] { return Complaint([&] { CheckNoFigureTwice({a, b}); }); };
  EXPECT_THAT(complaint(), AllOf(StartsWith("other.json: "), HasSubstr("registration.rms_px.01"),
                                 HasSubstr("bench.json"), HasSubstr("twice")));
  b.content.options[0].second = "all";
  EXPECT_THAT(complaint(), HasSubstr("different options"));
  b.content.dataset_sha256 = "f";
  EXPECT_THAT(complaint(), HasSubstr("different datasets"));
  b.machine.processor = "another";
  EXPECT_THAT(complaint(), HasSubstr("different machines"));
  for (Figure& figure : b.content.figures) figure.name = "motion." + figure.name;
  EXPECT_EQ(complaint(), "(nothing thrown)");
  EXPECT_THAT(Parse(PageHtml({a, b})).Texts("h2"), SizeIs(2));
}

TEST(PlotScale, HasRoundTicks) {
  const PlotScale linear({"", false, {}, {}}, {3, 87});
  std::vector<std::string> labels;
  for (const PlotTick& tick : linear.ticks()) labels.push_back(tick.label);
  EXPECT_THAT(labels, ElementsAre("0", "20", "40", "60", "80", "100"));
  EXPECT_THAT(linear.At(50), DoubleNear(0.5, 1e-12));

  const PlotScale logarithmic({"", true, {}, {}}, {0.03, 4, 0});
  labels.clear();
  for (const PlotTick& tick : logarithmic.ticks()) labels.push_back(tick.label);
  EXPECT_THAT(labels, ElementsAre("0.02", "0.05", "0.1", "0.2", "0.5", "1", "2", "5"));
  EXPECT_FALSE(logarithmic.Shows(0));
  EXPECT_THAT(logarithmic.At(0.02), DoubleNear(0, 1e-12));
  EXPECT_THAT(logarithmic.At(5), DoubleNear(1, 1e-12));

  const PlotScale categories({"", false, {"a", "b"}, {}}, {0, 1});
  EXPECT_THAT(categories.At(0), DoubleNear(0.25, 1e-12));
  EXPECT_EQ(categories.ticks()[1].label, "b");
}

TEST(PlotScale, HoldsAnyNumbers) {
  const std::vector<std::vector<double>> cases = {{},          {0},   {0, 0},         {1e-9},
                                                  {1e9, -1e9}, {100}, {0.001, 100000}};
  for (const bool log : {false, true}) {
    for (const std::vector<double>& values : cases) {
      const PlotScale scale({"", log, {}, {}}, values);
      EXPECT_THAT(scale.ticks(), Not(IsEmpty()));
      EXPECT_LE(scale.ticks().size(), 30);
      for (const double value : values) {
        if (!scale.Shows(value)) continue;
        EXPECT_GE(scale.At(value), -1e-9) << value;
        EXPECT_LE(scale.At(value), 1 + 1e-9) << value;
      }
    }
  }
}

TEST(SampleFrames, MarkWhatBecameOfEachBox) {
  EXPECT_TRUE(IsSample(20, 60));
  EXPECT_TRUE(IsSample(40, 60));
  EXPECT_FALSE(IsSample(0, 60));
  const cv::Mat picture(48, 64, CV_8UC3, cv::Scalar(10, 200, 30));
  const std::vector<LabelledBox> truth = {{7, 1, {0, 0, 10, 10}},
                                          {7, 2, {30, 30, 10, 10}},
                                          {7, 3, {50, 0, 8, 8}, 0},
                                          {8, 1, {0, 0, 10, 10}}};
  const std::vector<LabelledBox> found = {{7, -1, {1, 1, 10, 10}},
                                          {7, -1, {20, 0, 5, 5}},
                                          {7, -1, {50, 0, 8, 8}},
                                          {6, -1, {0, 0, 5, 5}}};
  const SampleFrame sample = MakeSample("03", 7, picture, truth, {{"ours", found}});
  EXPECT_EQ(sample.sequence, "03");
  ASSERT_THAT(sample.views, SizeIs(1));
  std::vector<std::pair<std::string, double>> marks;
  for (const SampleFrame::Mark& mark : sample.views[0].marks) {
    marks.emplace_back(NameOf(mark.kind), mark.box.x);
  }
  EXPECT_THAT(marks, testing::UnorderedElementsAre(std::pair("miss", 30.0), std::pair("hit", 1.0),
                                                   std::pair("false alarm", 20.0)));
  gsize size = 0;
  guchar* jpeg = g_base64_decode(sample.jpeg_base64.c_str(), &size);
  const cv::Mat decoded = cv::imdecode(std::vector<guchar>(jpeg, jpeg + size), cv::IMREAD_COLOR);
  g_free(jpeg);
  ASSERT_EQ(decoded.size(), picture.size());
  EXPECT_LT(cv::norm(decoded, picture, cv::NORM_INF), 4);
}

std::string Content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST_F(Report, IsACommand) {
  const std::string good = Write("a.json", JsonText(HandMade())).string();
  const std::filesystem::path page = folder_ / "out" / "index.html";
  const auto call = [&](const std::vector<std::string>& files) {
    std::vector<std::string> command = {WINDHOVER_REPLAY, "report", "--out",
                                        (folder_ / "out").string(), "--json"};
    command.insert(command.end(), files.begin(), files.end());
    return RunToEnd(command);
  };
  const Outcome done = call({good});
  EXPECT_EQ(done.exit_code, 0) << done.errors;
  EXPECT_THAT(done.lines, ElementsAre(page.string()));
  const std::string html = Content(page);
  EXPECT_EQ(Parse(html).Count("section"), 1);

  const Outcome twice = call({good, good});
  EXPECT_EQ(twice.exit_code, 1);
  EXPECT_THAT(twice.errors, HasSubstr("measured twice"));
  const Outcome malformed = call({Write("b.json", "{").string()});
  EXPECT_EQ(malformed.exit_code, 1);
  EXPECT_THAT(malformed.errors, AllOf(HasSubstr("b.json"), Not(HasSubstr("terminate"))));
  // The last good page stands, and nothing beside it.
  EXPECT_EQ(Content(page), html);
  const std::filesystem::directory_iterator entries(folder_ / "out");
  EXPECT_EQ(std::distance(begin(entries), end(entries)), 1);
}

}  // namespace
}  // namespace windhover::replay
