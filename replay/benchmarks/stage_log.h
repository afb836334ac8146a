// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "replay/benchmarks/figures.h"

namespace windhover::replay {

// What the stages of frames took. A frame in which a stage does not run counts as 0 ms for it.
class StageLog {
 public:
  // By whose clock: of the host around the service's steps and around operators, or of the device.
  enum class Level { kService, kOperator, kDevice };

  // Adds up what comes more than once in a frame.
  void Add(Level level, const std::string& stage, double ms);
  void EndFrame();

  // A row for each stage, in order of level and first appearance: level, stage, runs a frame,
  // median and 95th percentile of the ms of a frame.
  std::vector<std::vector<TableCell>> Rows() const;
  static std::vector<std::string> Columns();

 private:
  struct Stage {
    Level level;
    std::string name;
    int runs = 0;
    double frame_ms = 0;            // of the frame that has not ended
    std::vector<double> frames_ms;  // of those that have
  };
  std::vector<Stage> stages_;
  std::size_t frames_ = 0;
};

}  // namespace windhover::replay
