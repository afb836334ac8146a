// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace windhover::replay {

// What seqinfo.ini's key renderedBy says in sequences that this program has rendered. Others do not
// have the key.
inline constexpr const char* kRenderer = "windhover-replay";

// A MOTChallenge sequence: one folder with
//   seqinfo.ini         what SequenceInfo holds
//   img1/000001.png     the frames; file frame numbers count from 1 everywhere in the folder
//     or one video      in place of img1
//   gt/gt.txt           boxes of what moves (labels.h)
//   gt/static.txt       boxes of what looks like it but stands still (labels.h)
//   gt/homography.txt   first_from_frame of each frame (homographies.h)
//   gt/horizon.txt      where the sky begins, in sequences that show it (horizon.h)
struct SequenceInfo {
  std::string name;
  std::string rendered_by;  // kRenderer, or empty: not by this program
  std::string image_folder = "img1";
  std::string image_extension = ".png";
  double frame_rate_hz = 25.0;
  int frames = 0;
  int width = 0;   // px
  int height = 0;  // px
};

// Throws FormatError where seqinfo.ini is missing, malformed or lacks a size or a length.
SequenceInfo ReadSequenceInfo(const std::filesystem::path& sequence);
void WriteSequenceInfo(const std::filesystem::path& sequence, const SequenceInfo& info);

// The picture of a frame, which counts from 1.
std::filesystem::path FramePath(const std::filesystem::path& sequence, const SequenceInfo& info,
                                int frame);

// The video that stands for the pictures: the only one in the folder, where it has no folder of
// pictures. Nothing where it has one. Throws FormatError where there is neither, or several videos.
std::optional<std::filesystem::path> SequenceVideo(const std::filesystem::path& sequence,
                                                   const SequenceInfo& info);

inline std::filesystem::path MoversPath(const std::filesystem::path& sequence) {
  return sequence / "gt" / "gt.txt";
}
inline std::filesystem::path DecoysPath(const std::filesystem::path& sequence) {
  return sequence / "gt" / "static.txt";
}
inline std::filesystem::path HomographiesPath(const std::filesystem::path& sequence) {
  return sequence / "gt" / "homography.txt";
}
inline std::filesystem::path HorizonPath(const std::filesystem::path& sequence) {
  return sequence / "gt" / "horizon.txt";
}

}  // namespace windhover::replay
