// SPDX-License-Identifier: Apache-2.0
#include "service/vision/extraction.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace windhover {
namespace {

std::uint32_t Word(const std::uint32_t* row, int index, int count) {
  return index < 0 || index >= count ? 0U : row[index];
}

// out = each pixel joined with its `radius` neighbours to the left and right, by OR or by AND.
template <bool kAny>
void CombineRow(const std::uint32_t* in, std::uint32_t* out, int words, int radius) {
  for (int i = 0; i < words; ++i) {
    std::uint32_t combined = in[i];
    for (int shift = 1; shift <= radius; ++shift) {
      const std::uint32_t from_left = (in[i] << shift) | (Word(in, i - 1, words) >> (32 - shift));
      const std::uint32_t from_right = (in[i] >> shift) | (Word(in, i + 1, words) << (32 - shift));
      combined = kAny ? combined | from_left | from_right : combined & from_left & from_right;
    }
    out[i] = combined;
  }
}

bool EmptyRow(const std::uint32_t* row, int words) {
  return std::all_of(row, row + words, [](std::uint32_t word) { return word == 0; });
}

}  // namespace

SeedExtraction::SeedExtraction(int erosion_px, int dilation_px, int min_area_px)
    : erosion_px_(erosion_px), dilation_px_(dilation_px), min_area_px_(min_area_px) {}

const std::vector<SeedComponent>& SeedExtraction::Run(const BitView& seeds,
                                                      const Eigen::Matrix3d& frame_from_grid) {
  Erode(seeds);
  Dilate();
  grown_.Collect(plane_.View());
  LabelRuns();
  GatherPieces(seeds);
  std::erase_if(components_,
                [&](const SeedComponent& component) { return component.area_px < min_area_px_; });
  for (SeedComponent& component : components_) component.box = FrameBox(component, frame_from_grid);
  return components_;
}

void SeedExtraction::Erode(const BitView& seeds) {
  const int words = seeds.words_per_row();
  plane_.Reset(seeds.width, seeds.height);
  scratch_.Reset(seeds.width, seeds.height);
  for (int y = 0; y < seeds.height; ++y) {
    if (EmptyRow(seeds.row(y), words)) continue;
    CombineRow<false>(seeds.row(y), scratch_.row(y), words, erosion_px_);
  }
  for (int y = erosion_px_; y < seeds.height - erosion_px_; ++y) {
    std::uint32_t* out = plane_.row(y);
    std::copy_n(scratch_.row(y), words, out);
    for (int dy = 1; dy <= erosion_px_; ++dy) {
      const std::uint32_t* above = scratch_.row(y - dy);
      const std::uint32_t* below = scratch_.row(y + dy);
      for (int i = 0; i < words; ++i) out[i] &= above[i] & below[i];
    }
  }
}

void SeedExtraction::Dilate() {
  if (dilation_px_ == 0) return;
  const int words = plane_.words_per_row();
  const int width = plane_.width();
  const int height = plane_.height();
  const std::uint32_t last_word = width % 32 == 0 ? ~0U : ~0U >> (32 - width % 32);
  scratch_.Reset(width, height);
  for (int y = 0; y < height; ++y) {
    if (EmptyRow(plane_.row(y), words)) continue;
    CombineRow<true>(plane_.row(y), scratch_.row(y), words, dilation_px_);
    scratch_.row(y)[words - 1] &= last_word;
  }
  plane_.Reset(width, height);
  for (int y = 0; y < height; ++y) {
    const std::uint32_t* in = scratch_.row(y);
    if (EmptyRow(in, words)) continue;
    const int bottom = std::min(height - 1, y + dilation_px_);
    for (int to = std::max(0, y - dilation_px_); to <= bottom; ++to) {
      std::uint32_t* out = plane_.row(to);
      for (int i = 0; i < words; ++i) out[i] |= in[i];
    }
  }
}

int SeedExtraction::Root(int run) {
  while (parent_[run] != run) {
    parent_[run] = parent_[parent_[run]];
    run = parent_[run];
  }
  return run;
}

// Components of the dilated map by union-find over its runs.
void SeedExtraction::LabelRuns() {
  const int count = static_cast<int>(grown_.runs.size());
  parent_.resize(count);
  component_of_.resize(count);
  for (int i = 0; i < count; ++i) parent_[i] = i;
  const int height = static_cast<int>(grown_.row_begin.size()) - 1;
  for (int y = 1; y < height; ++y) {
    int above = grown_.row_begin[y - 1];
    const int above_end = grown_.row_begin[y];
    for (int i = grown_.row_begin[y]; i < grown_.row_begin[y + 1]; ++i) {
      const BitRun& run = grown_.runs[i];
      while (above < above_end && grown_.runs[above].last < run.first - 1) ++above;
      for (int j = above; j < above_end && grown_.runs[j].first <= run.last + 1; ++j) {
        const int a = Root(i);
        const int b = Root(j);
        parent_[std::max(a, b)] = std::min(a, b);
      }
    }
  }
  components_.clear();
  for (int i = 0; i < count; ++i) {
    const int root = Root(i);
    if (root == i) {
      component_of_[i] = static_cast<int>(components_.size());
      components_.emplace_back();
    } else {
      component_of_[i] = component_of_[root];
    }
  }
}

// Gives each run of seeds to the component that covers it. A run of seeds lies within one run of
// the dilated map unless erosion bit into it; it is given by its first covered pixel.
void SeedExtraction::GatherPieces(const BitView& seeds) {
  sparse_.Collect(seeds);
  grown_of_.assign(sparse_.runs.size(), -1);
  for (int y = 0; y < seeds.height; ++y) {
    int grown = grown_.row_begin[y];
    const int grown_end = grown_.row_begin[y + 1];
    for (int i = sparse_.row_begin[y]; i < sparse_.row_begin[y + 1]; ++i) {
      const BitRun& run = sparse_.runs[i];
      while (grown < grown_end && grown_.runs[grown].last < run.first) ++grown;
      if (grown == grown_end || grown_.runs[grown].first > run.last) continue;
      grown_of_[i] = grown;
      SeedComponent& component = components_[component_of_[grown]];
      if (component.area_px == 0) {
        component.left = run.first;
        component.top = y;
      }
      component.left = std::min(component.left, run.first);
      component.right = std::max(component.right, run.last);
      component.bottom = y;
      component.area_px += run.last - run.first + 1;
      ++component.piece_count;
    }
  }
  int begin = 0;
  for (SeedComponent& component : components_) {
    component.first_piece = begin;
    begin += component.piece_count;
    component.piece_count = 0;
  }
  pieces_.resize(begin);
  for (std::size_t i = 0; i < sparse_.runs.size(); ++i) {
    if (grown_of_[i] < 0) continue;
    SeedComponent& component = components_[component_of_[grown_of_[i]]];
    pieces_[component.first_piece + component.piece_count++] = sparse_.runs[i];
  }
}

Box SeedExtraction::FrameBox(const SeedComponent& component,
                             const Eigen::Matrix3d& frame_from_grid) const {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  for (int i = 0; i < component.piece_count; ++i) {
    const BitRun& run = pieces_[component.first_piece + i];
    for (const int x : {run.first, run.last}) {
      const Eigen::Vector2d in_frame =
          (frame_from_grid * Eigen::Vector3d(x, run.y, 1)).hnormalized();
      low = low.cwiseMin(in_frame);
      high = high.cwiseMax(in_frame);
    }
  }
  return {low.x(), low.y(), high.x() - low.x() + 1.0, high.y() - low.y() + 1.0};
}

}  // namespace windhover
