// SPDX-License-Identifier: Apache-2.0
#include "replay/scoring/motion_report.h"

#include <stdexcept>
#include <utility>

#include "replay/scoring/summary.h"

namespace windhover::replay {
namespace {

constexpr double kPesmodBorderPx = 5;
constexpr double kPesmodAreaPx2 = 10;
constexpr double kSecondsAMinute = 60;

bool CountsInPesmod(const Box& box, int width, int height) {
  return box.width * box.height > kPesmodAreaPx2 && box.x >= kPesmodBorderPx &&
         box.y >= kPesmodBorderPx && box.x + box.width <= width - kPesmodBorderPx &&
         box.y + box.height <= height - kPesmodBorderPx;
}

void AddTracks(std::optional<TrackScore>& sum, const std::optional<TrackScore>& other) {
  if (!other) sum.reset();
  if (!sum) return;
  sum->objects += other->objects;
  sum->id_switches += other->id_switches;
  sum->fragmentations += other->fragmentations;
}

void AddReport(MotionReport& sum, const MotionReport& other) {
  sum.frames += other.frames;
  sum.complete = sum.complete && other.complete;
  if (sum.at_overlap.size() != other.at_overlap.size()) {
    throw std::invalid_argument("reports of different overlaps cannot be added up");
  }
  for (std::size_t i = 0; i < sum.at_overlap.size(); ++i) {
    if (sum.at_overlap[i].least_overlap != other.at_overlap[i].least_overlap) {
      throw std::invalid_argument("reports of different overlaps cannot be added up");
    }
    sum.at_overlap[i].score += other.at_overlap[i].score;
  }
  sum.centre += other.centre;
  AddTracks(sum.tracks, other.tracks);
  AddClasses(sum.by_size, other.by_size);
  AddClasses(sum.by_speed, other.by_speed);
  sum.minutes =
      sum.minutes && other.minutes ? std::optional(*sum.minutes + *other.minutes) : std::nullopt;
}

// `score_of` picks the score of a report.
template <typename ScoreOf>
MeanScore MeanOfScores(std::span<const MotionReport> reports, ScoreOf&& score_of) {
  std::vector<std::optional<double>> precision;
  std::vector<std::optional<double>> recall;
  std::vector<std::optional<double>> f1;
  for (const MotionReport& report : reports) {
    const MotionScore& score = score_of(report);
    recall.push_back(score.recall());
    if (!report.complete) continue;
    precision.push_back(score.precision());
    f1.push_back(score.f1());
  }
  return {SummaryOf(precision).mean, SummaryOf(recall).mean, SummaryOf(f1).mean};
}

}  // namespace

std::vector<LabelledBox> ApplyProtocol(MotionProtocol protocol, std::vector<LabelledBox> detections,
                                       int width, int height) {
  if (protocol == MotionProtocol::kPesmod) {
    std::erase_if(detections,
                  [&](const LabelledBox& one) { return !CountsInPesmod(one.box, width, height); });
  }
  return detections;
}

std::vector<double> DefaultOverlaps(MotionProtocol protocol) {
  if (protocol == MotionProtocol::kPesmod) return {0.5, 0.25};
  return {kThesisOverlap, 0.25, 0.5};
}

std::optional<double> MotionReport::false_alarms_a_minute() const {
  if (!minutes || !complete) return std::nullopt;
  return score().false_alarms() / *minutes;
}

double MotionReport::detections_a_frame() const {
  return static_cast<double>(score().detections) / frames;
}

MotionReport ReportMotion(const MotionTruth& truth, std::vector<LabelledBox> detections,
                          std::span<const double> overlaps, MotionProtocol protocol) {
  if (overlaps.empty()) throw std::invalid_argument("no overlap is given");
  if (truth.frames < 1) throw std::invalid_argument("the truth has no frames");
  detections = ApplyProtocol(protocol, std::move(detections), truth.width, truth.height);
  const std::vector<FrameBoxes> frames = BoxesByFrame(truth.boxes, detections);
  MotionReport report;
  report.name = truth.name;
  report.frames = truth.frames;
  report.complete = truth.complete;
  for (const double overlap : overlaps) {
    report.at_overlap.push_back(
        {overlap, CountHits(MatchFrames(frames, HitRule::ByOverlap(overlap)))});
  }
  const HitRule rule = HitRule::ByOverlap(overlaps.front());
  const std::vector<FrameMatch> matches = MatchFrames(frames, rule);
  report.centre = CountHits(MatchFrames(frames, HitRule::ByCentre()));
  report.tracks = ScoreTracks(frames, rule);
  report.by_size = RecallBySize(frames, matches);
  if (!truth.first_from_frame.empty()) {
    report.by_speed = RecallBySpeed(frames, matches, truth.first_from_frame);
  }
  if (truth.frame_rate_hz) {
    report.minutes = truth.frames / *truth.frame_rate_hz / kSecondsAMinute;
  }
  return report;
}

MotionReport Pool(std::span<const MotionReport> reports) {
  if (reports.empty()) throw std::invalid_argument("there is nothing to add up");
  MotionReport sum = reports.front();
  sum.name = "pooled";
  for (const MotionReport& report : reports.subspan(1)) AddReport(sum, report);
  return sum;
}

MotionMean MeanOf(std::span<const MotionReport> reports) {
  if (reports.empty()) throw std::invalid_argument("there is nothing to take the mean of");
  MotionMean mean;
  for (std::size_t i = 0; i < reports.front().at_overlap.size(); ++i) {
    mean.at_overlap.push_back(
        MeanOfScores(reports, [i](const MotionReport& report) -> const MotionScore& {
          return report.at_overlap.at(i).score;
        }));
  }
  mean.centre = MeanOfScores(
      reports, [](const MotionReport& report) -> const MotionScore& { return report.centre; });
  std::vector<std::optional<double>> rates;
  for (const MotionReport& report : reports) rates.push_back(report.false_alarms_a_minute());
  mean.false_alarms_a_minute = SummaryOf(rates).mean;
  return mean;
}

}  // namespace windhover::replay
