// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/stress_benchmark.h"

#include <algorithm>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "replay/benchmarks/registration_peers.h"
#include "replay/benchmarks/stress_pairs.h"
#include "replay/format/format_error.h"
#include "replay/format/sequence.h"
#include "replay/offline/product_registration.h"
#include "replay/scoring/registration_score.h"

namespace windhover::replay {
namespace {

constexpr int kNoises[] = {2, 5, 10};  // grey levels
constexpr std::uint64_t kSeed = 2014;
// Magnitudes of each stress go in so many steps up to the limit, picture by picture.
constexpr int kSteps = 5;
const cv::Size kCutOfFrame(400, 300);  // leaves room in 640x480 for all that is asked
const cv::Size kCutOfStill(640, 480);
constexpr double kStillScale = 0.5;  // stills are sharper than video
constexpr const char* kStills = "aerial-stills-brighton";
// Scenes that are registered under all stresses at once.
constexpr const char* kCombinedOn[] = {"01", "02", "03", "09", kStills};

struct Source {
  std::string id;
  cv::Mat picture;  // CV_8UC1
  cv::Size cut;
};

class StressBenchmark {
 public:
  StressBenchmark(const StressBenchmarkSettings& settings, const BenchmarkProgress& progress,
                  RegistrationResults& results, std::vector<std::string>& left_out)
      : settings_(settings), progress_(progress), results_(results), left_out_(left_out) {}

  void Run();

 private:
  struct Entry {
    RegistrationContestant* results;
    bool slow;
    std::unique_ptr<RegistrationPeer> peer;
  };

  void LoadFrames();
  void LoadStills();
  std::vector<Entry>& EntriesFor(cv::Size size);
  std::optional<double> Register(Entry& entry, const StressPair& pair);
  const FrameRegistration& Ours(cv::Size size);
  void Flag(const std::string& place, const std::optional<double>& rms, cv::Size size);
  void MeasureStress(const Source& source, std::uint64_t index, Stress stress);
  const Source* Elsewhere(std::uint64_t index) const;
  void MeasureFault(const Source& source, std::uint64_t index, Fault fault);
  void MeasureCovariance(const Source& source, std::uint64_t index, int noise);

  const StressBenchmarkSettings& settings_;
  const BenchmarkProgress& progress_;
  RegistrationResults& results_;
  std::vector<std::string>& left_out_;
  std::vector<Source> sources_;
  std::map<std::pair<int, int>, std::vector<Entry>> entries_;  // by width and height
};

void StressBenchmark::LoadFrames() {
  for (const DatasetSequence& sequence : settings_.sequences) {
    const SequenceInfo info = ReadSequenceInfo(sequence.folder);
    if (info.width < kCutOfFrame.width * 8 / 5 || info.height < kCutOfFrame.height * 8 / 5) {
      left_out_.push_back("stress: sequence " + sequence.id + " is smaller than 640x480");
      continue;
    }
    const int frames = settings_.frames > 0 ? std::min(settings_.frames, info.frames) : info.frames;
    const int pictures = std::min(settings_.pictures, frames);
    for (int i = 0; i < pictures; ++i) {
      const std::filesystem::path file =
          FramePath(sequence.folder, info, 1 + i * frames / pictures);
      const cv::Mat picture = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
      if (picture.empty()) throw FormatError(file, "cannot be read");
      sources_.push_back({sequence.id, picture, kCutOfFrame});
    }
  }
}

void StressBenchmark::LoadStills() {
  const std::filesystem::path folder = settings_.data / kStills;
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".jpg" || extension == ".JPG") files.push_back(entry.path());
  }
  if (files.empty()) left_out_.push_back("stress: there is no " + std::string(kStills));
  std::sort(files.begin(), files.end());
  for (const std::filesystem::path& file : files) {
    progress_.check();
    const cv::Mat still = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
    if (still.empty()) throw FormatError(file, "cannot be read");
    cv::Mat picture;
    cv::resize(still, picture, {}, kStillScale, kStillScale, cv::INTER_AREA);
    // A still has room for many places: as many pairs are cut from it as from half a sequence.
    for (int i = 0; i < std::max(1, settings_.pictures / 2); ++i) {
      sources_.push_back({kStills, picture, kCutOfStill});
    }
  }
}

std::vector<StressBenchmark::Entry>& StressBenchmark::EntriesFor(cv::Size size) {
  std::vector<Entry>& entries = entries_[{size.width, size.height}];
  if (!entries.empty()) return entries;
  entries.push_back({&results_.contestants.front(), false,
                     std::make_unique<ProductRegistration>(settings_.backend, size.width,
                                                           size.height, RegistrationOptions())});
  std::size_t index = 1;
  for (const RegistrationPeerKind& kind : RegistrationPeerKinds()) {
    entries.push_back({&results_.contestants[index++], kind.slow, kind.make()});
  }
  return entries;
}

// Nothing where there is no truth.
std::optional<double> StressBenchmark::Register(Entry& entry, const StressPair& pair) {
  progress_.check();
  const std::optional<Eigen::Matrix3d> found =
      RegisterPair(*entry.peer, pair.reference, pair.frame);
  if (!pair.reference_from_frame) return std::nullopt;
  return PairRms(found, *pair.reference_from_frame, pair.frame.cols, pair.frame.rows);
}

const FrameRegistration& StressBenchmark::Ours(cv::Size size) {
  return static_cast<ProductRegistration&>(*EntriesFor(size).front().peer).last();
}

// Whatever is found where there is no truth is wrong.
void StressBenchmark::Flag(const std::string& place, const std::optional<double>& rms,
                           cv::Size size) {
  const bool flagged = Ours(size).quality != RegistrationQuality::kValid;
  if (!rms || *rms > kFailurePx) results_.flagged_bad[place].Add(flagged);
  if (rms && *rms < kGoodPx) results_.flagged_good[place].Add(flagged);
}

void StressBenchmark::MeasureStress(const Source& source, std::uint64_t index, Stress stress) {
  // Whichever pairs the slow peers take part in, they see every step.
  const double share =
      static_cast<double>((index + index / settings_.slow_every) % kSteps + 1) / kSteps;
  const std::optional<StressPair> pair =
      CutStressPair(source.picture, source.cut, stress, share,
                    MixSeed(kSeed, index, static_cast<std::uint64_t>(stress)));
  if (!pair) return;
  const bool with_slow = (index + static_cast<std::uint64_t>(stress)) % settings_.slow_every == 0;
  for (Entry& entry : EntriesFor(source.cut)) {
    if (entry.slow && !with_slow) continue;
    const std::optional<double> rms = Register(entry, *pair);
    if (!rms) continue;
    entry.results->reach[NameOf(stress)].Add(*rms < kGoodPx);
    if (entry.results->name.empty()) Flag("stress " + std::string(NameOf(stress)), rms, source.cut);
  }
}

// A picture of another place that the same size is cut from, another one for each source; null
// where there is none.
const Source* StressBenchmark::Elsewhere(std::uint64_t index) const {
  const std::size_t count = sources_.size();
  for (std::size_t step = 0; step < count; ++step) {
    const Source& other = sources_[(index + count / 2 + step) % count];
    if (other.id != sources_[index].id && other.cut == sources_[index].cut) return &other;
  }
  return nullptr;
}

void StressBenchmark::MeasureFault(const Source& source, std::uint64_t index, Fault fault) {
  const Source* elsewhere = Elsewhere(index);
  if (elsewhere == nullptr && fault == Fault::kCut) return;
  const std::optional<StressPair> pair =
      CutFaultPair(source.picture, elsewhere == nullptr ? cv::Mat() : elsewhere->picture,
                   source.cut, fault, MixSeed(kSeed + 1, index, static_cast<std::uint64_t>(fault)));
  if (!pair) return;
  const std::optional<double> rms = Register(EntriesFor(source.cut).front(), *pair);
  Flag("fault " + std::string(NameOf(fault)), rms, source.cut);
}

void StressBenchmark::MeasureCovariance(const Source& source, std::uint64_t index, int noise) {
  const std::optional<StressPair> pair =
      CutMildPair(source.picture, source.cut, noise, MixSeed(kSeed + 2, index, noise));
  if (!pair) return;
  Register(EntriesFor(source.cut).front(), *pair);
  if (Ours(source.cut).quality != RegistrationQuality::kValid) return;
  const std::optional<double> error = NormalisedCornerError(
      Ours(source.cut), *pair->reference_from_frame, source.cut.width, source.cut.height);
  if (error) results_.corner_errors[noise].push_back(*error);
}

void StressBenchmark::Run() {
  LoadFrames();
  LoadStills();
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const Source& source = sources_[i];
    if (i % 10 == 0) {
      progress_.say("stress: picture " + std::to_string(i) + " of " +
                    std::to_string(sources_.size()));
    }
    const bool combined = std::find(std::begin(kCombinedOn), std::end(kCombinedOn), source.id) !=
                          std::end(kCombinedOn);
    for (const Stress stress : kStresses) {
      if (stress != Stress::kCombined || combined) MeasureStress(source, i, stress);
    }
    for (const Fault fault : kFaults) MeasureFault(source, i, fault);
    for (const int noise : kNoises) MeasureCovariance(source, i, noise);
  }
}

}  // namespace

void RunStressBenchmark(const StressBenchmarkSettings& settings, const BenchmarkProgress& progress,
                        RegistrationResults& results, std::vector<std::string>& left_out) {
  StressBenchmark(settings, progress, results, left_out).Run();
}

}  // namespace windhover::replay
