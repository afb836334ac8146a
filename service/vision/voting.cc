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
constexpr std::size_t kMaxBlocks = 2048;
// How far from its pixel's centre a seed may belong to the trajectory, px: half a pixel for the
// raster and half a pixel for the registration and for what is not constant in the velocity.
constexpr double kSeedRadiusPx = 1.0;
// Frames whose pixels are at most so many cells wide are laid out.
constexpr double kLaidOutCellsPerPx = 2.0;
// Empty cells around a laid out picture: a window may reach so far beyond.
constexpr int kMargin = 32;
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

// Adds three votes to each cell at once; destroys them. Needs two planes or more.
WINDHOVER_MULTIVERSION
void AddThreeVotes(std::uint64_t* planes, int plane_count, int rows, std::uint64_t* a,
                   std::uint64_t* b, const std::uint64_t* c) {
  std::uint64_t* ones = planes;
  std::uint64_t* twos = planes + rows;
  for (int row = 0; row < rows; ++row) {
    const std::uint64_t odd = a[row] ^ b[row];
    const std::uint64_t one = odd ^ c[row];
    const std::uint64_t two = (a[row] & b[row]) | (odd & c[row]);
    const std::uint64_t carry = ones[row] & one;
    ones[row] ^= one;
    const std::uint64_t sum = twos[row] ^ two;
    a[row] = (twos[row] & two) | (sum & carry);
    twos[row] = sum ^ carry;
  }
  for (int plane = 2; plane < plane_count; ++plane) {
    std::uint64_t* count = planes + static_cast<std::ptrdiff_t>(plane) * rows;
    for (int row = 0; row < rows; ++row) {
      const std::uint64_t carry = count[row] & a[row];
      count[row] ^= a[row];
      a[row] = carry;
    }
  }
}

// Reads 64 cells of each of `rows` rows, from bit `shift` of a column of words on.
WINDHOVER_MULTIVERSION
void ReadCells(const std::uint64_t* column, std::ptrdiff_t column_words, int shift, int rows,
               std::uint64_t* cells) {
  const std::uint64_t* next = column + column_words;
  for (int row = 0; row < rows; ++row) {
    cells[row] = (column[row] >> shift) | (next[row] << 1 << (63 - shift));
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

// The cells that a seed `px` pixels from the origin votes for; cell c is centred on c.
VotingFilter::CellRange VotingFilter::Footprint(double px, double cells_per_px) {
  const auto first = static_cast<int>(std::floor((px - kSeedRadiusPx) * cells_per_px + 0.5));
  const auto last = static_cast<int>(std::ceil((px + kSeedRadiusPx) * cells_per_px - 0.5));
  return {first, std::max(first, last)};
}

void VotingFilter::PrepareVoters(std::span<const WindowSample> window, std::size_t centre) {
  width_ = window[centre].seeds.width;
  height_ = window[centre].seeds.height;
  voter_count_ = window.size() - 1;
  if (voters_.size() < voter_count_) voters_.resize(voter_count_);
  furthest_ = 1;
  for (const WindowSample& sample : window) {
    furthest_ = std::max(furthest_, std::abs(sample.offset_frames));
  }
  cell_px_ = std::max(1.0, max_speed_px_ * furthest_ / kMiddle);

  std::size_t next = 0;
  for (std::size_t i = 0; i < window.size(); ++i) {
    if (i == centre) continue;
    Voter& voter = voters_[next++];
    voter.sample = i;
    voter.seeds = window[i].seeds;
    voter.offset_frames = window[i].offset_frames;
    const int distance = std::max(1, std::abs(voter.offset_frames));
    voter.cells_per_px = furthest_ / (distance * cell_px_);
    voter.laid_out = voter.cells_per_px <= kLaidOutCellsPerPx;
    if (voter.laid_out) {
      LayOut(voter);
      continue;
    }
    voter.reach = static_cast<int>(std::ceil(max_speed_px_ * distance));
    voter.footprint.resize(2 * voter.reach + 1);
    const int sign = voter.offset_frames < 0 ? -1 : 1;
    for (int d = -voter.reach; d <= voter.reach; ++d) {
      const CellRange range = Footprint(sign * d, voter.cells_per_px);
      voter.footprint[d + voter.reach] = {std::clamp(range.first + kMiddle, 0, kCells - 1),
                                          std::clamp(range.last + kMiddle, 0, kCells - 1)};
    }
  }
}

void VotingFilter::TabulateCells(Voter& voter, int length_px) const {
  if (voter.tabulated_cells_per_px == voter.cells_per_px &&
      std::ssize(voter.cells_of_px) >= length_px) {
    return;
  }
  voter.tabulated_cells_per_px = voter.cells_per_px;
  voter.cells_of_px.resize(length_px);
  for (int px = 0; px < length_px; ++px) {
    const CellRange range = Footprint(px, voter.cells_per_px);
    voter.cells_of_px[px] = {range.first + kMargin, range.last + kMargin,
                             static_cast<int>(px * voter.cells_per_px + 0.5) + kMargin};
  }
}

// Frames before the centre are laid out upside down and back to front, so that their votes, too,
// point to where the object will be.
void VotingFilter::LayOut(Voter& voter) {
  const bool mirrored = voter.offset_frames < 0;
  TabulateCells(voter, std::max(width_, height_));
  const auto across = static_cast<int>(std::ceil(width_ * voter.cells_per_px)) + 2 * kMargin;
  const auto down = static_cast<int>(std::ceil(height_ * voter.cells_per_px)) + 2 * kMargin;
  voter.column_words = down + 1;
  voter.cells.assign(voter.column_words * (across / 64 + 2), 0);
  runs_.Collect(voter.seeds);
  for (const BitRun& run : runs_.runs) {
    const CellsOfPx& rows = voter.cells_of_px[mirrored ? height_ - 1 - run.y : run.y];
    const int first = voter.cells_of_px[mirrored ? width_ - 1 - run.last : run.first].first;
    const int last = voter.cells_of_px[mirrored ? width_ - 1 - run.first : run.last].last;
    for (int i = first / 64; i <= last / 64; ++i) {
      const std::uint64_t bits =
          BitsBetween(std::max(first - 64 * i, 0), std::min(last - 64 * i, 63));
      std::uint64_t* column = voter.cells.data() + i * voter.column_words;
      for (int row = rows.first; row <= rows.last; ++row) column[row] |= bits;
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
  plane_count_ = std::bit_width(voter_count_);
  for (int plane = 0; plane < plane_count_; ++plane) planes_[plane].fill(0);
  CastAll(block.x, block.y);
  const int votes = FindMaximum(block.vote.velocity_px);
  if (votes == 0) return;

  int seen = 0;
  for (std::size_t i = 0; i < voter_count_; ++i) {
    const WindowSample& sample = window[voters_[i].sample];
    const auto offset = static_cast<float>(sample.offset_frames);
    const Eigen::Vector2f at =
        block.at() + offset * block.vote.velocity_px + Eigen::Vector2f::Constant(0.5F);
    if (at.minCoeff() < 0) continue;
    const int x = static_cast<int>(at.x());
    const int y = static_cast<int>(at.y());
    if (x >= sample.registered.width || y >= sample.registered.height) continue;
    if (sample.registered.row(y)[x] != 0) ++seen;
  }
  const double voters = std::max<double>(seen, kLeastSeen * static_cast<double>(voter_count_));
  block.vote.share = static_cast<float>(std::min(1.0, votes / voters));
  block.kept = block.vote.share >= share_;
}

// Counts all votes for the seed at (x, y). The lowest bit_width(n) planes hold any count up to n.
void VotingFilter::CastAll(int x, int y) {
  std::size_t cast = 0;
  std::array<CellRows, 3> votes;
  std::size_t waiting = 0;
  for (std::size_t i = 0; i < voter_count_; ++i) {
    if (!voters_[i].laid_out) {
      CastSeedBySeed(voters_[i], x, y, std::bit_width(++cast));
      continue;
    }
    ReadLaidOut(voters_[i], x, y, votes[waiting++]);
    if (waiting < votes.size()) continue;
    cast += waiting;
    AddThreeVotes(planes_[0].data(), std::bit_width(cast), kRows, votes[0].data(), votes[1].data(),
                  votes[2].data());
    waiting = 0;
  }
  while (waiting > 0) {
    AddVotes(planes_[0].data(), std::bit_width(++cast), kRows, votes[--waiting].data(), 0,
             kRows - 1);
  }
}

// What a frame that is laid out votes for the seed at (x, y). What lies past the last cell of a row
// comes along, too.
void VotingFilter::ReadLaidOut(const Voter& voter, int x, int y, CellRows& votes) const {
  const bool mirrored = voter.offset_frames < 0;
  const int left = voter.cells_of_px[mirrored ? width_ - 1 - x : x].middle - kMiddle;
  const int top = voter.cells_of_px[mirrored ? height_ - 1 - y : y].middle - kMiddle;
  ReadCells(voter.cells.data() + (left / 64) * voter.column_words + top, voter.column_words,
            left % 64, kCells, votes.data());
  votes[kCells] = 0;
}

void VotingFilter::CastSeedBySeed(const Voter& voter, int x, int y, int planes) {
  const int left = x - voter.reach;
  const int across = 2 * voter.reach + 1;
  const int top = std::max(0, y - voter.reach);
  const int bottom = std::min(height_ - 1, y + voter.reach);
  const bool mirrored = voter.offset_frames < 0;
  CellRows votes;
  int first_row = kRows;
  int last_row = -1;
  for (int seed_y = top; seed_y <= bottom; ++seed_y) {
    std::uint64_t bits = voter.seeds.Read(left, seed_y) & (~std::uint64_t{0} >> (64 - across));
    if (bits == 0) continue;
    if (last_row < 0) votes.fill(0);
    std::uint64_t cells = 0;
    while (bits != 0) {
      const int first = std::countr_zero(bits);
      const int last = first + std::countr_one(bits >> first) - 1;
      bits &= ~BitsBetween(first, last);
      const CellRange& from = voter.footprint[mirrored ? last : first];
      const CellRange& to = voter.footprint[mirrored ? first : last];
      cells |= BitsBetween(from.first, to.last);
    }
    const CellRange& rows = voter.footprint[seed_y - y + voter.reach];
    first_row = std::min(first_row, rows.first);
    last_row = std::max(last_row, rows.last);
    for (int row = rows.first; row <= rows.last; ++row) votes[row] |= cells;
  }
  if (last_row < 0) return;
  AddVotes(planes_[0].data(), planes, kRows, votes.data(), first_row, last_row);
}

// The largest count in V, and the velocity in the middle of the cells that reach it.
int VotingFilter::FindMaximum(Eigen::Vector2f& velocity_px) const {
  CellRows best;
  best.fill(~std::uint64_t{0} >> (64 - kCells));
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
