// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "replay/app/commands.h"
#include "replay/app/interrupt.h"
#include "replay/app/rendered_dataset.h"
#include "replay/benchmarks/figures.h"
#include "replay/benchmarks/first_frame.h"
#include "replay/benchmarks/machine.h"
#include "replay/benchmarks/motion_benchmark.h"
#include "replay/benchmarks/registration_benchmark.h"
#include "replay/benchmarks/speed_benchmark.h"
#include "replay/benchmarks/stage_benchmark.h"
#include "replay/format/text_lines.h"

namespace windhover::replay {
namespace {

constexpr int kQuickFrames = 60;  // of each sequence
constexpr int kQuickStressPictures = 2;

struct BenchSettings {
  // Of registration and motion.
  std::filesystem::path dataset;  // empty: is rendered
  std::filesystem::path data = "../shared/data";

  bool quick = false;
  bool stages = false;  // of speed
  std::filesystem::path first_frame_of;
  std::filesystem::path json;
};

void Say(const std::string& line) {
  ThrowIfInterrupted();
  std::fprintf(stderr, "%s\n", line.c_str());
}

void Finish(const BenchSettings& settings, const BenchmarkDocument& document) {
  const MachineInfo machine = ThisMachine();
  std::printf("%s, %d cores, %.1f GiB; device: %s\n", machine.processor.c_str(), machine.cores,
              machine.memory_gib, document.device.c_str());
  for (const FigureTable& table : document.tables) std::printf("\n%s", TableText(table).c_str());
  if (!document.figures.empty()) std::printf("\n");
  for (const Figure& figure : document.figures) {
    std::printf("%s %s%s%s\n", figure.name.c_str(), NumberText(figure.value, 5).c_str(),
                figure.unit.empty() ? "" : " ", figure.unit.c_str());
  }
  for (const std::string& line : document.left_out) std::printf("left out: %s\n", line.c_str());
  if (!settings.json.empty()) WriteText(settings.json, JsonText(document));
}

// Null where a dataset is given.
TemporaryFolder RenderedFor(const BenchSettings& settings) {
  if (!settings.dataset.empty()) return nullptr;
  return RenderDataset(settings.quick ? kQuickFrames : 0);
}

void BenchRegistration(const BenchSettings& settings) {
  CatchInterrupts();
  const TemporaryFolder rendered = RenderedFor(settings);
  RegistrationBenchmarkSettings benchmark;
  benchmark.dataset = rendered ? *rendered : settings.dataset;
  benchmark.data = settings.data;
  if (settings.quick) {
    benchmark.frames = kQuickFrames;
    benchmark.stress_pictures = kQuickStressPictures;
  }
  std::error_code error;
  benchmark.program = std::filesystem::read_symlink("/proc/self/exe", error);
  Finish(settings, RunRegistrationBenchmark(benchmark, {Say, ThrowIfInterrupted}));
}

void BenchMotion(const BenchSettings& settings) {
  CatchInterrupts();
  const TemporaryFolder rendered = RenderedFor(settings);
  MotionBenchmarkSettings benchmark;
  benchmark.dataset = rendered ? *rendered : settings.dataset;
  benchmark.data = settings.data;
  if (settings.quick) benchmark.frames = kQuickFrames;
  Finish(settings, RunMotionBenchmark(benchmark, {Say, ThrowIfInterrupted}));
}

void BenchSpeed(const BenchSettings& settings) {
  CatchInterrupts();
  SpeedBenchmarkSettings benchmark =
      settings.quick ? QuickSpeedBenchmark() : SpeedBenchmarkSettings();
  benchmark.threads = ThisMachine().cores;
  const BenchmarkProgress progress = {Say, ThrowIfInterrupted};
  Finish(settings, settings.stages ? RunStageBenchmark(benchmark, progress)
                                   : RunSpeedBenchmark(benchmark, progress));
}

void AddDatasetOptions(CLI::App& command, BenchSettings& settings) {
  command.add_option("--dataset", settings.dataset,
                     "Folder of sequences, as 'render --sequence all,a1,a2,a3,a4,s1' makes it; "
                     "default: they are rendered into a temporary folder first");
  command.add_option("--data", settings.data, "Folder of real sets; what is absent is left out")
      ->capture_default_str();
  command.add_flag("--quick", settings.quick, "The first 60 frames of each sequence only");
  command.add_option("--json", settings.json, "File for figures and tables, for scripts");
}

void AddSpeedCommand(CLI::App& bench, const std::shared_ptr<BenchSettings>& settings) {
  CLI::App* speed = bench.add_subcommand("speed",
                                         "Frames a second of registration alone and of the "
                                         "whole pipeline, CPU and OpenCL, beside KLT");
  speed->add_flag("--quick", settings->quick, "One flight and fewer frames");
  speed->add_flag("--stages", settings->stages,
                  "Instead, where the time of a frame goes: steps, operators, and the device's "
                  "kernels and transfers");
  speed->add_option("--json", settings->json, "File for figures and tables, for scripts");
  speed->final_callback([settings] { BenchSpeed(*settings); });
}

}  // namespace

void AddBenchCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("bench", "Measure");
  command->require_subcommand(1);
  auto settings = std::make_shared<BenchSettings>();
  CLI::App* registration = command->add_subcommand(
      "registration", "Accuracy, reach and honesty of registration beside its peers");
  AddDatasetOptions(*registration, *settings);
  registration->final_callback([settings] { BenchRegistration(*settings); });
  CLI::App* motion = command->add_subcommand(
      "motion", "Precision and recall of motion detection beside its peers");
  AddDatasetOptions(*motion, *settings);
  motion->final_callback([settings] { BenchMotion(*settings); });
  AddSpeedCommand(*command, settings);
  CLI::App* first_frame = command->add_subcommand("first-frame",
                                                  "Register the first two frames of a sequence and "
                                                  "end: what 'registration' times from outside");
  first_frame->add_option("SEQUENCE", settings->first_frame_of, "Sequence or video")->required();
  first_frame->final_callback([settings] { RegisterFirstPair(settings->first_frame_of, ""); });
}

}  // namespace windhover::replay
