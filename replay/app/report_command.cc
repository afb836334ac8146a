// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

#include "replay/app/commands.h"
#include "replay/format/text_lines.h"
#include "replay/report/measured_document.h"
#include "replay/report/page.h"

namespace windhover::replay {
namespace {

struct ReportSettings {
  std::vector<std::filesystem::path> files;
  std::filesystem::path out;
};

void Report(const ReportSettings& settings) {
  std::vector<MeasuredDocument> documents;
  for (const std::filesystem::path& file : settings.files) documents.push_back(ReadMeasured(file));
  CheckNoFigureTwice(documents);
  const std::filesystem::path page = settings.out / "index.html";
  WriteText(page, PageHtml(documents));
  std::printf("%s\n", page.string().c_str());
}

}  // namespace

void AddReportCommand(CLI::App& app) {
  auto settings = std::make_shared<ReportSettings>();
  CLI::App* command = app.add_subcommand(
      "report", "One HTML page with tables, plots and sample frames of what 'bench' has measured");
  command->add_option("--json", settings->files, "Files that 'bench ... --json FILE' has written")
      ->required();
  command->add_option("--out", settings->out, "Folder for index.html")->required();
  command->final_callback([settings] { Report(*settings); });
}

}  // namespace windhover::replay
