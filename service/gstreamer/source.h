// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace windhover {

// The source cannot be used; the text names it and says why.
class SourceError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Where a video comes from: a URI, or the pictures of a MOTChallenge sequence folder.
struct Source {
  std::string name;  // as the user wrote it
  std::string stem;  // the last part of the name without its extension, for stream names
  std::string uri;   // empty for a sequence
  // Bytes that an AVI file lacks by its own header; its players take the rest for the whole.
  std::int64_t missing_bytes = 0;

  // Of a sequence: printf pattern of the pictures' paths by their number from 1, their number,
  // their rate and their GStreamer media type.
  std::string pattern;
  int frames = 0;
  double frame_rate_hz = 0.0;
  std::string media_type;
};

// `text` is a file, a URI or a sequence folder: seqinfo.ini with imDir, imExt, frameRate and
// seqLength under [Sequence], and the pictures 000001 and on. Throws SourceError where it does not
// exist, cannot be read or lacks a picture. What is in the files is not looked at.
Source FindSource(const std::string& text);

}  // namespace windhover
