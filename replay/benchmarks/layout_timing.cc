// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/layout_timing.h"

#include <algorithm>
#include <iterator>
#include <opencv2/imgproc.hpp>

#include "replay/benchmarks/thesis_results.h"
#include "replay/benchmarks/timing.h"
#include "replay/format/frame_source.h"
#include "replay/offline/product_registration.h"

namespace windhover::replay {
namespace {

constexpr int kFirst = 3;   // frames that are not counted: kernels are compiled, buffers made
constexpr int kTimed = 10;  // runs in the thesis

struct Contestant {
  std::unique_ptr<ProductRegistration> registration;
  std::vector<double>* times_ms;
};

constexpr const char* kSequences[] = {"a1", "a2", "a3", "a4"};

// By the name that results give the device.
using Backends = std::vector<std::pair<std::string, std::shared_ptr<Backend>>>;

Backends BothDevices(const std::shared_ptr<Backend>& backend) {
  Backends backends = {{"CPU twin", Backend::Create("cpu")}};
  if (backend->device().kind != DeviceKind::kCpuTwin) {
    backends.emplace_back("OpenCL", backend);
    return backends;
  }
  const std::vector<DeviceInfo> devices = Backend::Devices();
  if (devices.front().kind != DeviceKind::kCpuTwin) {
    backends.emplace_back("OpenCL", Backend::Create(devices.front().selector));
  }
  return backends;
}

std::vector<cv::Mat> LoadFrames(const DatasetSequence& sequence) {
  const std::unique_ptr<FrameSource> source = OpenFrames(sequence.folder);
  std::vector<cv::Mat> frames;
  while (frames.size() < kFirst + kTimed) {
    const cv::Mat picture = source->Next();
    if (picture.empty()) break;
    cv::cvtColor(picture, frames.emplace_back(), cv::COLOR_BGR2GRAY);
  }
  return frames;
}

std::vector<Contestant> MakeContestants(const Backends& backends, cv::Size size,
                                        RegistrationResults& results,
                                        std::vector<std::string>& left_out) {
  std::vector<Contestant> contestants;
  for (const auto& [device, backend] : backends) {
    for (const ThesisLayout& layout : kThesisLayouts) {
      RegistrationOptions options;
      options.tile_columns = layout.columns;
      options.tile_rows = layout.rows;
      options.tile_layers = layout.layers;
      try {
        contestants.push_back(
            {std::make_unique<ProductRegistration>(backend, size.width, size.height, options),
             &results.layout_times_ms[device][layout.name]});
      } catch (const OptionError& error) {
        left_out.push_back(std::string("figure 2.7: ") + error.what());
      }
    }
  }
  return contestants;
}

}  // namespace

void TimeLayouts(const std::shared_ptr<Backend>& backend,
                 const std::vector<DatasetSequence>& sequences, const BenchmarkProgress& progress,
                 RegistrationResults& results, std::vector<std::string>& left_out) {
  const Backends backends = BothDevices(backend);
  for (const char* id : kSequences) {
    const auto found = std::find_if(sequences.begin(), sequences.end(),
                                    [&](const DatasetSequence& one) { return one.id == id; });
    if (found == sequences.end()) {
      left_out.push_back(std::string("figure 2.7: there is no ") + id);
      continue;
    }
    progress.say(std::string("timing layouts on ") + id);
    const std::vector<cv::Mat> frames = LoadFrames(*found);
    std::vector<Contestant> contestants =
        MakeContestants(backends, frames.front().size(), results, left_out);
    for (std::size_t frame = 0; frame < frames.size(); ++frame) {
      for (std::size_t turn = 0; turn < contestants.size(); ++turn) {
        progress.check();
        const Contestant& one = contestants[(turn + frame) % contestants.size()];
        const Clock::time_point start = Clock::now();
        one.registration->Register(frames[frame]);
        if (frame >= kFirst) one.times_ms->push_back(Milliseconds(Clock::now() - start));
      }
    }
  }
  if (backends.size() < 2) left_out.emplace_back("figure 2.7: there is no OpenCL device");
  left_out.emplace_back("figure 2.7 without padding: tiles' sides are powers of two always");
}

}  // namespace windhover::replay
