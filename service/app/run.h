// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "service/app/option_settings.h"

namespace windhover {

struct RunOptions {
  std::string source;  // see FindSource
  std::string out = "out";
  bool video = true;   // write annotated.mp4
  std::string device;  // see Backend::Create
  std::vector<OptionSetting> settings;
};

// The main job: source -> GStreamer pipeline -> DDS -> a subscriber process of its own. Writes
// detections.jsonl, as received over DDS, and annotated.mp4 into the folder `out`, each under a
// temporary name until it is complete; shows progress on the standard error and ends with one line
// on the standard output. An interrupt ends the video early and cleanly; another one, or one before
// the first frame, ends at once.
// Returns the exit code. Throws SourceError, DeviceError, or std::runtime_error with one line of
// text where the job cannot be done.
int Run(const RunOptions& options);

}  // namespace windhover
