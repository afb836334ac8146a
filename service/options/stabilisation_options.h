// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "service/options/option.h"

namespace windhover {

enum class StabilisationMode {
  kAnchor,  // the ground stands still
  kSmooth,  // the camera's way is followed without its shaking
};

// What is shown where the frame does not reach.
enum class BorderMode { kBlack, kReplicate, kMosaic };

// How the picture is held still on the screen.
struct StabilisationOptions {
  StabilisationMode mode = StabilisationMode::kAnchor;
  double smoothing_s = 1.0;
  int smoothing_lookahead = 10;
  double max_off_screen = 0.25;
  double crop = 0.0;
  BorderMode border = BorderMode::kMosaic;

  static constexpr auto Fields() {
    using O = StabilisationOptions;
    return std::make_tuple(
        Choice("mode", &O::mode, std::array<std::string_view, 2>{"anchor", "smooth"},
               std::array<std::string_view, 2>{
                   "the ground stands still; the picture is centred anew, in a glide, where too "
                   "much of the frame would lie off the screen",
                   "the picture follows the camera's way with its shaking smoothed out"},
               "What the picture follows"),
        Number(
            "smoothing", &O::smoothing_s, 0.1, 10.0, "s",
            "Past time that mode=smooth takes the camera's way from; also how long centring anew "
            "and the return after lost registration take. Counted in frames of the caps' frame "
            "rate, of 25 a second where they give none"),
        Number("smoothing-lookahead", &O::smoothing_lookahead, 0, 120, "frames",
               "Future frames that mode=smooth takes the camera's way from; that many frames of "
               "delay. More than the past ones count as that many; mode=anchor needs none"),
        Number("max-off-screen", &O::max_off_screen, 0.0, 0.5, "",
               "Share of the frame that may lie off the screen: beyond it mode=anchor centres the "
               "picture anew and mode=smooth follows the camera more closely"),
        Number("crop", &O::crop, 0.0, 0.5, "",
               "Share of the width and height that is cut off, half on each side, and the rest "
               "enlarged; above 0, mode=smooth keeps all borders out of sight"),
        Choice("border", &O::border,
               std::array<std::string_view, 3>{"black", "replicate", "mosaic"},
               std::array<std::string_view, 3>{
                   "black", "the frame's outermost pixels, drawn out",
                   "what earlier frames showed there, black where none did"},
               "What is shown where the frame does not reach"));
  }
};

}  // namespace windhover
