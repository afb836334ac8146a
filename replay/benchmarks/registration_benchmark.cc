// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/registration_benchmark.h"

#include <Eigen/LU>
#include <algorithm>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "replay/benchmarks/dataset.h"
#include "replay/benchmarks/first_frame.h"
#include "replay/benchmarks/layout_timing.h"
#include "replay/benchmarks/option_list.h"
#include "replay/benchmarks/registration_peers.h"
#include "replay/benchmarks/registration_results.h"
#include "replay/benchmarks/stress_benchmark.h"
#include "replay/benchmarks/thesis_results.h"
#include "replay/benchmarks/timing.h"
#include "replay/format/frame_source.h"
#include "replay/format/truth.h"
#include "replay/offline/product_registration.h"
#include "replay/scoring/registration_score.h"

namespace windhover::replay {
namespace {

constexpr int kGap = 10;        // frames
constexpr int kSlowEvery = 10;  // pairs

// A sequence with its truth, as far as it takes part.
struct Sequence {
  std::string id;
  std::filesystem::path folder;
  int frames = 0;
  int width = 0;
  int height = 0;
  std::vector<Eigen::Matrix3d> first_from_frame;
  std::vector<Eigen::Vector3d> horizons;  // empty where no sky is seen

  // Of `from`'s frame as registered to `to`'s.
  std::optional<double> Rms(const std::optional<Eigen::Matrix3d>& found, int to, int from) const {
    GroundSeen ground;
    if (!horizons.empty()) ground = {horizons[from], horizons[to]};
    return PairRms(found, first_from_frame[to].inverse() * first_from_frame[from], width, height,
                   ground);
  }
};

class RegistrationBenchmark {
 public:
  RegistrationBenchmark(const RegistrationBenchmarkSettings& settings,
                        const BenchmarkProgress& progress)
      : settings_(settings), progress_(progress), backend_(Backend::Create(settings.device)) {}

  BenchmarkDocument Run();

 private:
  // One contestant on the sequence at hand.
  struct Entry {
    RegistrationContestant* results;
    bool slow;
    std::unique_ptr<RegistrationPeer> pairs;   // is reset before each pair
    std::unique_ptr<RegistrationPeer> stream;  // sees every frame; none for slow peers
  };
  // A layout or window of ours on the sequence at hand.
  struct Variant {
    std::unique_ptr<RegistrationPeer> registration;
    PairTally* tally;
  };

  std::optional<Sequence> Open(const DatasetSequence& sequence);
  void MeasureSequence(const Sequence& sequence);
  std::vector<Entry> MakeEntries(const Sequence& sequence);
  std::vector<Variant> MakeVariants(const Sequence& sequence);
  void TakeFrame(const Sequence& sequence, int frame, const std::vector<cv::Mat>& last,
                 std::vector<Entry>& entries);
  void MeasurePair(const Sequence& sequence, int frame, int gap, const std::vector<cv::Mat>& last,
                   Entry& entry, PairTally& tally);
  void Judge(const Sequence& sequence, int to, int from, const char* place,
             const std::optional<Eigen::Matrix3d>& found, RegistrationPeer& registration,
             const RegistrationContestant& contestant, PairTally& tally);
  void MeasureWindows(const Sequence& sequence);
  void MeasureFirstFrame(const std::vector<DatasetSequence>& sequences);

  RegistrationBenchmarkSettings settings_;
  BenchmarkProgress progress_;
  std::shared_ptr<Backend> backend_;
  RegistrationResults results_;
  std::vector<std::string> left_out_;
};

// Adds the pair's error where it has one. Ours is asked, too, whether it knew.
void RegistrationBenchmark::Judge(const Sequence& sequence, int to, int from, const char* place,
                                  const std::optional<Eigen::Matrix3d>& found,
                                  RegistrationPeer& registration,
                                  const RegistrationContestant& contestant, PairTally& tally) {
  const std::optional<double> rms = sequence.Rms(found, to, from);
  if (!rms) return;
  tally.rms_px.push_back(*rms);
  if (!contestant.name.empty()) return;
  const auto& ours = static_cast<ProductRegistration&>(registration);
  const bool flagged = ours.last().quality != RegistrationQuality::kValid;
  if (*rms > kFailurePx) results_.flagged_bad[place].Add(flagged);
  if (*rms < kGoodPx) results_.flagged_good[place].Add(flagged);
}

void RegistrationBenchmark::MeasurePair(const Sequence& sequence, int frame, int gap,
                                        const std::vector<cv::Mat>& last, Entry& entry,
                                        PairTally& tally) {
  progress_.check();
  entry.pairs->Reset();
  entry.pairs->Register(last[(frame - gap) % last.size()]);
  const Clock::time_point start = Clock::now();
  const std::optional<Eigen::Matrix3d> found = entry.pairs->Register(last[frame % last.size()]);
  tally.times_ms.push_back(Milliseconds(Clock::now() - start));
  Judge(sequence, frame - gap, frame, gap == 1 ? "consecutive" : "ten apart", found, *entry.pairs,
        *entry.results, tally);
}

// `last` holds the last frames, frame i at i modulo its size.
void RegistrationBenchmark::TakeFrame(const Sequence& sequence, int frame,
                                      const std::vector<cv::Mat>& last,
                                      std::vector<Entry>& entries) {
  for (Entry& entry : entries) {
    progress_.check();
    if (entry.stream) {
      const Clock::time_point start = Clock::now();
      const std::optional<Eigen::Matrix3d> found =
          entry.stream->Register(last[frame % last.size()]);
      const double taken = Milliseconds(Clock::now() - start);
      if (frame > 0) {
        PairTally& tally = entry.results->consecutive[sequence.id];
        tally.times_ms.push_back(taken);
        Judge(sequence, frame - 1, frame, "consecutive", found, *entry.stream, *entry.results,
              tally);
      }
    } else if (frame % kSlowEvery == 1) {
      MeasurePair(sequence, frame, 1, last, entry, entry.results->consecutive[sequence.id]);
    }
    if (frame > 0 && frame % kGap == 0) {
      MeasurePair(sequence, frame, kGap, last, entry, entry.results->ten_apart[sequence.id]);
    }
  }
}

std::optional<Sequence> RegistrationBenchmark::Open(const DatasetSequence& found) {
  const int has = ReadSequenceInfo(found.folder).frames;
  const int frames = settings_.frames > 0 ? std::min(settings_.frames, has) : has;
  const SequenceTruth truth(found.folder, frames);
  if (!truth.HasHomographies()) {
    left_out_.push_back("sequence " + found.id + ": no gt/homography.txt");
    return std::nullopt;
  }
  return Sequence{found.id,       found.folder,         frames,          truth.width(),
                  truth.height(), truth.Homographies(), truth.Horizons()};
}

std::vector<RegistrationBenchmark::Entry> RegistrationBenchmark::MakeEntries(
    const Sequence& sequence) {
  const auto make_ours = [&] {
    return std::make_unique<ProductRegistration>(backend_, sequence.width, sequence.height,
                                                 RegistrationOptions());
  };
  std::vector<Entry> entries;
  entries.push_back({&results_.contestants.front(), false, make_ours(), make_ours()});
  std::size_t index = 1;
  for (const RegistrationPeerKind& kind : RegistrationPeerKinds()) {
    entries.push_back({&results_.contestants[index++], kind.slow, kind.make(),
                       kind.slow ? nullptr : kind.make()});
  }
  return entries;
}

std::vector<RegistrationBenchmark::Variant> RegistrationBenchmark::MakeVariants(
    const Sequence& sequence) {
  std::vector<Variant> variants;
  const auto add = [&](const RegistrationOptions& options, PairTally& tally) {
    variants.push_back(
        {std::make_unique<ProductRegistration>(backend_, sequence.width, sequence.height, options),
         &tally});
  };
  for (const ThesisLayout& layout : kThesisLayouts) {
    RegistrationOptions options;
    options.tile_columns = layout.columns;
    options.tile_rows = layout.rows;
    options.tile_layers = layout.layers;
    try {
      add(options, results_.layouts[layout.name][sequence.id]);
    } catch (const OptionError& error) {
      left_out_.push_back("table 2.2: sequence " + sequence.id + ": " + error.what());
    }
  }
  if (sequence.id == "a4") {
    for (const ThesisWindow& window : kThesisWindows) {
      RegistrationOptions options;
      options.window = window.window;
      options.window_alpha = window.alpha;
      add(options, results_.windows[window.name]);
    }
  }
  return variants;
}

void RegistrationBenchmark::MeasureSequence(const Sequence& sequence) {
  std::vector<Entry> entries = MakeEntries(sequence);
  std::vector<Variant> variants = MakeVariants(sequence);
  const std::unique_ptr<FrameSource> source = OpenFrames(sequence.folder);
  std::vector<cv::Mat> last(kGap + 1);
  for (int frame = 0; frame < sequence.frames; ++frame) {
    progress_.check();
    if (frame % 50 == 0) {
      progress_.say("registration " + sequence.id + ": frame " + std::to_string(frame) + " of " +
                    std::to_string(sequence.frames));
    }
    cv::Mat& gray = last[frame % last.size()];
    cv::cvtColor(source->Next(), gray, cv::COLOR_BGR2GRAY);
    TakeFrame(sequence, frame, last, entries);
    for (Variant& variant : variants) {
      const std::optional<Eigen::Matrix3d> found = variant.registration->Register(gray);
      if (frame == 0) continue;
      const std::optional<double> rms = sequence.Rms(found, frame - 1, frame);
      if (rms) variant.tally->rms_px.push_back(*rms);
    }
  }
}

void RegistrationBenchmark::MeasureFirstFrame(const std::vector<DatasetSequence>& sequences) {
  if (settings_.program.empty()) return;
  progress_.say("timing the first frame");
  progress_.check();
  results_.first_frame = TimeFirstFrame(settings_.program, sequences.front().folder);
}

BenchmarkDocument RegistrationBenchmark::Run() {
  const std::vector<DatasetSequence> sequences = FindSequences(settings_.dataset);
  results_.contestants.push_back({"", "windhover", {}, {}, {}});
  for (const RegistrationPeerKind& kind : RegistrationPeerKinds()) {
    results_.contestants.push_back({kind.name, kind.title, {}, {}, {}});
  }
  MeasureFirstFrame(sequences);
  for (const DatasetSequence& found : sequences) {
    if (const std::optional<Sequence> sequence = Open(found)) MeasureSequence(*sequence);
  }
  const StressBenchmarkSettings stress = {.backend = backend_,
                                          .sequences = sequences,
                                          .data = settings_.data,
                                          .frames = settings_.frames,
                                          .pictures = settings_.stress_pictures,
                                          .slow_every = kSlowEvery};
  TimeLayouts(backend_, sequences, progress_, results_, left_out_);
  RunStressBenchmark(stress, progress_, results_, left_out_);
  for (const std::string& line : AbsentSequences(sequences)) left_out_.push_back(line);
  if (results_.windows.empty()) left_out_.emplace_back("table 2.3: there is no a4");
  progress_.say("taking the dataset's checksum");
  return {.device = backend_->device().Describe(),
          .dataset_sha256 = DatasetSha256(sequences, progress_),
          .options = OptionList(settings_.frames),
          .figures = RegistrationFigures(results_),
          .tables = RegistrationTables(results_),
          .plots = RegistrationPlots(results_),
          .samples = {},
          .left_out = left_out_};
}

}  // namespace

BenchmarkDocument RunRegistrationBenchmark(const RegistrationBenchmarkSettings& settings,
                                           const BenchmarkProgress& progress) {
  return RegistrationBenchmark(settings, progress).Run();
}

}  // namespace windhover::replay
