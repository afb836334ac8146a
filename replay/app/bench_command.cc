// SPDX-License-Identifier: Apache-2.0
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "replay/app/commands.h"
#include "replay/app/interrupt.h"
#include "replay/app/picture_size.h"
#include "replay/benchmarks/speed_benchmark.h"
#include "replay/format/text_lines.h"

namespace windhover::replay {
namespace {

struct BenchSettings {
  SpeedBenchmarkSettings speed;
  int frames = 0;
  std::string size;
  std::filesystem::path json;
};

std::string ProcessorName() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

int Cores() { return static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); }

void WriteJson(const std::filesystem::path& file, const SpeedBenchmarkSettings& settings,
               const SpeedBenchmarkResult& result) {
  nlohmann::ordered_json json;
  json["machine"] = {{"processor", ProcessorName()}, {"cores", Cores()}};
  json["device"] = result.default_device;
  json["opencl"] = result.opencl_device;
  json["plugin"] = result.plugin_file;
  json["options"] = {{"sequence", settings.plan.number}, {"seed", settings.plan.seed},
                     {"width", settings.plan.width},     {"height", settings.plan.height},
                     {"frames", settings.plan.frames},   {"rounds", settings.rounds}};
  json["figures"] = nlohmann::ordered_json::array();
  for (const Figure& figure : result.figures) {
    json["figures"].push_back(
        {{"name", figure.name}, {"value", figure.value}, {"unit", figure.unit}});
  }
  WriteText(file, json.dump(2) + "\n");
}

void PrintResult(const SpeedBenchmarkSettings& settings, const SpeedBenchmarkResult& result) {
  std::printf("%s, %d cores, OpenCL: %s\n", ProcessorName().c_str(), Cores(),
              result.opencl_device.empty() ? "none" : result.opencl_device.c_str());
  std::printf("by default: %s\nplugin: %s\n", result.default_device.c_str(),
              result.plugin_file.c_str());
  std::printf("%dx%d, 36 tiles, k = 10, %d frames, %d rounds\n\n", settings.plan.width,
              settings.plan.height, settings.plan.frames, settings.rounds);
  std::printf("%-32s %9s %10s %9s %9s %8s\n", "", "frames/s", "median ms", "p95 ms", "RMS px",
              "to KLT");
  const double klt_fps = result.contestants.front().fps;
  for (const SpeedContestant& one : result.contestants) {
    const bool pipeline = one.rms_px == 0;
    std::printf("%-32s %9.1f %10.2f %9.2f %9s %8s\n", one.name.c_str(), one.fps, one.median_ms,
                one.p95_ms, pipeline ? "-" : fmt::format("{:.3f}", one.rms_px).c_str(),
                pipeline ? "-" : fmt::format("{:.2f}", one.fps / klt_fps).c_str());
  }
}

void BenchSpeed(BenchSettings settings) {
  if (settings.frames > 0) settings.speed.plan.frames = settings.frames;
  if (!settings.size.empty()) {
    ParseSize(settings.size, settings.speed.plan.width, settings.speed.plan.height);
  }
  settings.speed.threads = Cores();
  CatchInterrupts();
  const SpeedBenchmarkResult result =
      RunSpeedBenchmark(settings.speed, [](const std::string& line) {
        ThrowIfInterrupted();
        std::fprintf(stderr, "%s\n", line.c_str());
      });
  PrintResult(settings.speed, result);
  if (!settings.json.empty()) WriteJson(settings.json, settings.speed, result);
}

}  // namespace

void AddBenchCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("bench", "Measure");
  command->require_subcommand(1);
  auto settings = std::make_shared<BenchSettings>();
  settings->speed.plan = FindFlightPlan("flight");
  CLI::App* speed = command->add_subcommand("speed",
                                            "Frames a second of registration alone and of the "
                                            "whole pipeline, CPU and OpenCL, beside KLT");
  speed->add_option("--frames", settings->frames, "Frames of the flight; default: as it has")
      ->check(CLI::Range(84, 100000));
  speed->add_option("--rounds", settings->speed.rounds, "Times that everything is measured in turn")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  speed->add_option("--size", settings->size, "WIDTHxHEIGHT in px; default 640x480");
  speed->add_option("--json", settings->json, "File for the figures, for scripts");
  speed->final_callback([settings] { BenchSpeed(*settings); });
}

}  // namespace windhover::replay
