// SPDX-License-Identifier: Apache-2.0
#include "service/dds/conversion.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstring>

#include "idl/detections.h"
#include "idl/homography.h"

namespace windhover {
namespace {

template <int N>
using RowMajor = Eigen::Matrix<double, N, N, Eigen::RowMajor>;

template <int N>
void Write(const Eigen::Matrix<double, N, N>& matrix, double* numbers) {
  Eigen::Map<RowMajor<N>> target(numbers);
  target = matrix;
}

template <int N>
Eigen::Matrix<double, N, N> ReadMatrix(const double* numbers) {
  return Eigen::Map<const RowMajor<N>>(numbers);
}

template <std::size_t N>
void WriteStream(const std::string& stream, char (&destination)[N]) {
  static_assert(N == kMaxStreamName + 1);
  const std::size_t size = std::min(stream.size(), kMaxStreamName);
  std::memcpy(destination, stream.data(), size);
  destination[size] = '\0';
}

template <typename Message>
void ReadFrame(const Message& message, FrameSample& sample) {
  sample.stream.assign(message.stream);
  sample.pts_ns = message.pts_ns;
  sample.width = static_cast<int>(message.width);
  sample.height = static_cast<int>(message.height);
}

windhover_RegistrationQuality ToMessage(RegistrationQuality quality) {
  switch (quality) {
    case RegistrationQuality::kValid:
      return windhover_VALID;
    case RegistrationQuality::kDegraded:
      return windhover_DEGRADED;
    case RegistrationQuality::kLost:
      break;
  }
  return windhover_LOST;
}

RegistrationQuality FromMessage(windhover_RegistrationQuality quality) {
  switch (quality) {
    case windhover_VALID:
      return RegistrationQuality::kValid;
    case windhover_DEGRADED:
      return RegistrationQuality::kDegraded;
    case windhover_LOST:
      break;
  }
  return RegistrationQuality::kLost;
}

windhover_FrameChange ToMessage(FrameChange change) {
  switch (change) {
    case FrameChange::kSteady:
      break;
    case FrameChange::kRepeated:
      return windhover_REPEATED;
    case FrameChange::kNoTexture:
      return windhover_NO_TEXTURE;
    case FrameChange::kCut:
      return windhover_CUT;
    case FrameChange::kJump:
      return windhover_JUMP;
  }
  return windhover_STEADY;
}

FrameChange FromMessage(windhover_FrameChange change) {
  switch (change) {
    case windhover_STEADY:
      break;
    case windhover_REPEATED:
      return FrameChange::kRepeated;
    case windhover_NO_TEXTURE:
      return FrameChange::kNoTexture;
    case windhover_CUT:
      return FrameChange::kCut;
    case windhover_JUMP:
      return FrameChange::kJump;
  }
  return FrameChange::kSteady;
}

}  // namespace

const dds_topic_descriptor_t* HomographyDescriptor() { return &windhover_Homography_desc; }
const dds_topic_descriptor_t* DetectionsDescriptor() { return &windhover_FrameDetections_desc; }

struct HomographyMessage::Layout {
  windhover_Homography message{};
};

HomographyMessage::HomographyMessage(const std::string& stream)
    : layout_(std::make_unique<Layout>()) {
  WriteStream(stream, layout_->message.stream);
}

HomographyMessage::~HomographyMessage() = default;

void HomographyMessage::Set(const FrameRegistration& registration, int width, int height,
                            std::int64_t pts_ns) {
  windhover_Homography& message = layout_->message;
  message.frame_number = registration.frame_number;
  message.pts_ns = pts_ns;
  message.width = static_cast<std::uint32_t>(width);
  message.height = static_cast<std::uint32_t>(height);
  Write<3>(registration.previous_from_frame, message.previous_from_frame);
  message.has_anchor = registration.anchor_from_frame.has_value();
  Write<3>(registration.anchor_from_frame.value_or(Eigen::Matrix3d::Identity()),
           message.anchor_from_frame);
  message.anchor_number = registration.anchor_number;
  Write<8>(registration.corner_covariance, message.corner_covariance);
  message.quality = ToMessage(registration.quality);
  message.inliers = static_cast<std::uint32_t>(registration.inliers);
  message.tiles = static_cast<std::uint32_t>(registration.tiles);
  message.residual_px = registration.residual_px;
  message.overlap = registration.overlap;
  message.starts_segment = registration.starts_segment;
  message.change = ToMessage(registration.change);
}

const void* HomographyMessage::data() const { return &layout_->message; }

struct DetectionsMessage::Layout {
  windhover_FrameDetections message{};
  std::array<windhover_Detection, kCapacity> detections{};
};

DetectionsMessage::DetectionsMessage(const std::string& stream)
    : layout_(std::make_unique<Layout>()) {
  static_assert(kCapacity == windhover_MAX_DETECTIONS);
  WriteStream(stream, layout_->message.stream);
  layout_->message.detections._maximum = kCapacity;
  layout_->message.detections._buffer = layout_->detections.data();
  layout_->message.detections._release = false;
}

DetectionsMessage::~DetectionsMessage() = default;

std::size_t DetectionsMessage::Set(std::uint64_t frame_number, int width, int height,
                                   std::int64_t pts_ns, const std::vector<Detection>& detections) {
  windhover_FrameDetections& message = layout_->message;
  const std::size_t count = std::min(detections.size(), kCapacity);
  const std::size_t omitted = detections.size() - count;
  message.frame_number = frame_number;
  message.pts_ns = pts_ns;
  message.width = static_cast<std::uint32_t>(width);
  message.height = static_cast<std::uint32_t>(height);
  message.omitted = static_cast<std::uint32_t>(omitted);
  message.detections._length = static_cast<std::uint32_t>(count);
  std::transform(detections.begin(), detections.begin() + static_cast<std::ptrdiff_t>(count),
                 layout_->detections.begin(), [](const Detection& detection) {
                   windhover_Detection out{};
                   out.track_id = detection.track_id;
                   out.x = detection.box.x;
                   out.y = detection.box.y;
                   out.width = detection.box.width;
                   out.height = detection.box.height;
                   out.velocity_x_px = detection.velocity_px.x();
                   out.velocity_y_px = detection.velocity_px.y();
                   out.score = detection.score;
                   out.age_frames = static_cast<std::uint32_t>(detection.age_frames);
                   return out;
                 });
  return omitted;
}

const void* DetectionsMessage::data() const { return &layout_->message; }

const char* HomographyStream(const void* message) {
  return static_cast<const windhover_Homography*>(message)->stream;
}

const char* DetectionsStream(const void* message) {
  return static_cast<const windhover_FrameDetections*>(message)->stream;
}

void Read(const void* data, HomographySample& sample) {
  const auto& message = *static_cast<const windhover_Homography*>(data);
  ReadFrame(message, sample);
  FrameRegistration& registration = sample.registration;
  registration.frame_number = message.frame_number;
  registration.previous_from_frame = ReadMatrix<3>(message.previous_from_frame);
  registration.anchor_from_frame.reset();
  if (message.has_anchor) registration.anchor_from_frame = ReadMatrix<3>(message.anchor_from_frame);
  registration.anchor_number = message.anchor_number;
  registration.corner_covariance = ReadMatrix<8>(message.corner_covariance);
  registration.quality = FromMessage(message.quality);
  registration.inliers = static_cast<int>(message.inliers);
  registration.tiles = static_cast<int>(message.tiles);
  registration.residual_px = message.residual_px;
  registration.overlap = message.overlap;
  registration.starts_segment = message.starts_segment;
  registration.change = FromMessage(message.change);
}

void Read(const void* data, DetectionsSample& sample) {
  const auto& message = *static_cast<const windhover_FrameDetections*>(data);
  ReadFrame(message, sample);
  sample.frame_number = message.frame_number;
  sample.omitted = message.omitted;
  sample.detections.resize(message.detections._length);
  std::transform(message.detections._buffer,
                 message.detections._buffer + message.detections._length, sample.detections.begin(),
                 [](const windhover_Detection& in) {
                   Detection detection;
                   detection.track_id = in.track_id;
                   detection.box = {in.x, in.y, in.width, in.height};
                   detection.velocity_px = {in.velocity_x_px, in.velocity_y_px};
                   detection.score = in.score;
                   detection.age_frames = static_cast<int>(in.age_frames);
                   return detection;
                 });
}

}  // namespace windhover
