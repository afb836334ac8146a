// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "replay/benchmarks/figures.h"
#include "replay/benchmarks/machine.h"

namespace windhover::replay {

// What `bench ... --json FILE` has written.
struct MeasuredDocument {
  std::filesystem::path file;
  MachineInfo machine;
  BenchmarkDocument content;
};

// Throws FormatError with what is wrong and where in the document. Documents may lack tables,
// plots, samples and what was left out.
MeasuredDocument ReadMeasured(const std::filesystem::path& file);

// Throws FormatError where two documents have a figure of the same name: which of the two holds,
// nobody knows. The text says in what they differ.
void CheckNoFigureTwice(const std::vector<MeasuredDocument>& documents);

}  // namespace windhover::replay
