// SPDX-License-Identifier: Apache-2.0
#include "service/vision/voting.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "gpu-kernels/multiversion.h"

namespace windhover {
namespace {

constexpr int kSmallestBlock = 4;
constexpr int kLargestBlock = 32;
constexpr std::size_t kMaxBlocks = 4096;
// How far from its pixel's centre a seed may belong to the trajectory, px: half a pixel for the
// raster and half a pixel for the registration and for what is not constant in the velocity.
constexpr double kSeedRadiusPx = 1.0;
// The share that is asked for is that of this part of the window's frames at least, even where less
// of them see the trajectory's ground.
constexpr double kLeastSeen = 0.4;

// Adds one to each cell that is set in rows first..last of `votes`.
WINDHOVER_MULTIVERSION
void AddVotes(std::uint64_t* planes, int plane_count, int rows_per_plane, std::uint64_t* votes,
              int first, int last) {
  for (int plane = 0; plane < plane_count; ++plane) {
    std::uint64_t* count = planes + static_cast<std::ptrdiff_t>(plane) * rows_per_plane;
    for (int row = first; row <= last; ++row) {
      const std::uint64_t carry = count[row] & votes[row];
      count[row] ^= votes[row];
      votes[row] = carry;
    }
  }
}

std::uint64_t BitsBetween(int first, int last) {
  return (~std::uint64_t{0} << first) & (~std::uint64_t{0} >> (63 - last));
}

}  // namespace

VotingFilter::VotingFilter(double max_speed_px, double share)
    : max_speed_px_(max_speed_px), share_(share) {}

void VotingFilter::Run(std::span<const WindowSample> window, std::size_t centre, BitPlane& kept) {
  const BitView& seeds = window[centre].seeds;
  kept.Reset(seeds.width, seeds.height);
  CollectBlocks(seeds);
  if (blocks_.empty()) return;
  PrepareVoters(window, centre);
  for (Block& block : blocks_) Judge(window, block);

  for (const Block& block : blocks_) {
    if (!block.kept) continue;
    const int left = block.x / block_size_ * block_size_;
    const int top = block.y / block_size_ * block_size_;
    const int bottom = std::min(top + block_size_, seeds.height);
    const std::uint32_t bits = (~0U >> (32 - block_size_)) << (left % 32);
    for (int y = top; y < bottom; ++y) {
      kept.row(y)[left / 32] |= seeds.row(y)[left / 32] & bits;
    }
  }
}

const SeedVote& VotingFilter::At(int x, int y) const {
  static const SeedVote kNone;
  if (block_at_.empty()) return kNone;
  const int index = block_at_[(y / block_size_) * blocks_across_ + x / block_size_];
  return index < 0 ? kNone : blocks_[index].vote;
}

void VotingFilter::PrepareVoters(std::span<const WindowSample> window, std::size_t centre) {
  voter_count_ = window.size() - 1;
  if (voters_.size() < voter_count_) voters_.resize(voter_count_);
  furthest_ = 1;
  std::size_t next = 0;
  for (std::size_t i = 0; i < window.size(); ++i) {
    if (i == centre) continue;
    voters_[next].sample = i;
    voters_[next].offset_frames = window[i].offset_frames;
    furthest_ = std::max(furthest_, std::abs(window[i].offset_frames));
    ++next;
  }
  cell_px_ = std::max(1.0, max_speed_px_ * furthest_ / kMiddle);
  plane_count_ = std::bit_width(voter_count_);

  for (std::size_t i = 0; i < voter_count_; ++i) {
    Voter& voter = voters_[i];
    voter.runs.Collect(window[voter.sample].seeds);
    const int distance = std::max(1, std::abs(voter.offset_frames));
    voter.reach = static_cast<int>(std::ceil(max_speed_px_ * distance));
    voter.cells.resize(2 * voter.reach + 1);
    const double scale = furthest_ / (distance * cell_px_);
    const int sign = voter.offset_frames < 0 ? -1 : 1;
    for (int d = -voter.reach; d <= voter.reach; ++d) {
      const double low = kMiddle + (sign * d - kSeedRadiusPx) * scale;
      const double high = kMiddle + (sign * d + kSeedRadiusPx) * scale;
      const int first = static_cast<int>(std::floor(low + 0.5));
      const int last = static_cast<int>(std::ceil(high - 0.5));
      voter.cells[d + voter.reach] = {static_cast<std::int16_t>(std::clamp(first, 0, kCells - 1)),
                                      static_cast<std::int16_t>(std::clamp(last, 0, kCells - 1))};
    }
  }
}

void VotingFilter::CollectBlocks(const BitView& seeds) {
  for (int size = kSmallestBlock; size <= kLargestBlock; size *= 2) {
    if (CollectBlocksOfSize(seeds, size)) return;
  }
}

// False where there are too many blocks of this size and larger ones can be had.
bool VotingFilter::CollectBlocksOfSize(const BitView& seeds, int size) {
  block_size_ = size;
  blocks_across_ = (seeds.width + size - 1) / size;
  const int blocks_down = (seeds.height + size - 1) / size;
  blocks_.clear();
  block_at_.assign(static_cast<std::size_t>(blocks_across_) * blocks_down, -1);
  const int words = seeds.words_per_row();
  const std::uint32_t mask = ~0U >> (32 - size);
  for (int by = 0; by < blocks_down; ++by) {
    const int bottom = std::min((by + 1) * size, seeds.height);
    for (int word = 0; word < words; ++word) {
      std::uint32_t any = 0;
      for (int y = by * size; y < bottom; ++y) any |= seeds.row(y)[word];
      while (any != 0) {
        const int in_word = std::countr_zero(any) / size;
        AddBlock(seeds, word * (32 / size) + in_word, by, size);
        any &= ~(mask << (in_word * size));
      }
    }
    if (blocks_.size() > kMaxBlocks && size < kLargestBlock) return false;
  }
  return true;
}

// The representative is the seed nearest to the centroid of the block's seeds.
void VotingFilter::AddBlock(const BitView& seeds, int bx, int by, int size) {
  const int left = bx * size;
  const int bottom = std::min((by + 1) * size, seeds.height);
  const std::uint32_t mask = ~0U >> (32 - size);
  const auto for_each = [&](auto&& visit) {
    for (int y = by * size; y < bottom; ++y) {
      std::uint32_t bits = seeds.row(y)[left / 32] >> (left % 32) & mask;
      for (; bits != 0; bits &= bits - 1) visit(left + std::countr_zero(bits), y);
    }
  };
  float sum_x = 0;
  float sum_y = 0;
  float count = 0;
  for_each([&](int x, int y) {
    sum_x += static_cast<float>(x);
    sum_y += static_cast<float>(y);
    ++count;
  });
  Block block{};
  float best = 1e9F;
  for_each([&](int x, int y) {
    const float dx = static_cast<float>(x) - sum_x / count;
    const float dy = static_cast<float>(y) - sum_y / count;
    if (dx * dx + dy * dy >= best) return;
    best = dx * dx + dy * dy;
    block.x = x;
    block.y = y;
  });
  block_at_[by * blocks_across_ + bx] = static_cast<int>(blocks_.size());
  blocks_.push_back(block);
}

void VotingFilter::Judge(std::span<const WindowSample> window, Block& block) {
  block.vote = {};
  block.kept = false;
  for (int plane = 0; plane < plane_count_; ++plane) planes_[plane].fill(0);
  for (std::size_t i = 0; i < voter_count_; ++i) CastVotes(voters_[i], block.x, block.y);
  const int votes = FindMaximum(block.vote.velocity_px);
  if (votes == 0) return;

  int seen = 0;
  for (std::size_t i = 0; i < voter_count_; ++i) {
    const WindowSample& sample = window[voters_[i].sample];
    const auto offset = static_cast<float>(sample.offset_frames);
    const long x = std::lround(static_cast<float>(block.x) + offset * block.vote.velocity_px.x());
    const long y = std::lround(static_cast<float>(block.y) + offset * block.vote.velocity_px.y());
    if (x < 0 || y < 0 || x >= sample.registered.width || y >= sample.registered.height) continue;
    if (sample.registered.row(static_cast<int>(y))[x] != 0) ++seen;
  }
  const double voters = std::max<double>(seen, kLeastSeen * static_cast<double>(voter_count_));
  block.vote.share = static_cast<float>(std::min(1.0, votes / voters));
  block.kept = block.vote.share >= share_;
}

void VotingFilter::CastVotes(const Voter& voter, int x, int y) {
  const int height = static_cast<int>(voter.runs.row_begin.size()) - 1;
  const int top = std::max(0, y - voter.reach);
  const int bottom = std::min(height - 1, y + voter.reach);
  const int left = x - voter.reach;
  const int right = x + voter.reach;
  const bool mirrored = voter.offset_frames < 0;
  const BitRun* run = voter.runs.runs.data() + voter.runs.row_begin[top];
  const BitRun* end = voter.runs.runs.data() + voter.runs.row_begin[bottom + 1];

  CellRows votes;
  int first_row = kRows;
  int last_row = -1;
  for (; run != end; ++run) {
    if (run->last < left || run->first > right) continue;
    const CellRange& from = voter.cells[std::max(run->first, left) - left];
    const CellRange& to = voter.cells[std::min(run->last, right) - left];
    const CellRange& rows = voter.cells[run->y - y + voter.reach];
    const std::uint64_t bits =
        mirrored ? BitsBetween(to.first, from.last) : BitsBetween(from.first, to.last);
    if (last_row < 0) votes.fill(0);
    first_row = std::min<int>(first_row, rows.first);
    last_row = std::max<int>(last_row, rows.last);
    for (int row = rows.first; row <= rows.last; ++row) votes[row] |= bits;
  }
  if (last_row < 0) return;
  AddVotes(planes_[0].data(), plane_count_, kRows, votes.data(), first_row, last_row);
}

// The largest count in V, and the velocity in the middle of the cells that reach it.
int VotingFilter::FindMaximum(Eigen::Vector2f& velocity_px) const {
  CellRows best;
  best.fill(~std::uint64_t{0});
  int votes = 0;
  for (int plane = plane_count_ - 1; plane >= 0; --plane) {
    std::uint64_t any = 0;
    for (int row = 0; row < kRows; ++row) any |= best[row] & planes_[plane][row];
    if (any == 0) continue;
    votes |= 1 << plane;
    for (int row = 0; row < kRows; ++row) best[row] &= planes_[plane][row];
  }
  if (votes == 0) return 0;
  float sum_x = 0;
  float sum_y = 0;
  float count = 0;
  for (int row = 0; row < kRows; ++row) {
    for (std::uint64_t bits = best[row]; bits != 0; bits &= bits - 1) {
      sum_x += static_cast<float>(std::countr_zero(bits) - kMiddle);
      sum_y += static_cast<float>(row - kMiddle);
      ++count;
    }
  }
  const float px_per_frame = static_cast<float>(cell_px_) / static_cast<float>(furthest_);
  velocity_px = Eigen::Vector2f(sum_x, sum_y) * (px_per_frame / count);
  return votes;
}

}  // namespace windhover
