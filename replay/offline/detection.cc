// SPDX-License-Identifier: Apache-2.0
#include "replay/offline/detection.h"

#include <algorithm>
#include <exception>
#include <optional>
#include <tuple>
#include <utility>

#include "replay/format/format_error.h"
#include "replay/format/media_files.h"
#include "replay/format/sequence.h"
#include "service/gstreamer/messages.h"
#include "service/gstreamer/pipeline.h"
#include "service/gstreamer/source.h"
#include "service/gstreamer/start.h"
#include "service/options/options.h"
#include "service/options/overlay_options.h"

namespace windhover::replay {
namespace {

namespace fs = std::filesystem;

// Where the frames lie, and what a sequence says about them.
struct Located {
  Source source;
  std::optional<SequenceInfo> sequence;
};

Located Locate(const fs::path& path) {
  if (!fs::exists(path)) throw FormatError(path, "does not exist");
  if (!fs::is_directory(path)) return {FindSource(path.string()), std::nullopt};
  if (!fs::exists(path / "seqinfo.ini")) {
    const std::vector<fs::path> videos = ListVideos(path);
    if (videos.size() == 1) return {FindSource(videos.front().string()), std::nullopt};
  }
  const SequenceInfo info = ReadSequenceInfo(path);
  return {FindSource(SequenceVideo(path, info).value_or(path).string()), info};
}

// Takes what comes out, on the pipeline's thread.
class Collector {
 public:
  Collector(const fs::path& path, const Located& located) : path_(path), located_(located) {
    if (located.sequence) size_ = {located.sequence->width, located.sequence->height};
  }

  void Take(GstBuffer* buffer) {
    try {
      FrameOutcome outcome = OutcomeOf(buffer);
      CheckSize({outcome.width, outcome.height});
      outcomes_.push_back(std::move(outcome));
    } catch (...) {
      failure_ = std::current_exception();
      throw;
    }
  }

  // Once the pipeline has stopped.
  const std::exception_ptr& failure() const { return failure_; }
  std::vector<FrameOutcome>& outcomes() { return outcomes_; }

 private:
  // Frames are of the size that the sequence states, else of the first one's.
  void CheckSize(std::pair<int, int> size) {
    if (size_ == std::pair(0, 0)) size_ = size;
    if (size == size_) return;
    const auto text = [](const std::pair<int, int>& of) {
      return std::to_string(of.first) + "x" + std::to_string(of.second);
    };
    const bool pictures = located_.sequence && located_.source.uri.empty();
    const int number = static_cast<int>(outcomes_.size()) + 1;
    throw FormatError(pictures ? FramePath(path_, *located_.sequence, number) : path_,
                      "is of " + text(size) + " px, but the sequence of " + text(size_));
  }

  const fs::path& path_;
  const Located& located_;
  std::pair<int, int> size_;
  std::vector<FrameOutcome> outcomes_;
  std::exception_ptr failure_;
};

// That all frames of the source have come out, or as many as were asked for.
void CheckWhole(const fs::path& path, const Located& located, const DetectionSettings& settings,
                const Pipeline& pipeline, std::size_t frames) {
  if (frames == 0) throw FormatError(path, "holds no frame");
  if (pipeline.frames_in() != frames) {
    throw std::runtime_error(std::to_string(pipeline.frames_in()) +
                             " frames went into the pipeline, " + std::to_string(frames) +
                             " came out");
  }
  if (static_cast<int>(frames) == settings.frames) return;
  if (located.sequence && static_cast<int>(frames) != located.sequence->frames) {
    throw FormatError(path, "gives " + std::to_string(frames) + " frames, but seqinfo.ini says " +
                                std::to_string(located.sequence->frames));
  }
  const std::string cut_off = CutOff(pipeline.reach());
  if (!cut_off.empty()) throw FormatError(path, cut_off);
}

}  // namespace

PipelineOption ParsePipelineOption(const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) {
    throw OptionError("expected option=value, got '" + assignment + "'");
  }
  PipelineOption option = {assignment.substr(0, equals), assignment.substr(equals + 1)};
  std::tuple<DeviceOptions, RegistrationOptions, BackgroundOptions, MotionOptions, OverlayOptions>
      all;
  const bool known = std::apply(
      [&](auto&... options) {
        // Not short-circuited: several structs may have an option of that name.
        return (static_cast<int>(SetOption(options, option.first, option.second)) + ...) > 0;
      },
      all);
  if (!known) throw OptionError("there is no option '" + option.first + "'");
  return option;
}

std::vector<FrameOutcome> DetectInSource(const fs::path& path, const DetectionSettings& settings,
                                         const DetectionWatch& watch) {
  Located located = Locate(path);
  if (settings.frames > 0) located.source.frames = std::min(located.source.frames, settings.frames);
  StartGStreamer();
  Collector collector(path, located);
  std::vector<std::string> elements = {"whregister", "queue", "whbackground", "queue", "whmotion"};
  if (!settings.video.empty()) elements.emplace_back("whoverlay");
  Pipeline pipeline(located.source, elements, settings.video.string(),
                    [&](GstBuffer* buffer) { collector.Take(buffer); });
  for (const auto& [name, value] : settings.options) pipeline.Set(name, value);
  pipeline.EndAfter(settings.frames);
  bool device_told = false;
  const auto on_message = [&](GstMessage* message) {
    if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_WARNING) watch.say(TextOf(message));
    const std::optional<std::string> device = DeviceOf(message);
    if (device && !std::exchange(device_told, true)) watch.say("device: " + *device);
  };
  const auto show = [&] {
    watch.progress({static_cast<int>(pipeline.frames_out()), pipeline.frames_to_come()});
  };
  pipeline.SetState(GST_STATE_PLAYING);
  const std::string error = AwaitEnd(pipeline.bus(), on_message, show);
  pipeline.SetState(GST_STATE_NULL);
  if (collector.failure()) std::rethrow_exception(collector.failure());
  if (!error.empty()) throw FormatError(path, error);
  CheckWhole(path, located, settings, pipeline, collector.outcomes().size());
  show();
  return std::move(collector.outcomes());
}

}  // namespace windhover::replay
