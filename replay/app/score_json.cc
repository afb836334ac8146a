// SPDX-License-Identifier: Apache-2.0
#include "replay/app/score_json.h"

#include <cmath>
#include <optional>
#include <vector>

namespace windhover::replay {
namespace {

using Json = nlohmann::ordered_json;

Json OrNull(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
}

Json ListJson(const std::vector<std::optional<double>>& values) {
  Json list = Json::array();
  for (const std::optional<double>& value : values) list.push_back(OrNull(value));
  return list;
}

Json ScoreJson(const MotionReport& report, const MotionScore& score) {
  Json json;
  json["truth"] = score.truth;
  json["detections"] = score.detections;
  json["hits"] = score.hits;
  json["precision"] = OrNull(report.complete ? score.precision() : std::nullopt);
  json["recall"] = OrNull(score.recall());
  json["f1"] = OrNull(report.complete ? score.f1() : std::nullopt);
  return json;
}

Json MeanJson(const MeanScore& mean) {
  return {{"precision", OrNull(mean.precision)},
          {"recall", OrNull(mean.recall)},
          {"f1", OrNull(mean.f1)}};
}

Json ClassesJson(std::span<const ClassRecall> classes) {
  Json list = Json::array();
  for (const ClassRecall& one : classes) {
    list.push_back({{"from", one.least},
                    {"below", OrNull(one.below)},
                    {"truth", one.truth},
                    {"hits", one.hits},
                    {"recall", OrNull(one.recall())}});
  }
  return list;
}

Json ReportJson(const MotionReport& report) {
  Json json;
  json["name"] = report.name;
  json["frames"] = report.frames;
  json["complete"] = report.complete;
  for (const MotionReport::AtOverlap& one : report.at_overlap) {
    json["overlap"].push_back(ScoreJson(report, one.score));
    json["overlap"].back()["threshold"] = one.least_overlap;
  }
  json["centre"] = ScoreJson(report, report.centre);
  json["detections_a_frame"] = report.detections_a_frame();
  json["false_alarms_a_minute"] = OrNull(report.false_alarms_a_minute());
  json["tracks"] = nullptr;
  if (report.tracks) {
    json["tracks"] = {{"objects", report.tracks->objects},
                      {"id_switches", report.tracks->id_switches},
                      {"fragmentations", report.tracks->fragmentations}};
  }
  json["recall_by_size_px"] = ClassesJson(report.by_size);
  json["recall_by_speed_px_a_frame"] = ClassesJson(report.by_speed);
  return json;
}

Json SummaryJson(const Summary& summary) {
  return {{"count", summary.count},
          {"mean", OrNull(summary.mean)},
          {"median", OrNull(summary.median)},
          {"largest", OrNull(summary.largest)}};
}

Json ResidualsJson(const std::vector<std::optional<GroundResidual>>& residuals) {
  const ResidualSummary summary = SummaryOf(residuals);
  return {{"warped_grey", SummaryJson(summary.warped)},
          {"unwarped_grey", SummaryJson(summary.unwarped)},
          {"noise_grey", SummaryJson(summary.noise)},
          {"misplacement_px", SummaryJson(summary.misplacement_px)},
          {"without_common", summary.without_common}};
}

}  // namespace

Json MotionJson(std::span<const MotionReport> reports, const MotionReport& pooled,
                MotionProtocol protocol) {
  Json json;
  json["protocol"] = protocol == MotionProtocol::kPesmod ? "pesmod" : "windhover";
  json["sequences"] = Json::array();
  for (const MotionReport& report : reports) json["sequences"].push_back(ReportJson(report));
  const MotionMean mean = MeanOf(reports);
  for (std::size_t i = 0; i < mean.at_overlap.size(); ++i) {
    json["mean"]["overlap"].push_back(MeanJson(mean.at_overlap[i]));
    json["mean"]["overlap"].back()["threshold"] = pooled.at_overlap[i].least_overlap;
  }
  json["mean"]["centre"] = MeanJson(mean.centre);
  json["mean"]["false_alarms_a_minute"] = OrNull(mean.false_alarms_a_minute);
  json["pooled"] = ReportJson(pooled);
  return json;
}

Json RegistrationJson(std::span<const NamedRegistrationScore> scores) {
  Json json;
  json["sequences"] = Json::array();
  for (const auto& [name, score] : scores) {
    json["sequences"].push_back({{"name", name},
                                 {"gap", score.gap},
                                 {"pairs", score.pairs},
                                 {"without_ground", score.without_ground},
                                 {"mean_px", OrNull(score.mean_px)},
                                 {"median_px", OrNull(score.median_px)},
                                 {"max_px", OrNull(score.max_px)},
                                 {"failures", score.failures},
                                 {"drift_px", OrNull(score.drift_px)},
                                 {"rms_px", ListJson(score.rms_px)},
                                 {"drifts_px", ListJson(score.drifts_px)}});
  }
  return json;
}

Json VideoJson(const VideoScore& score) {
  Json json;
  json["consecutive"] = ResidualsJson(score.consecutive);
  json["gap"] = score.gap;
  json["across_gap"] = ResidualsJson(score.across_gap);
  json["cycles_px"] = SummaryJson(SummaryOf(std::span(score.cycles_px)));
  json["cycles_px"]["unregistered"] = score.unregistered;
  return json;
}

}  // namespace windhover::replay
