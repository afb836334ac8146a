// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

namespace windhover::replay {

// Each adds one subcommand to windhover-replay. What it does runs in the subcommand's final
// callback; an error is an exception with a text for people.
void AddRenderCommand(CLI::App& app);
void AddDetectCommand(CLI::App& app);
void AddInfoCommand(CLI::App& app);
void AddScoreCommand(CLI::App& app);
void AddBenchCommand(CLI::App& app);
void AddReportCommand(CLI::App& app);

}  // namespace windhover::replay
