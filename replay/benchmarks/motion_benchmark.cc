// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/motion_benchmark.h"

#include <algorithm>
#include <map>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "gpu-kernels/backend.h"
#include "replay/baselines/frame_differencing.h"
#include "replay/baselines/stabilized_mog2.h"
#include "replay/benchmarks/dataset.h"
#include "replay/benchmarks/motion_results.h"
#include "replay/benchmarks/option_list.h"
#include "replay/benchmarks/sample_frames.h"
#include "replay/format/format_error.h"
#include "replay/format/frame_source.h"
#include "replay/format/truth.h"
#include "replay/offline/detection.h"
#include "replay/readers/recording.h"

namespace windhover::replay {
namespace {

// Figure 6.7.
constexpr int kCurveThresholds[] = {40, 20, 10};  // grey levels
constexpr int kCurveAreas[] = {1, 2, 4, 8, 12, 16, 24, 32, 48, 64, 96, 128};

constexpr const char* kStillSet = "uav123-building4-static";  // its label is of a building
constexpr const char* kRealSets[] = {"uavdt-s1301", "uav123-person12", kStillSet};

OverlapScores ScoresOf(const std::vector<LabelledBox>& truth,
                       const std::vector<LabelledBox>& found) {
  OverlapScores scores;
  for (std::size_t i = 0; i < kOverlaps.size(); ++i) {
    scores[i] = ScoreMotion(truth, found, kOverlaps[i]);
  }
  return scores;
}

// A peer over one sequence.
struct PeerRun {
  explicit PeerRun(std::unique_ptr<MotionPeer> made) : peer(std::move(made)) {}

  std::unique_ptr<MotionPeer> peer;
  std::vector<LabelledBox> boxes;
  std::vector<int> areas_px;  // of each box

  void Take(int frame, const cv::Mat& gray, const FrameRegistration& registration) {
    for (const MovingObject& object : peer->Detect(gray, registration)) {
      boxes.push_back({frame, -1, object.box});
      areas_px.push_back(object.area_px);
    }
  }
};

// As many as there are contestants after the product's two modes, then those of figure 6.7.
std::vector<PeerRun> MakePeers() {
  std::vector<PeerRun> peers;
  peers.emplace_back(std::make_unique<FrameDifferencing>(BackgroundOptions(), MotionOptions()));
  peers.emplace_back(std::make_unique<StabilizedMog2>(MotionOptions()));
  for (const int threshold : kCurveThresholds) {
    BackgroundOptions background;
    background.threshold = threshold;
    MotionOptions motion;
    motion.min_area_px = 1;
    peers.emplace_back(std::make_unique<FrameDifferencing>(background, motion));
  }
  return peers;
}

class MotionBenchmark {
 public:
  MotionBenchmark(const MotionBenchmarkSettings& settings, const BenchmarkProgress& progress);
  BenchmarkDocument Run();

 private:
  std::vector<FrameOutcome> Detect(const std::filesystem::path& source, const std::string& what,
                                   const std::string& reference);
  void MeasureSequence(const DatasetSequence& sequence);
  void AddCurve(const std::string& id, const std::vector<LabelledBox>& truth,
                const std::vector<PeerRun>& peers);
  void MeasureRealSet(const std::string& name);

  MotionBenchmarkSettings settings_;
  BenchmarkProgress progress_;
  std::string device_;
  MotionResults results_;
  std::vector<std::string> left_out_;
};

MotionBenchmark::MotionBenchmark(const MotionBenchmarkSettings& settings,
                                 const BenchmarkProgress& progress)
    : settings_(settings),
      progress_(progress),
      device_(Backend::Create(settings.device)->device().Describe()) {
  results_.contestants = {{"motion.", "windhover", {}},
                          {"motion.centre.", "centre", {}},
                          {"motion.frame_differencing.", "FD", {}},
                          {"peer.mog2.", "MOG2", {}}};
}

void MotionBenchmark::AddCurve(const std::string& id, const std::vector<LabelledBox>& truth,
                               const std::vector<PeerRun>& peers) {
  for (std::size_t i = 0; i < std::size(kCurveThresholds); ++i) {
    const PeerRun& run = peers[peers.size() - std::size(kCurveThresholds) + i];
    for (const int area : kCurveAreas) {
      progress_.check();
      std::vector<LabelledBox> kept;
      for (std::size_t box = 0; box < run.boxes.size(); ++box) {
        if (run.areas_px[box] >= area) kept.push_back(run.boxes[box]);
      }
      results_.curves[id].push_back({kCurveThresholds[i], area, ScoreMotion(truth, kept)});
    }
  }
}

std::vector<FrameOutcome> MotionBenchmark::Detect(const std::filesystem::path& source,
                                                  const std::string& what,
                                                  const std::string& reference) {
  DetectionSettings detection;
  detection.options = {{"device", settings_.device}, {"reference", reference}};
  detection.frames = settings_.frames;
  progress_.say("motion " + what + ", " + reference);
  return DetectInSource(
      source, detection,
      {[&](const DetectionState&) { progress_.check(); }, [](const std::string&) {}});
}

void MotionBenchmark::MeasureSequence(const DatasetSequence& sequence) {
  const std::vector<FrameOutcome> anchor = Detect(sequence.folder, sequence.id, "anchor");
  const std::vector<FrameOutcome> centre = Detect(sequence.folder, sequence.id, "centre");
  const SequenceTruth truth(sequence.folder, static_cast<int>(anchor.size()));
  const std::vector<LabelledBox> movers = truth.Movers();
  progress_.say("motion " + sequence.id + ", peers");
  std::vector<PeerRun> peers = MakePeers();
  const std::unique_ptr<FrameSource> source = OpenFrames(sequence.folder);
  std::map<int, cv::Mat> pictures;  // samples, by the frame's number
  const int frames = static_cast<int>(anchor.size());
  cv::Mat gray;
  for (int i = 0; i < frames; ++i) {
    const cv::Mat picture = source->Next();
    if (IsSample(i, frames)) pictures[i + 1] = picture.clone();
    cv::cvtColor(picture, gray, cv::COLOR_BGR2GRAY);
    for (PeerRun& run : peers) {
      progress_.check();
      run.Take(i + 1, gray, anchor[i].registration);
    }
  }
  const auto keep = [&](std::size_t contestant, const std::vector<LabelledBox>& boxes) {
    results_.contestants[contestant].scores[sequence.id] = ScoresOf(movers, boxes);
  };
  keep(MotionResults::kAnchor, BoxesOf(anchor));
  keep(MotionResults::kCentre, BoxesOf(centre));
  for (std::size_t i = MotionResults::kFrameDifferencing; i < results_.contestants.size(); ++i) {
    keep(i, peers[i - MotionResults::kFrameDifferencing].boxes);
  }
  AddCurve(sequence.id, movers, peers);
  for (const auto& [frame, picture] : pictures) {
    const std::vector<SampleView> views = {{"frame differencing", peers.front().boxes},
                                           {"windhover", BoxesOf(anchor)}};
    results_.samples.push_back(MakeSample(sequence.id, frame, picture, movers, views));
  }
}

void MotionBenchmark::MeasureRealSet(const std::string& name) {
  const std::filesystem::path path = settings_.data / name;
  if (!std::filesystem::exists(path)) {
    left_out_.push_back("there is no " + name + " among the real sets");
    return;
  }
  const Recording recording = OpenRecording(path);
  const std::vector<FrameOutcome> outcomes = Detect(path, name, "anchor");
  const std::vector<LabelledBox> boxes = BoxesOf(outcomes);
  const int frames = static_cast<int>(outcomes.size());
  if (settings_.frames == 0 && recording.knows_frames && frames != recording.frames) {
    throw FormatError(path, "gives " + std::to_string(frames) + " frames, but its labels are of " +
                                std::to_string(recording.frames));
  }
  RealSetResult result = {name, frames, static_cast<int>(boxes.size()), name == kStillSet, {}};
  std::vector<LabelledBox> truth = recording.Truth();
  std::erase_if(truth, [&](const LabelledBox& box) { return box.frame > frames; });
  for (std::size_t i = 0; !result.still && i < kOverlaps.size(); ++i) {
    const std::optional<double> recall = ScoreMotion(truth, boxes, kOverlaps[i]).recall();
    if (recall) result.recall.push_back(*recall);
  }
  results_.real.push_back(std::move(result));
}

BenchmarkDocument MotionBenchmark::Run() {
  const std::vector<DatasetSequence> sequences = FindSequences(settings_.dataset);
  for (const DatasetSequence& sequence : sequences) {
    if (std::filesystem::exists(MoversPath(sequence.folder))) {
      MeasureSequence(sequence);
    } else {
      left_out_.push_back("sequence " + sequence.id + ": no gt/gt.txt");
    }
  }
  for (const char* name : kRealSets) MeasureRealSet(name);
  for (const std::string& line : AbsentSequences(sequences)) left_out_.push_back(line);
  for (const std::string& line : UndefinedRatios(results_)) left_out_.push_back(line);
  progress_.say("taking the dataset's checksum");
  return {.device = device_,
          .dataset_sha256 = DatasetSha256(sequences, progress_),
          .options = OptionList(settings_.frames),
          .figures = MotionFigures(results_),
          .tables = MotionTables(results_),
          .plots = MotionPlots(results_),
          .samples = results_.samples,
          .left_out = left_out_};
}

}  // namespace

BenchmarkDocument RunMotionBenchmark(const MotionBenchmarkSettings& settings,
                                     const BenchmarkProgress& progress) {
  return MotionBenchmark(settings, progress).Run();
}

}  // namespace windhover::replay
