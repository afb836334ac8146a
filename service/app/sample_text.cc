// SPDX-License-Identifier: Apache-2.0
#include "service/app/sample_text.h"

#include <spdlog/fmt/fmt.h>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "service/app/registration_json.h"

namespace windhover {
namespace {

using Json = nlohmann::ordered_json;

// Streams may be named by others: bytes that are not UTF-8 are replaced.
std::string Line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

const char* Name(Topic topic) { return topic == Topic::kHomography ? "homography" : "detections"; }

const char* Name(Subscriber::EndReason reason) {
  return reason == Subscriber::EndReason::kEnded ? "ended" : "lost";
}

Json Frame(const char* type, const FrameSample& sample, std::uint64_t frame_number) {
  Json json;
  json["type"] = type;
  json["stream"] = sample.stream;
  json["frame"] = frame_number;
  json["pts_ns"] = sample.pts_ns < 0 ? Json() : Json(sample.pts_ns);
  json["width"] = sample.width;
  json["height"] = sample.height;
  return json;
}

// "1.234 s", or "-" where there is no time.
std::string Seconds(std::int64_t pts_ns) {
  return pts_ns < 0 ? "-" : fmt::format("{:.3f} s", static_cast<double>(pts_ns) * 1e-9);
}

}  // namespace

std::string JsonLine(const HomographySample& sample) {
  const FrameRegistration& registration = sample.registration;
  Json json = Frame("homography", sample, registration.frame_number);
  json["quality"] = NameOf(registration.quality);
  json["starts_segment"] = registration.starts_segment;
  json["change"] = NameOf(registration.change);
  json["previous_from_frame"] = RowMajor<3>(registration.previous_from_frame);
  const bool anchor = registration.anchor_from_frame.has_value();
  json["anchor_from_frame"] = anchor ? RowMajor<3>(*registration.anchor_from_frame) : Json();
  json["anchor"] = anchor ? Json(registration.anchor_number) : Json();
  json["corner_covariance_px2"] = RowMajor<8>(registration.corner_covariance);
  json["inliers"] = registration.inliers;
  json["tiles"] = registration.tiles;
  json["residual_px"] = registration.residual_px;
  json["overlap"] = registration.overlap;
  return Line(json);
}

std::string JsonLine(const DetectionsSample& sample) {
  Json json = Frame("detections", sample, sample.frame_number);
  json["omitted"] = sample.omitted;
  Json detections = Json::array();
  for (const Detection& detection : sample.detections) {
    Json one;
    one["track"] = detection.track_id;
    one["x"] = detection.box.x;
    one["y"] = detection.box.y;
    one["width"] = detection.box.width;
    one["height"] = detection.box.height;
    one["velocity_x_px"] = detection.velocity_px.x();
    one["velocity_y_px"] = detection.velocity_px.y();
    one["score"] = detection.score;
    one["age_frames"] = detection.age_frames;
    detections.push_back(std::move(one));
  }
  json["detections"] = std::move(detections);
  return Line(json);
}

std::string JsonEndLine(const std::string& stream, Topic topic, Subscriber::EndReason reason) {
  Json json;
  json["type"] = "end";
  json["stream"] = stream;
  json["topic"] = Name(topic);
  json["reason"] = Name(reason);
  return Line(json);
}

std::string JsonPublishersLine(int publishers) {
  Json json;
  json["type"] = "publishers";
  json["publishers"] = publishers;
  return Line(json);
}

std::string TextLine(const HomographySample& sample) {
  const FrameRegistration& registration = sample.registration;
  const Eigen::Vector2d centre((sample.width - 1) / 2.0, (sample.height - 1) / 2.0);
  const Eigen::Vector2d before =
      (registration.previous_from_frame * centre.homogeneous()).hnormalized();
  return fmt::format(
      "{} frame {} at {}: homography {}, moved {:.2f} {:.2f} px, {} of {} tiles, residual {:.3f} "
      "px, overlap {:.0f} %{}{}\n",
      sample.stream, registration.frame_number, Seconds(sample.pts_ns),
      NameOf(registration.quality), before.x() - centre.x(), before.y() - centre.y(),
      registration.inliers, registration.tiles, registration.residual_px,
      100.0 * registration.overlap,
      registration.change == FrameChange::kSteady
          ? ""
          : fmt::format(", {}", NameOf(registration.change)),
      registration.starts_segment ? ", starts a segment" : "");
}

std::string TextLine(const DetectionsSample& sample) {
  std::string line =
      fmt::format("{} frame {} at {}: {} detections", sample.stream, sample.frame_number,
                  Seconds(sample.pts_ns), sample.detections.size() + sample.omitted);
  const char* separator = ":";
  for (const Detection& detection : sample.detections) {
    line += fmt::format("{} #{} {:.0f}x{:.0f} at {:.0f} {:.0f}, {:.1f} px/frame", separator,
                        detection.track_id, detection.box.width, detection.box.height,
                        detection.box.x, detection.box.y, detection.velocity_px.norm());
    separator = ";";
  }
  return line + "\n";
}

std::string TextEndLine(const std::string& stream, Topic topic, Subscriber::EndReason reason) {
  return fmt::format("{} {}: {}\n", stream, Name(topic), Name(reason));
}

std::string TextPublishersLine(int publishers) {
  return fmt::format("{} publisher{}\n", publishers, publishers == 1 ? "" : "s");
}

}  // namespace windhover
