// SPDX-License-Identifier: Apache-2.0
#include "replay/app/rendered_dataset.h"

#include <cstdlib>
#include <string>
#include <system_error>

#include "replay/app/render_sequences.h"

namespace windhover::replay {

namespace fs = std::filesystem;

void RemoveFolder::operator()(const fs::path* folder) const {
  std::error_code ignored;
  fs::remove_all(*folder, ignored);
  delete folder;
}

TemporaryFolder RenderDataset(int frames) {
  std::string name = (fs::temp_directory_path() / "windhover-dataset-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) {
    throw std::system_error(errno, std::generic_category(), name);
  }
  TemporaryFolder folder(new fs::path(name));
  RenderSettings settings;
  settings.sequences = "all,a1,a2,a3,a4,s1";
  settings.out = *folder;
  settings.frames = frames;
  RenderSequences(settings, [](const fs::path&) {});
  return folder;
}

}  // namespace windhover::replay
