// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <thread>
#include <vector>

#include "replay/app/commands.h"
#include "replay/app/interrupt.h"
#include "replay/app/picture_size.h"
#include "replay/app/progress.h"
#include "replay/app/render_sequences.h"
#include "replay/format/format_error.h"
#include "replay/format/homographies.h"
#include "replay/format/horizon.h"
#include "replay/format/labels.h"
#include "replay/format/pending_folder.h"
#include "replay/format/sequence.h"
#include "replay/render/compression.h"
#include "replay/render/parallel.h"
#include "replay/render/renderer.h"

namespace windhover::replay {
namespace {

// Whether any pixel of the picture sees the sky.
bool ShowsSky(const Eigen::Vector3d& horizon, const SequenceInfo& info) {
  double lowest = horizon.z();
  lowest += std::min(0.0, horizon.x() * (info.width - 1));
  lowest += std::min(0.0, horizon.y() * (info.height - 1));
  return lowest <= 0;
}

void WriteTruth(const std::filesystem::path& folder, const SequenceInfo& info,
                const std::vector<FrameTruth>& truth) {
  std::vector<LabelledBox> movers;
  std::vector<LabelledBox> decoys;
  std::vector<Eigen::Matrix3d> homographies;
  std::vector<Eigen::Vector3d> horizons;
  bool sky = false;
  for (const FrameTruth& frame : truth) {
    movers.insert(movers.end(), frame.movers.begin(), frame.movers.end());
    decoys.insert(decoys.end(), frame.decoys.begin(), frame.decoys.end());
    homographies.push_back(frame.first_from_frame);
    horizons.push_back(frame.horizon);
    sky = sky || ShowsSky(frame.horizon, info);
  }
  WriteTruthBoxes(MoversPath(folder), movers);
  WriteTruthBoxes(DecoysPath(folder), decoys);
  WriteHomographies(HomographiesPath(folder), homographies);
  if (sky) WriteHorizons(HorizonPath(folder), horizons);
}

// Pictures are rendered and written on all threads; between, compression takes them in order.
void WriteFrames(const Renderer& renderer, const std::filesystem::path& folder,
                 const SequenceInfo& info, int threads, std::vector<FrameTruth>& truth) {
  std::unique_ptr<Compression> compression;
  const int quantiser = renderer.plan().sensor.quantiser;
  if (quantiser > 0) {
    compression = std::make_unique<Compression>(info.width, info.height, quantiser);
  }
  Progress progress(info.name, info.frames);
  const int batch = 8 * threads;
  std::vector<cv::Mat> pictures(batch);
  for (int first = 0; first < info.frames; first += batch) {
    const int count = std::min(batch, info.frames - first);
    ForEachInParallel(count, threads, [&](int i) {
      ThrowIfInterrupted();
      pictures[i] = renderer.Frame(first + i);
      truth[first + i] = renderer.Truth(first + i);
    });
    for (int i = 0; compression && i < count; ++i) pictures[i] = compression->Pass(pictures[i]);
    ForEachInParallel(count, threads, [&](int i) {
      const std::filesystem::path file = FramePath(folder, info, first + i + 1);
      if (!cv::imwrite(file.string(), pictures[i], {cv::IMWRITE_PNG_COMPRESSION, 1})) {
        throw FormatError(file, "cannot be written");
      }
      progress.Advance();
    });
  }
  progress.Finish();
}

// Returns with the whole sequence in place, or throws and leaves nothing.
void RenderSequence(FlightPlan plan, const RenderSettings& settings,
                    const std::filesystem::path& out) {
  if (settings.seed > 0) plan.seed = settings.seed;
  if (!settings.ground.empty()) {
    plan.ground = cv::imread(settings.ground.string());
    if (plan.ground.empty()) throw FormatError(settings.ground, "is no picture that can be read");
    plan.ground_pixel_m = plan.camera.pixel_m;
  }
  if (!settings.size.empty()) ParseSize(settings.size, plan.width, plan.height);
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const int threads = settings.threads > 0 ? settings.threads : cores;
  const SequenceInfo info = {
      .name = plan.number + "-" + plan.name,
      .rendered_by = kRenderer,
      .frame_rate_hz = plan.frame_rate_hz,
      .frames = settings.frames > 0 ? std::min(settings.frames, plan.frames) : plan.frames,
      .width = plan.width,
      .height = plan.height};
  PendingFolder folder(out);
  std::filesystem::create_directories(folder.path() / info.image_folder);
  std::fprintf(stderr, "painting the ground of %s\n", info.name.c_str());
  const Renderer renderer(plan, threads, ThrowIfInterrupted, info.frames);
  std::vector<FrameTruth> truth(info.frames);
  WriteFrames(renderer, folder.path(), info, threads, truth);
  WriteTruth(folder.path(), info, truth);
  WriteSequenceInfo(folder.path(), info);
  folder.Commit();
}

}  // namespace

void RenderSequences(const RenderSettings& settings,
                     const std::function<void(const std::filesystem::path&)>& done) {
  const std::vector<FlightPlan> plans = FindFlightPlans(settings.sequences);
  CatchInterrupts();
  for (const FlightPlan& plan : plans) {
    const std::filesystem::path out = plans.size() == 1 ? settings.out : settings.out / plan.number;
    try {
      RenderSequence(plan, settings, out);
    } catch (const Interrupted&) {
      throw Interrupted("nothing half-written is left");
    }
    done(out);
  }
}

void AddRenderCommand(CLI::App& app) {
  auto settings = std::make_shared<RenderSettings>();
  CLI::App* command =
      app.add_subcommand("render", "Render a flight with exact truth as a MOTChallenge sequence");
  command
      ->add_option("--sequence", settings->sequences,
                   "Numbers or names, separated by commas; 'all': the ten of dataset B; 'flight': "
                   "the first one")
      ->capture_default_str();
  command
      ->add_option(
          "--out", settings->out,
          "The sequence's folder; that of the dataset where there are several. Each appears "
          "when it is complete")
      ->required();
  command->add_option("--frames", settings->frames, "At most so many from the start; default: all")
      ->check(CLI::Range(1, 100000));
  command->add_option("--ground", settings->ground,
                      "A picture of real ground from straight above, in place of the painted one; "
                      "its pixels are as large as the camera's below it");
  command->add_option(
      "--size", settings->size,
      "WIDTHxHEIGHT in px, with the same field of view; default: as the flight has");
  command->add_option("--seed", settings->seed, "Another world and traffic; default: the flight's")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 62));
  command
      ->add_option("--threads", settings->threads,
                   "Threads; default: one a core. The files are the same")
      ->check(CLI::Range(1, 1024));
  command->final_callback([settings] {
    RenderSequences(*settings, [](const std::filesystem::path& sequence) {
      std::printf("%s\n", sequence.string().c_str());
    });
  });
}

}  // namespace windhover::replay
