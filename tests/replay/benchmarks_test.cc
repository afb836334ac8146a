// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "replay/benchmarks/dataset.h"
#include "replay/benchmarks/figures.h"
#include "replay/format/format_error.h"
#include "replay/format/text_lines.h"
#include "tests/replay/benchmark_fixtures.h"
#include "tests/service/app_process.h"

namespace windhover::replay {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Figures, BecomeOneDocument) {
  BenchmarkDocument document;
  document.device = "CPU twin";
  document.options = {{"k", "10"}};
  AddFigure(document.figures, "a.b", 1.5, "px");
  AddFigure(document.figures, "a.c", std::nullopt, "px");
  document.tables = {{"t", "A table", {"", "x", "n"}, {{"row", 2.25, 3}, {"other", {}, {}}}, 1}};
  document.left_out = {"the rest"};
  const auto json = nlohmann::json::parse(JsonText(document));
  EXPECT_GE(json["machine"]["cores"], 1);
  EXPECT_GT(json["machine"]["memory_gib"], 0);
  EXPECT_FALSE(json["machine"]["processor"].get<std::string>().empty());
  EXPECT_EQ(json["device"], "CPU twin");
  EXPECT_TRUE(json["dataset_sha256"].is_null());
  EXPECT_EQ(json["options"]["k"], "10");
  ASSERT_EQ(json["figures"].size(), 1);
  EXPECT_EQ(json["figures"][0], nlohmann::json({{"name", "a.b"}, {"value", 1.5}, {"unit", "px"}}));
  EXPECT_EQ(json["tables"][0]["columns"], nlohmann::json({"", "x", "n"}));
  EXPECT_EQ(json["tables"][0]["rows"][0], nlohmann::json({"row", 2.25, 3}));
  EXPECT_EQ(json["tables"][0]["rows"][1], nlohmann::json({"other", nullptr, nullptr}));
  EXPECT_EQ(json["left_out"], nlohmann::json({"the rest"}));
  EXPECT_EQ(TableText(document.tables[0]),
            "A table\n"
            "         x  n\n"
            "row    2.2  3\n"
            "other    -  -\n");
}

TEST(Figures, ThatAreNoNumbersAreRefused) {
  BenchmarkDocument document;
  AddFigure(document.figures, "a", std::numeric_limits<double>::infinity());
  EXPECT_THROW(JsonText(document), std::invalid_argument);
  document.figures.clear();
  document.tables = {{"t", "A table", {"x", "y"}, {{1.0}}, 1}};
  EXPECT_THROW(JsonText(document), std::invalid_argument);
}

TEST(Dataset, IsFoundAndHasOneChecksum) {
  const ScratchFolder folder;
  EXPECT_THROW(FindSequences(folder.path()), FormatError);
  EXPECT_THROW(FindSequences(folder.path() / "nowhere"), FormatError);
  for (const char* file : {"02/seqinfo.ini", "01/seqinfo.ini", "01/gt/gt.txt", "notes/text",
                           ".01.pending-1/seqinfo.ini"}) {
    WriteText(folder.path() / file, "text of " + std::string(file));
  }
  const std::vector<DatasetSequence> sequences = FindSequences(folder.path());
  ASSERT_EQ(sequences.size(), 2);
  EXPECT_EQ(sequences[0].id, "01");
  EXPECT_EQ(sequences[1].folder, folder.path() / "02");
  EXPECT_THAT(AbsentSequences(sequences), ElementsAre(HasSubstr("no 03, 04, 05")));

  // By sha256sum, of "01/gt/gt.txt", 0, "20", 0, "text of 01/gt/gt.txt", "01/seqinfo.ini", 0, ...
  const std::string sum = DatasetSha256(sequences, kSilent);
  EXPECT_EQ(sum, "cebec5fd566c9808d6bcc0beb08f421b8a3ed4c02b45258d2d5f7dd6121e748c");
  WriteText(folder.path() / "notes/text", "other");
  EXPECT_EQ(DatasetSha256(sequences, kSilent), sum);
  WriteText(folder.path() / "01/gt/gt.txt", "text of 01/gt/gt.tyt");
  EXPECT_NE(DatasetSha256(sequences, kSilent), sum);
}

TEST(Dataset, AnInterruptEndsTheChecksum) {
  const ScratchFolder folder;
  WriteText(folder.path() / "01/seqinfo.ini", "text");
  const BenchmarkProgress interrupted = {[](const std::string&) {},
                                         [] { throw std::runtime_error("interrupted"); }};
  EXPECT_THROW(DatasetSha256(FindSequences(folder.path()), interrupted), std::runtime_error);
}

}  // namespace
}  // namespace windhover::replay
