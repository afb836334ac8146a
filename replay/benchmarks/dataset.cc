// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/dataset.h"

#include <glib.h>

#include <algorithm>
#include <fstream>
#include <memory>

#include "replay/format/format_error.h"

namespace windhover::replay {
namespace {

namespace fs = std::filesystem;

struct FreeChecksum {
  void operator()(GChecksum* checksum) const { g_checksum_free(checksum); }
};
using Checksum = std::unique_ptr<GChecksum, FreeChecksum>;

void Update(GChecksum* checksum, const char* data, std::size_t size) {
  g_checksum_update(checksum, reinterpret_cast<const guchar*>(data), static_cast<gssize>(size));
}

// With its terminating zero byte.
void UpdateText(GChecksum* checksum, const std::string& text) {
  Update(checksum, text.c_str(), text.size() + 1);
}

void UpdateFile(GChecksum* checksum, const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw FormatError(file, "cannot be read");
  std::vector<char> block(std::size_t{1} << 20);
  while (in) {
    in.read(block.data(), static_cast<std::streamsize>(block.size()));
    Update(checksum, block.data(), static_cast<std::size_t>(in.gcount()));
  }
  if (in.bad()) throw FormatError(file, "cannot be read");
}

}  // namespace

std::vector<DatasetSequence> FindSequences(const fs::path& dataset) {
  std::vector<DatasetSequence> sequences;
  std::error_code error;
  for (fs::directory_iterator it(dataset, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (name.front() == '.' || !fs::exists(it->path() / "seqinfo.ini")) continue;
    sequences.push_back({name, it->path()});
  }
  if (error) throw FormatError(dataset, error.message());
  if (sequences.empty()) {
    throw FormatError(dataset,
                      "holds no sequence; 'windhover-replay render --sequence all' makes ten");
  }
  std::sort(sequences.begin(), sequences.end(),
            [](const DatasetSequence& a, const DatasetSequence& b) { return a.id < b.id; });
  return sequences;
}

const std::vector<std::string>& TenSequences() {
  static const std::vector<std::string> names = {"01", "02", "03", "04", "05",
                                                 "06", "07", "08", "09", "10"};
  return names;
}

std::vector<std::string> AbsentSequences(const std::vector<DatasetSequence>& sequences) {
  std::string absent;
  for (const std::string& id : TenSequences()) {
    const bool found = std::any_of(sequences.begin(), sequences.end(),
                                   [&](const DatasetSequence& one) { return one.id == id; });
    if (!found) absent += (absent.empty() ? "" : ", ") + id;
  }
  if (absent.empty()) return {};
  return {"figures over the ten sequences: there is no " + absent};
}

std::string DatasetSha256(const std::vector<DatasetSequence>& sequences,
                          const BenchmarkProgress& progress) {
  const Checksum checksum(g_checksum_new(G_CHECKSUM_SHA256));
  for (const DatasetSequence& sequence : sequences) {
    std::vector<std::string> files;  // relative to the sequence's folder
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(sequence.folder)) {
      if (!entry.is_regular_file()) continue;
      files.push_back(entry.path().lexically_relative(sequence.folder).generic_string());
    }
    std::sort(files.begin(), files.end());
    for (const std::string& file : files) {
      progress.check();
      UpdateText(checksum.get(), sequence.id + "/" + file);
      UpdateText(checksum.get(), std::to_string(fs::file_size(sequence.folder / file)));
      UpdateFile(checksum.get(), sequence.folder / file);
    }
  }
  return g_checksum_get_string(checksum.get());
}

}  // namespace windhover::replay
