// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "replay/offline/frame_outcome.h"
#include "replay/offline/pipeline_run.h"

namespace windhover::replay {

// Reads "name=value" and checks it. Throws OptionError where the text is not of that form, no
// element here has an option of that name, or the value does not fit.
PipelineOption ParsePipelineOption(const std::string& assignment);

struct DetectionSettings {
  std::vector<PipelineOption> options;
  int frames = 0;               // at most, from the start; 0: all
  std::filesystem::path video;  // where to write the annotated video; empty: nowhere
};

// How far a run has come.
struct DetectionState {
  int frames = 0;   // that have come out
  int to_come = 0;  // in all; 0 where nothing says. A video's word may be an estimate
};

// Both are called on the caller's own thread and may throw, which ends the run.
struct DetectionWatch {
  // About ten times a second, and after the last frame.
  std::function<void(const DetectionState&)> progress;
  // The device that is computed on, and warnings.
  std::function<void(const std::string& line)> say;
};

// The product's own pipeline (whregister ! queue ! whbackground ! queue ! whmotion) on a sequence
// folder, a video or a folder with one video, as fast as it can: one outcome for each frame, the
// same ones for the same frames. Pictures and videos are decoded as `windhover run` decodes them;
// of a sequence's truth nothing is opened. Throws FormatError or SourceError where the source
// cannot be read as a whole (a frame is missing, broken or of another size, a video breaks off),
// and std::runtime_error where the pipeline fails.
std::vector<FrameOutcome> DetectInSource(const std::filesystem::path& source,
                                         const DetectionSettings& settings,
                                         const DetectionWatch& watch);

}  // namespace windhover::replay
