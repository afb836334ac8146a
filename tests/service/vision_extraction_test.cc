// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "service/vision/extraction.h"

namespace windhover {
namespace {

BitPlane Plane(int width, int height) {
  BitPlane plane;
  plane.Reset(width, height);
  return plane;
}

void Fill(BitPlane& plane, int x, int y, int width, int height) {
  for (int v = y; v < y + height; ++v) {
    for (int u = x; u < x + width; ++u) plane.row(v)[u / 32] |= 1U << (u % 32);
  }
}

void ExpectBox(const Box& box, double x, double y, double width, double height, double tolerance) {
  EXPECT_NEAR(box.x, x, tolerance);
  EXPECT_NEAR(box.y, y, tolerance);
  EXPECT_NEAR(box.width, width, tolerance);
  EXPECT_NEAR(box.height, height, tolerance);
}

const Eigen::Matrix3d kSame = Eigen::Matrix3d::Identity();

TEST(SeedExtraction, BoxesFitAcrossWords) {
  BitPlane plane = Plane(100, 60);
  Fill(plane, 28, 10, 8, 5);
  Fill(plane, 90, 50, 10, 10);
  Fill(plane, 0, 0, 3, 3);
  SeedExtraction extraction(0, 2, 1);
  const auto& components = extraction.Run(plane.View(), kSame);
  ASSERT_EQ(components.size(), 3U);
  ExpectBox(components[0].box, 0, 0, 3, 3, 0);
  ExpectBox(components[1].box, 28, 10, 8, 5, 0);
  ExpectBox(components[2].box, 90, 50, 10, 10, 0);
  EXPECT_EQ(components[1].area_px, 40);
}

TEST(SeedExtraction, DilationJoinsTheFragmentsOfAnObject) {
  BitPlane plane = Plane(100, 60);
  Fill(plane, 20, 20, 4, 3);
  Fill(plane, 28, 21, 4, 3);
  SeedExtraction joined(0, 2, 1);
  ASSERT_EQ(joined.Run(plane.View(), kSame).size(), 1U);
  ExpectBox(joined.Run(plane.View(), kSame)[0].box, 20, 20, 12, 4, 0);
  EXPECT_EQ(joined.Run(plane.View(), kSame)[0].area_px, 24);
  SeedExtraction apart(0, 1, 1);
  EXPECT_EQ(apart.Run(plane.View(), kSame).size(), 2U);
}

TEST(SeedExtraction, ErosionRemovesSpecksAndLeavesBoxesAlone) {
  BitPlane plane = Plane(100, 60);
  Fill(plane, 20, 20, 2, 2);
  Fill(plane, 61, 30, 7, 5);
  SeedExtraction extraction(1, 2, 1);
  const auto& components = extraction.Run(plane.View(), kSame);
  ASSERT_EQ(components.size(), 1U);
  ExpectBox(components[0].box, 61, 30, 7, 5, 0);
  EXPECT_EQ(components[0].area_px, 35);
}

TEST(SeedExtraction, DropsWhatIsTooSmall) {
  BitPlane plane = Plane(100, 60);
  Fill(plane, 20, 20, 3, 3);
  Fill(plane, 61, 30, 4, 3);
  SeedExtraction extraction(0, 2, 10);
  const auto& components = extraction.Run(plane.View(), kSame);
  ASSERT_EQ(components.size(), 1U);
  EXPECT_EQ(components[0].area_px, 12);
}

TEST(SeedExtraction, DiagonalNeighboursAndBranchesAreOneThing) {
  BitPlane plane = Plane(100, 60);
  Fill(plane, 10, 10, 2, 20);  // two branches that meet at the bottom
  Fill(plane, 20, 10, 2, 20);
  Fill(plane, 12, 30, 8, 2);
  Fill(plane, 50, 10, 1, 1);
  Fill(plane, 51, 11, 1, 1);
  SeedExtraction extraction(0, 0, 1);
  const auto& components = extraction.Run(plane.View(), kSame);
  ASSERT_EQ(components.size(), 2U);
  ExpectBox(components[0].box, 10, 10, 12, 22, 0);
  EXPECT_EQ(components[0].area_px, 96);
  EXPECT_EQ(components[1].area_px, 2);
}

TEST(SeedExtraction, PiecesAreTheSeedsOfTheirComponent) {
  BitPlane plane = Plane(100, 60);
  Fill(plane, 10, 10, 5, 3);
  Fill(plane, 40, 11, 6, 3);
  SeedExtraction extraction(0, 2, 1);
  for (const SeedComponent& component : extraction.Run(plane.View(), kSame)) {
    int area = 0;
    for (int i = 0; i < component.piece_count; ++i) {
      const BitRun& piece = extraction.pieces()[component.first_piece + i];
      EXPECT_GE(piece.first, component.box.x);
      EXPECT_LT(piece.last, component.box.x + component.box.width);
      area += piece.last - piece.first + 1;
    }
    EXPECT_EQ(area, component.area_px);
  }
}

// A car upright in the frame lies askew on a turned grid; its box must still fit it.
TEST(SeedExtraction, ATurnedGridDoesNotInflateTheBox) {
  for (const double degrees : {10.0, 30.0, 45.0, 80.0, 140.0}) {
    Eigen::Matrix3d frame_from_grid = Eigen::Matrix3d::Identity();
    frame_from_grid.topLeftCorner<2, 2>() =
        Eigen::Rotation2Dd(degrees * std::numbers::pi / 180).toRotationMatrix();
    const Eigen::Vector2d centre(100, 100);
    frame_from_grid.topRightCorner<2, 1>() =
        centre - frame_from_grid.topLeftCorner<2, 2>() * centre;
    BitPlane plane = Plane(200, 200);
    for (int y = 0; y < 200; ++y) {
      for (int x = 0; x < 200; ++x) {
        const Eigen::Vector2d in_frame = (frame_from_grid * Eigen::Vector3d(x, y, 1)).head<2>();
        if (in_frame.x() > 79.5 && in_frame.x() < 119.5 && in_frame.y() > 94.5 &&
            in_frame.y() < 104.5) {
          Fill(plane, x, y, 1, 1);
        }
      }
    }
    SeedExtraction extraction(0, 2, 1);
    const auto& components = extraction.Run(plane.View(), frame_from_grid);
    ASSERT_EQ(components.size(), 1U);
    ExpectBox(components[0].box, 80, 95, 40, 10, 1.0);
  }
}

TEST(SeedExtraction, Degenerate) {
  SeedExtraction extraction(0, 2, 1);
  EXPECT_TRUE(extraction.Run(Plane(64, 8).View(), kSame).empty());

  BitPlane all = Plane(70, 40);
  Fill(all, 0, 0, 70, 40);
  ASSERT_EQ(extraction.Run(all.View(), kSame).size(), 1U);
  ExpectBox(extraction.Run(all.View(), kSame)[0].box, 0, 0, 70, 40, 0);

  BitPlane tiny = Plane(1, 1);
  Fill(tiny, 0, 0, 1, 1);
  ASSERT_EQ(extraction.Run(tiny.View(), kSame).size(), 1U);
  SeedExtraction eroding(3, 2, 1);
  EXPECT_TRUE(eroding.Run(tiny.View(), kSame).empty());
}

}  // namespace
}  // namespace windhover
