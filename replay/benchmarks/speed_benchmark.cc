// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/speed_benchmark.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "replay/benchmarks/speed_contestants.h"
#include "replay/benchmarks/speed_setup.h"
#include "replay/benchmarks/timing.h"
#include "replay/offline/pipeline_run.h"
#include "service/gstreamer/start.h"

namespace windhover::replay {
namespace {

class SpeedBenchmark {
 public:
  SpeedBenchmark(const SpeedBenchmarkSettings& settings, const BenchmarkProgress& progress);
  BenchmarkDocument Run();

 private:
  using Contestants = std::vector<std::unique_ptr<SpeedContestant>>;

  Contestants MakeContestants(const SpeedSize& size) const;
  void MeasureSize(const SpeedSize& size);
  void AddFigures(const Contestants& contestants, const SpeedSize& size);
  void AddTable(const Contestants& contestants, const SpeedSize& size);

  SpeedBenchmarkSettings settings_;
  BenchmarkProgress progress_;
  const SpeedDevices devices_ = DevicesToTime();
  BenchmarkDocument document_;
};

SpeedBenchmark::SpeedBenchmark(const SpeedBenchmarkSettings& settings,
                               const BenchmarkProgress& progress)
    : settings_(settings), progress_(progress) {
  Check(settings);
  StartGStreamer();
  document_.device = devices_.by_default;
  document_.left_out = devices_.left_out;
  std::string sequences;
  for (const std::string& sequence : settings.sequences) {
    sequences += (sequences.empty() ? "" : ",") + sequence;
  }
  std::string frames;
  for (const SpeedSize& size : settings.sizes) {
    frames += (frames.empty() ? "" : ",") + SizeText(size) + ":" + std::to_string(size.frames);
  }
  document_.options = {{"sequences", sequences},
                       {"frames", frames},
                       {"rounds", std::to_string(settings.rounds)},
                       {"opencl", devices_.opencl},
                       {"plugin", PluginFile()}};
  for (const auto& [name, value] : document_.options) progress_.say(name + ": " + value);
}

SpeedBenchmark::Contestants SpeedBenchmark::MakeContestants(const SpeedSize& size) const {
  Contestants contestants;
  contestants.push_back(MakeKltContestant());
  const bool first = &size == &settings_.sizes.front();
  for (const SpeedDevice& device : devices_.devices) {
    contestants.push_back(MakeRegistrationContestant(device.selector, device.name));
    // What is measured on the default device stands without its name, too.
    const auto variants = [&](const std::string& mode) {
      std::vector<std::string> names = {mode + device.name + "."};
      if (&device == &devices_.devices.front()) names.push_back(mode);
      return names;
    };
    contestants.push_back(
        MakePipelineContestant("pipeline, " + device.name, "pipeline", variants(""),
                               {.device = device.selector, .frames = size.frames}));
    if (!first) continue;
    contestants.push_back(MakePipelineContestant(
        "pipeline, centre, " + device.name, "pipeline", variants("centre."),
        {.device = device.selector, .reference = "centre", .frames = settings_.centre_frames}));
  }
  if (first) {
    contestants.push_back(MakePipelineContestant(
        "pipeline, latency, " + devices_.devices.front().name, "pipeline.latency", {},
        {.device = devices_.devices.front().selector,
         .frames = size.frames,
         .one_at_a_time = true}));
  }
  return contestants;
}

// Of the median round, in which both were measured one after the other.
double RatioTo(const SpeedContestant& peer, const SpeedContestant& one) {
  std::vector<double> ratios;
  for (std::size_t round = 0; round < one.round_fps().size(); ++round) {
    ratios.push_back(one.round_fps()[round] / peer.round_fps()[round]);
  }
  return Quantile(ratios, 0.5);
}

void SpeedBenchmark::AddFigures(const Contestants& contestants, const SpeedSize& size) {
  std::vector<Figure>& figures = document_.figures;
  const std::string text = SizeText(size);
  for (const std::unique_ptr<SpeedContestant>& one : contestants) {
    if (one->what() == "pipeline.latency") {
      figures.push_back({"pipeline.p50_ms." + text, Quantile(one->times_ms(), 0.5), "ms"});
      figures.push_back({"pipeline.p99_ms." + text, Quantile(one->times_ms(), 0.99), "ms"});
    }
    for (const std::string& variant : one->variants()) {
      figures.push_back(
          {one->what() + ".fps." + variant + text, Quantile(one->round_fps(), 0.5), "1/s"});
      const std::string quality = "speed." + one->what() + "." + variant;
      AddFigure(figures, quality + "rms_px." + text, one->rms_px(), "px");
      AddFigure(figures, quality + "f1_005." + text, one->f1());
    }
  }
  if (&size != &settings_.sizes.front()) return;
  // After KLT comes registration on the default device.
  figures.push_back(
      {"registration.speed_ratio_to_klt", RatioTo(*contestants[0], *contestants[1]), ""});
}

void SpeedBenchmark::AddTable(const Contestants& contestants, const SpeedSize& size) {
  FigureTable table = {
      .name = "speed." + SizeText(size),
      .title = SizeText(size) + ", " + std::to_string(size.frames) + " frames of each flight, " +
               std::to_string(settings_.rounds) + " rounds",
      .columns = {"", "frames/s", "median ms", "p95 ms", "p99 ms", "to KLT", "RMS px", "F1 %"},
      .rows = {},
      .digits = 3};
  for (const std::unique_ptr<SpeedContestant>& one : contestants) {
    const std::optional<double> f1 = one->f1();
    table.rows.push_back({one->title(), Quantile(one->round_fps(), 0.5),
                          Quantile(one->times_ms(), 0.5), Quantile(one->times_ms(), 0.95),
                          Quantile(one->times_ms(), 0.99), RatioTo(*contestants.front(), *one),
                          CellOf(one->rms_px()), f1 ? TableCell(100 * *f1) : TableCell()});
  }
  document_.tables.push_back(std::move(table));
}

void SpeedBenchmark::MeasureSize(const SpeedSize& size) {
  std::vector<SpeedFlight> flights;
  for (const std::string& sequence : settings_.sequences) {
    flights.push_back(RenderSpeedFlight(sequence, size, settings_.threads, progress_));
  }
  const Contestants contestants = MakeContestants(size);
  for (int round = 1; round <= settings_.rounds; ++round) {
    for (const std::unique_ptr<SpeedContestant>& contestant : contestants) {
      progress_.check();
      progress_.say(SizeText(size) + ", round " + std::to_string(round) + ": " +
                    contestant->title());
      contestant->RunRound(flights);
    }
  }
  AddFigures(contestants, size);
  AddTable(contestants, size);
}

BenchmarkDocument SpeedBenchmark::Run() {
  for (const SpeedSize& size : settings_.sizes) MeasureSize(size);
  return document_;
}

}  // namespace

SpeedBenchmarkSettings QuickSpeedBenchmark() {
  return {.sequences = {"1"},
          .sizes = {{640, 480, 80}, {1280, 720, 50}, {1920, 1080, 46}},
          .centre_frames = 60,
          .rounds = 2};
}

BenchmarkDocument RunSpeedBenchmark(const SpeedBenchmarkSettings& settings,
                                    const BenchmarkProgress& progress) {
  return SpeedBenchmark(settings, progress).Run();
}

}  // namespace windhover::replay
