// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>

#include "tests/gst-plugins/harness.h"
#include "tests/gst-plugins/test_video.h"
#include "tests/support/allocation_count.h"

namespace windhover {
namespace {

// GStreamer's own allocations do not go through operator new and are not counted; those of our code
// and of the libraries below it are.
class AllocationTest : public testing::TestWithParam<const char*> {};

TEST_P(AllocationTest, NoneAFrameAfterWarmUp) {
  TestVideo video(161, 121, GST_VIDEO_FORMAT_BGR);
  Harness harness(std::string("whregister device=cpu tile-columns=4 tile-rows=4 ! ") + GetParam());
  harness.SetCaps(video.Caps());
  harness.ReserveLog(1000);
  constexpr int kWarmUp = 40;
  std::size_t during_warm_up = 0;
  std::size_t after = 0;
  for (int t = 0; t < kWarmUp + 20; ++t) {
    BufferPtr frame = video.Frame(t);
    const std::size_t before = AllocationCount();
    ASSERT_EQ(harness.Push(std::move(frame)), GST_FLOW_OK);
    (t < kWarmUp ? during_warm_up : after) += AllocationCount() - before;
    harness.PullAll();
  }
  EXPECT_GT(during_warm_up, 0u) << "the plugin's allocations are not counted";
  EXPECT_EQ(after, 0u);
}

INSTANTIATE_TEST_SUITE_P(
    Elements, AllocationTest,
    testing::Values("whbackground device=cpu tile-columns=4 tile-rows=4 k=3 lookahead=3",
                    "whstabilize max-off-screen=0.1",
                    "whstabilize mode=smooth smoothing-lookahead=3", "whstabilize border=black"));

}  // namespace
}  // namespace windhover
