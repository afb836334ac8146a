// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "service/vision/motion_window.h"

namespace windhover {

// What the window's frames say about a motion seed of the centre frame.
struct SeedVote {
  // The velocity of the trajectory that most frames vote for, px a frame on the grid.
  Eigen::Vector2f velocity_px = Eigen::Vector2f::Zero();
  // Share, 0 to 1, of the frames that see this trajectory and vote for it.
  float share = 0.0F;
};

// The voting filter (thesis 6.5.1): keeps a motion seed of the centre frame where the seeds of the
// other frames line up to one trajectory through it.
//
// The voting space V of a seed s is spanned by where an object that passes through s at constant
// velocity would be, relative to s, in the furthest frame of the window, D frames away. A seed at q
// in frame j, that is d_j frames away, votes for (q - s) D / d_j: for its own location, carried on
// to the furthest frame. So all votes of one trajectory meet in one place, from both time
// directions. Being known to within a pixel or so, the vote covers a footprint that is D / |d_j|
// times as wide, and the window of frame j that can vote at all is max_speed |d_j| in each
// direction: the footprint is inversely proportional to the size of the window, as the thesis has
// it. Each frame votes for a place of V once, however many of its seeds do. The seed is kept where
// the maximum of V reaches `share` of the frames in which that trajectory's ground is seen, taken
// to be 40 % of the window's frames at least.
//
// A thing that rests can win no more than half of the frames, because in more than half of them it
// would be the background: that is what removes the ghosts of things that came or left.
//
// Seeds vote and are judged in blocks of 4x4 px through one representative each; where there are
// more than 2048 such blocks, in larger ones, so that the work stays bounded.
class VotingFilter {
 public:
  // `max_speed_px` > 0 in px a frame; `share` 0 to 1.
  VotingFilter(double max_speed_px, double share);

  // Sets in `kept` (of the grid's size afterwards) the seeds of window[centre] that are kept. In a
  // window of one frame nothing is kept: nobody votes. All samples have one size.
  void Run(std::span<const WindowSample> window, std::size_t centre, BitPlane& kept);

  // The outcome for the block that holds (x, y), as of the last Run; zero where it had no seed.
  const SeedVote& At(int x, int y) const;

 private:
  // V has 63 x 63 cells, a row of them in one 64-bit word; velocity 0 lies in the middle cell. The
  // votes are counted in bit planes: bit b of a cell's count stands in planes_[b].
  static constexpr int kCells = 63;
  static constexpr int kMiddle = kCells / 2;
  static constexpr int kRows = 64;
  static constexpr int kMaxPlanes = 8;
  using CellRows = std::array<std::uint64_t, kRows>;

  struct CellRange {
    int first;
    int last;
  };
  // Cells of a pixel's footprint, along one axis, and the one that it lies in.
  struct CellsOfPx {
    int first;
    int last;
    int middle;
  };
  // How the seeds of one frame vote. Where its pixels are not much larger than cells, the seeds are
  // laid out as V sees them once for all blocks: `cells` is a bit picture of footprints, from which
  // a block reads its window. The footprints of nearer frames are large and their windows small:
  // those are cast seed by seed.
  struct Voter {
    std::size_t sample;
    int offset_frames;
    double cells_per_px;
    int reach;  // half the window, px
    bool laid_out;
    // Columns of 64 cells: the words of one column lie one below the other, so that a window is
    // read from two stretches of memory.
    std::vector<std::uint64_t> cells;
    std::ptrdiff_t column_words;
    std::vector<CellsOfPx> cells_of_px;
    double tabulated_cells_per_px = 0.0;
    BitView seeds;
    std::vector<CellRange> footprint;  // of a seed at distance d: footprint[d + reach]
  };
  struct Block {
    int x;
    int y;  // of the representative seed
    SeedVote vote;
    bool kept;

    Eigen::Vector2f at() const { return {static_cast<float>(x), static_cast<float>(y)}; }
  };
  static CellRange Footprint(double px, double cells_per_px);

  void PrepareVoters(std::span<const WindowSample> window, std::size_t centre);
  void TabulateCells(Voter& voter, int length_px) const;
  void LayOut(Voter& voter);
  void CollectBlocks(const BitView& seeds);
  bool CollectBlocksOfSize(const BitView& seeds, int size);
  void AddBlock(const BitView& seeds, int bx, int by, int size);
  void Judge(std::span<const WindowSample> window, Block& block);
  void CastAll(int x, int y);
  void ReadLaidOut(const Voter& voter, int x, int y, CellRows& votes) const;
  void CastSeedBySeed(const Voter& voter, int x, int y, int planes);
  int FindMaximum(Eigen::Vector2f& velocity_px) const;

  double max_speed_px_;
  double share_;
  int furthest_ = 0;
  double cell_px_ = 1.0;  // size of a cell of V in the furthest frame
  int plane_count_ = 0;
  std::array<CellRows, kMaxPlanes> planes_{};
  int width_ = 0;
  int height_ = 0;
  BitRuns runs_;
  std::vector<Voter> voters_;  // may hold more than voter_count_, for reuse
  std::size_t voter_count_ = 0;
  std::vector<Block> blocks_;
  int block_size_ = 4;
  int blocks_across_ = 0;
  std::vector<int> block_at_;  // index into blocks_, or -1
};

}  // namespace windhover
