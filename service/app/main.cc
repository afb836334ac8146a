// SPDX-License-Identifier: Apache-2.0
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include "service/app/devices.h"
#include "service/app/exit_code.h"
#include "service/app/option_settings.h"
#include "service/app/register_pictures.h"
#include "service/app/run.h"
#include "service/app/watch.h"
#include "service/options/option.h"

namespace windhover {
namespace {

constexpr const char* kVersion = "windhover " WINDHOVER_VERSION;

using Command = std::function<int()>;

void UseLogger() {
  const auto logger = spdlog::stderr_color_mt("windhover");
  logger->set_pattern("%H:%M:%S %^%l%$ %v");
  spdlog::set_default_logger(logger);
}

CLI::App* AddCommand(CLI::App& app, const char* name, const char* description) {
  CLI::App* command = app.add_subcommand(name, description);
  command->set_version_flag("--version", kVersion);
  command->fallthrough();
  return command;
}

void AddDevice(CLI::App* command, std::string& device) {
  command->add_option("--device", device,
                      "Compute device: cpu, or <platform>:<CPU|GPU>:<name|id> with parts that may "
                      "be empty; without it WINDHOVER_DEVICE, else the best OpenCL device");
}

// What the command line says; the chosen command reads it.
struct Arguments {
  RunOptions run;
  RegisterOptions register_pictures;
  std::vector<std::string> settings;
  WatchOptions watch;
  std::string topics = "both";
  bool best_effort = false;
  std::string device;
  Command command;
};

void AddSettings(CLI::App* command, std::vector<std::string>& settings) {
  command->add_option("--set", settings, "Option of the pipeline, as option=value; may be repeated")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void AddRun(CLI::App& app, Arguments& arguments) {
  CLI::App* command = AddCommand(
      app, "run", "Detect what moves in a video: writes annotated.mp4 and detections.jsonl");
  RunOptions& options = arguments.run;
  command->add_option("source", options.source, "Video file, URI or MOTChallenge sequence folder")
      ->required();
  command->add_option("--out", options.out, "Folder for the results")->capture_default_str();
  AddSettings(command, arguments.settings);
  command->add_flag("--no-video{false}", options.video, "Do not write annotated.mp4");
  AddDevice(command, options.device);
  command->footer("Options for --set:\n" + DescribeOptions());
  command->final_callback([&] {
    arguments.command = [&] {
      for (const std::string& text : arguments.settings) {
        options.settings.push_back(ParseOptionSetting(text));
      }
      return Run(options);
    };
  });
}

void AddRegister(CLI::App& app, Arguments& arguments) {
  CLI::App* command =
      AddCommand(app, "register",
                 "Measure how picture A lies over picture B: homography, covariance, quality");
  RegisterOptions& options = arguments.register_pictures;
  command->add_option("a", options.a, "Picture file, grey or colour, 8 or 16 bits")->required();
  command->add_option("b", options.b, "Picture file of the same size")->required();
  command->add_option("--out", options.out,
                      "Folder for result.json, blended.png and difference.png");
  command->add_flag("--json", options.json, "One JSON object, with the whole covariance");
  AddSettings(command, arguments.settings);
  AddDevice(command, options.device);
  command->footer(
      "Exit code 0: valid; 3: degraded or lost; 1: a picture cannot be used.\n"
      "Options for --set:\n" +
      DescribeRegistrationOptions());
  command->final_callback([&] {
    arguments.command = [&] {
      for (const std::string& text : arguments.settings) {
        SetRegistrationOption(text, options.registration);
      }
      return RegisterPictures(options);
    };
  });
}

void AddWatch(CLI::App& app, Arguments& arguments) {
  CLI::App* command =
      AddCommand(app, "watch", "Print homographies and detections from the bus as they come");
  WatchOptions& options = arguments.watch;
  command->add_flag("--json", options.json, "One JSON object a line");
  command->add_option("--stream", options.subscribe.stream, "Only this stream");
  command->add_option("--topics", arguments.topics, "homography, detections or both")
      ->check(CLI::IsMember({"homography", "detections", "both"}))
      ->capture_default_str();
  command->add_flag("--until-end", options.until_end, "End when all streams seen have ended");
  command->add_option("--count", options.count, "End after that many samples")
      ->check(CLI::PositiveNumber);
  command->add_option("--domain", options.subscribe.domain, "DDS domain")
      ->check(CLI::Range(0, 230))
      ->capture_default_str();
  command->add_option("--partition", options.subscribe.partition,
                      "DDS partitions, separated by commas");
  command
      ->add_option("--history-depth", options.subscribe.history_depth,
                   "Samples kept of each stream until they are printed; 0 keeps all")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
  command->add_flag("--best-effort", arguments.best_effort, "Do not ask for what has been missed");
  command->final_callback([&] {
    arguments.command = [&] {
      options.subscribe.homographies = arguments.topics != "detections";
      options.subscribe.detections = arguments.topics != "homography";
      options.subscribe.reliable = !arguments.best_effort;
      return Watch(options);
    };
  });
}

void AddDeviceCommands(CLI::App& app, Arguments& arguments) {
  CLI::App* devices = AddCommand(app, "devices", "List the compute devices and the one to be used");
  AddDevice(devices, arguments.device);
  devices->final_callback(
      [&] { arguments.command = [&] { return ListDevices(arguments.device); }; });
  CLI::App* warmup = AddCommand(app, "warmup", "Compile and cache the kernels for a device");
  AddDevice(warmup, arguments.device);
  warmup->final_callback(
      [&] { arguments.command = [&] { return WarmUpDevice(arguments.device); }; });
}

// In one line, whatever line feeds the text has.
void ReportError(const std::string& text) {
  std::string line;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\n') {
      line += text[i];
      continue;
    }
    line += line.ends_with(':') ? " " : "; ";
    i = std::min(text.find_first_not_of(" \n", i), text.size()) - 1;
  }
  fmt::print(stderr, "windhover: {}\n", line);
}

int Main(int argc, char** argv) {
  CLI::App app("Real-time streaming service for aerial video", "windhover");
  app.set_version_flag("--version", kVersion);
  app.require_subcommand(0, 1);
  std::string log_level = "info";
  app.add_option("--log-level", log_level, "trace, debug, info, warn, error or off")
      ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error", "off"}))
      ->capture_default_str();
  Arguments arguments;
  AddRun(app, arguments);
  AddRegister(app, arguments);
  AddWatch(app, arguments);
  AddDeviceCommands(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    ReportError(error.what());
    return kExitUsage;
  }
  if (!arguments.command) {
    ReportError(
        "a command is needed: run, register, watch, devices or warmup; see windhover --help");
    return kExitUsage;
  }
  spdlog::set_level(spdlog::level::from_str(log_level));
  return arguments.command();
}

}  // namespace
}  // namespace windhover

int main(int argc, char** argv) {
  // Closed pipes are seen where they are written to.
  std::signal(SIGPIPE, SIG_IGN);
  try {
    windhover::UseLogger();
    return windhover::Main(argc, argv);
  } catch (const windhover::OptionError& error) {
    windhover::ReportError(error.what());
    return windhover::kExitUsage;
  } catch (const std::exception& error) {
    windhover::ReportError(error.what());
    return windhover::kExitFailed;
  }
}
