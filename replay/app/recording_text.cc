// SPDX-License-Identifier: Apache-2.0
#include "replay/app/recording_text.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

namespace windhover::replay {
namespace {

struct LabelCounts {
  int counting = 0;
  int not_counting = 0;
  int identities = 0;
};

LabelCounts Count(const Recording& recording) {
  LabelCounts counts;
  std::set<std::int64_t> identities;
  for (const Label& label : recording.labels) {
    ++(label.box.score == 0 ? counts.not_counting : counts.counting);
    if (label.box.id >= 0) identities.insert(label.box.id);
  }
  counts.identities = static_cast<int>(identities.size());
  return counts;
}

const char* LabellingText(const Recording& recording) {
  switch (recording.labelling) {
    case Labelling::kNone:
      return "none";
    case Labelling::kMovers:
      return "movers";
    case Labelling::kObjects:
      return "objects";
    case Labelling::kOneTarget:
      return "one target";
  }
  return "";
}

std::string TruthText(const Recording& recording) {
  std::string text = "truth: ";
  if (recording.labelling == Labelling::kNone) {
    text += "no boxes";
  } else {
    const LabelCounts counts = Count(recording);
    text += fmt::format("{} boxes ({}), {} that do not count, {} identities",
                        counts.counting + counts.not_counting, LabellingText(recording),
                        counts.not_counting, counts.identities);
    if (!recording.labels_move) text += "; which of them move is not known";
  }
  text += recording.first_from_frame ? "; homographies" : "; no homographies";
  if (recording.horizons) text += "; horizon";
  if (!recording.decoys.empty())
    text += fmt::format("; {} boxes of decoys", recording.decoys.size());
  return text;
}

std::string CameraText(const char* source, const CameraStatistics& camera) {
  std::string text = fmt::format("camera, {}, {} pairs", source, camera.pairs);
  if (camera.lost > 0) text += fmt::format(", {} lost", camera.lost);
  if (camera.pairs == 0) return text;
  return text + fmt::format(
                    ": shift median {:.2f}, largest {:.2f} px; rotation median {:.2f}, "
                    "largest {:.2f} degrees; scale {:.3f} to {:.3f}; overlap median {:.3f}, "
                    "least {:.3f}",
                    camera.shift_px->median, camera.shift_px->largest, camera.rotation_deg->median,
                    camera.rotation_deg->largest, camera.scale->least, camera.scale->largest,
                    camera.overlap->median, camera.overlap->least);
}

nlohmann::ordered_json SpreadJson(const std::optional<Spread>& spread) {
  if (!spread) return nullptr;
  return {{"least", spread->least}, {"median", spread->median}, {"largest", spread->largest}};
}

nlohmann::ordered_json CameraJson(const std::optional<CameraStatistics>& camera) {
  if (!camera) return nullptr;
  return {{"pairs", camera->pairs},
          {"lost", camera->lost},
          {"shift_px", SpreadJson(camera->shift_px)},
          {"rotation_deg", SpreadJson(camera->rotation_deg)},
          {"scale", SpreadJson(camera->scale)},
          {"overlap", SpreadJson(camera->overlap)}};
}

template <typename T>
nlohmann::ordered_json OrNull(const std::optional<T>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

}  // namespace

std::string Describe(const RecordingSummary& summary) {
  const Recording& recording = summary.recording;
  std::string text = recording.path.string() + "\n";
  text += fmt::format("  {}, {}: {}x{} px, {} frames{}", recording.name, recording.layout,
                      recording.width, recording.height,
                      recording.frames > 0 ? std::to_string(recording.frames) : "unknown number of",
                      recording.knows_frames ? "" : " as the video says");
  text += recording.frame_rate_hz ? fmt::format(", {:g} a second", *recording.frame_rate_hz)
                                  : ", rate unknown";
  text += "\n  " + TruthText(recording);
  if (summary.true_camera) text += "\n  " + CameraText("from truth", *summary.true_camera);
  if (summary.measured_camera) text += "\n  " + CameraText("measured", *summary.measured_camera);
  for (const std::string& note : recording.notes) text += "\n  note: " + note;
  return text;
}

nlohmann::ordered_json ToJson(const RecordingSummary& summary) {
  const Recording& recording = summary.recording;
  const LabelCounts counts = Count(recording);
  nlohmann::ordered_json json;
  json["path"] = recording.path.string();
  json["name"] = recording.name;
  json["layout"] = recording.layout;
  json["width"] = recording.width;
  json["height"] = recording.height;
  json["frames"] = recording.frames;
  json["frames_certain"] = recording.knows_frames;
  json["frame_rate_hz"] = OrNull(recording.frame_rate_hz);
  json["truth"] = {{"labelling", LabellingText(recording)},
                   {"movers_known", recording.labels_move},
                   {"boxes", counts.counting},
                   {"boxes_not_counting", counts.not_counting},
                   {"identities", counts.identities},
                   {"decoys", recording.decoys.size()},
                   {"homographies", recording.first_from_frame.has_value()},
                   {"horizon", recording.horizons.has_value()}};
  json["camera_true"] = CameraJson(summary.true_camera);
  json["camera_measured"] = CameraJson(summary.measured_camera);
  json["notes"] = recording.notes;
  return json;
}

}  // namespace windhover::replay
