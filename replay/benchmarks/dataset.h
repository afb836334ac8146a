// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "replay/benchmarks/benchmark_progress.h"

namespace windhover::replay {

// One sequence of a dataset: its folder's name is what it is called in figures.
struct DatasetSequence {
  std::string id;  // "01" to "10", "a1", "s1", ...
  std::filesystem::path folder;
};

// The sequences of a dataset, a folder of MOTChallenge folders (DIR/01 ... DIR/10), in the order of
// their names. Hidden folders and those without seqinfo.ini are none. Throws FormatError where
// there is no sequence.
std::vector<DatasetSequence> FindSequences(const std::filesystem::path& dataset);

// Names of the ten sequences of dataset B: "01" to "10".
const std::vector<std::string>& TenSequences();

// A line that names those of the ten that are not among `sequences` and says what follows; none
// where all are.
std::vector<std::string> AbsentSequences(const std::vector<DatasetSequence>& sequences);

// SHA-256, in hexadecimal, over all files of the sequences in the order of their paths: for each
// its path in the dataset, a zero byte, its size in decimal, a zero byte and its content.
std::string DatasetSha256(const std::vector<DatasetSequence>& sequences,
                          const BenchmarkProgress& progress);

}  // namespace windhover::replay
