// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "replay/format/media_files.h"
#include "replay/readers/recording.h"

namespace windhover::replay {

// How one layout is read.
struct LayoutReader {
  // Whether the recording at `path` is stored so, by the names of what lies there.
  bool (*recognises)(const std::filesystem::path& path);
  // Everything but truth, of which nothing is opened.
  Recording (*locate)(const std::filesystem::path& path);
  // Adds the truth to what `locate` has returned.
  void (*read_truth)(Recording& recording);
};

extern const LayoutReader kMotChallengeReader;
extern const LayoutReader kVisDroneReader;
extern const LayoutReader kUavdtMotReader;
extern const LayoutReader kUavdtSotReader;
extern const LayoutReader kUav123Reader;
extern const LayoutReader kPesmodReader;
extern const LayoutReader kCdnetReader;
extern const LayoutReader kVideoReader;
extern const LayoutReader kPicturesReader;

// A recording whose frames are these pictures. Its size is that of the first.
Recording LocatePictures(const std::filesystem::path& path, const std::string& layout,
                         NumberedPictures pictures);

// For the reader of a box: its frame, from 1, must be one of the recording's. Throws FormatError.
void CheckFrame(const Recording& recording, const std::filesystem::path& file, std::size_t line,
                double frame);
// For the reader of a label: width and height must not be negative (FormatError). False where one
// is 0, which real sets contain: there is nothing to label then.
bool HasArea(const std::filesystem::path& file, std::size_t line, const Box& box);
// Notes how many boxes had no area.
void NoteWithoutArea(Recording& recording, const std::filesystem::path& file, int boxes);

}  // namespace windhover::replay
