// SPDX-License-Identifier: Apache-2.0
#include "replay/benchmarks/stage_log.h"

#include <algorithm>

#include "replay/benchmarks/timing.h"

namespace windhover::replay {

void StageLog::Add(Level level, const std::string& stage, double ms) {
  auto found = std::find_if(stages_.begin(), stages_.end(), [&](const Stage& one) {
    return one.level == level && one.name == stage;
  });
  if (found == stages_.end()) {
    found = stages_.insert(stages_.end(), {level, stage, 0, 0, std::vector<double>(frames_)});
  }
  ++found->runs;
  found->frame_ms += ms;
}

void StageLog::EndFrame() {
  for (Stage& stage : stages_) {
    stage.frames_ms.push_back(stage.frame_ms);
    stage.frame_ms = 0;
  }
  ++frames_;
}

std::vector<std::string> StageLog::Columns() {
  return {"level", "stage", "runs a frame", "median ms", "p95 ms"};
}

std::vector<std::vector<TableCell>> StageLog::Rows() const {
  std::vector<std::vector<TableCell>> rows;
  for (const auto& [level, name] : {std::pair{Level::kService, "service"},
                                    {Level::kOperator, "operator"},
                                    {Level::kDevice, "device"}}) {
    for (const Stage& stage : stages_) {
      if (stage.level != level || frames_ == 0) continue;
      rows.push_back({name, stage.name,
                      static_cast<double>(stage.runs) / static_cast<double>(frames_),
                      Quantile(stage.frames_ms, 0.5), Quantile(stage.frames_ms, 0.95)});
    }
  }
  return rows;
}

}  // namespace windhover::replay
