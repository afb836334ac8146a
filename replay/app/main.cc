// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <opencv2/core/utils/logger.hpp>

#include "replay/app/commands.h"
#include "replay/app/interrupt.h"

int main(int argc, char** argv) {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_ERROR);
  CLI::App app("Flights with exact truth, scores and benchmarks for Windhover", "windhover-replay");
  app.set_version_flag("--version", "windhover-replay " WINDHOVER_VERSION);
  app.require_subcommand(1);
  windhover::replay::AddRenderCommand(app);
  windhover::replay::AddInfoCommand(app);
  windhover::replay::AddDetectCommand(app);
  windhover::replay::AddScoreCommand(app);
  windhover::replay::AddBenchCommand(app);
  windhover::replay::AddReportCommand(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const windhover::replay::Interrupted& interrupted) {
    std::fprintf(stderr, "\nwindhover-replay: %s\n", interrupted.what());
    return 130;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "windhover-replay: %s\n", error.what());
    return 1;
  }
  return 0;
}
