// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>

#include "service/options/options.h"

namespace windhover::replay {

// Table 2.2: RMS in px by layout of tiles, for sequences 1 to 10.
struct ThesisLayout {
  const char* name;  // number of tiles
  int columns;
  int rows;
  int layers;
  std::array<double, 10> rms_px;
};
inline constexpr ThesisLayout kThesisLayouts[] = {
    {"4", 2, 2, 1, {0.66, 1.08, 0.43, 0.34, 0.42, 0.32, 1.04, 0.66, 0.57, 0.79}},
    {"5", 2, 2, 2, {0.59, 1.05, 0.39, 0.32, 0.36, 0.26, 0.83, 0.64, 0.57, 0.77}},
    {"8", 4, 2, 1, {0.51, 0.98, 0.36, 0.29, 0.36, 0.26, 0.82, 0.64, 0.49, 0.76}},
    {"9", 3, 3, 1, {0.50, 0.97, 0.36, 0.28, 0.35, 0.22, 0.72, 0.64, 0.44, 0.74}},
    {"16", 4, 4, 1, {0.45, 1.15, 0.29, 0.27, 0.20, 0.22, 0.66, 0.49, 0.41, 0.68}},
    {"25", 5, 5, 1, {0.30, 0.50, 0.21, 0.21, 0.19, 0.22, 0.64, 0.48, 0.32, 0.58}},
    {"25+", 4, 4, 2, {0.46, 0.82, 0.30, 0.26, 0.20, 0.19, 0.55, 0.48, 0.30, 0.57}},
    {"36", 6, 6, 1, {0.33, 0.40, 0.20, 0.19, 0.19, 0.19, 0.48, 0.47, 0.44, 0.58}},
    {"64", 8, 8, 1, {0.30, 0.36, 0.21, 0.22, 0.18, 0.20, 0.45, 0.54, 0.48, 0.60}},
    {"100", 10, 10, 1, {0.29, 0.38, 0.21, 0.23, 0.18, 0.21, 0.46, 0.54, 0.44, 0.59}},
    {"225", 15, 15, 1, {0.33, 0.50, 0.24, 0.32, 0.21, 0.23, 0.50, 0.62, 0.57, 0.71}},
    {"400", 20, 20, 1, {0.34, 0.55, 0.27, 0.32, 0.21, 0.25, 0.54, 0.62, 0.59, 0.71}},
    {"625", 25, 25, 1, {0.38, 0.69, 0.29, 0.39, 0.26, 0.26, 0.59, 0.73, 0.76, 0.87}},
};

// Table 2.3: RMS in px on sequence 4 of dataset A.
struct ThesisWindow {
  const char* name;
  WindowKind window;
  double alpha;
  double rms_px;
};
// The first is none.
inline constexpr ThesisWindow kThesisWindows[] = {
    {"none", WindowKind::kNone, 0.0, 0.358},
    {"Blackman, alpha 0.0001", WindowKind::kBlackman, 0.0001, 0.234},
    {"Blackman, alpha 0.16", WindowKind::kBlackman, 0.16, 0.23},
    {"cosine", WindowKind::kCosine, 0.0, 0.266},
    {"Gaussian, alpha 0.3", WindowKind::kGaussian, 0.3, 0.288},
    {"Gaussian, alpha 0.1", WindowKind::kGaussian, 0.1, 0.25},
    {"Tukey, alpha 0.9", WindowKind::kTukey, 0.9, 0.318},
    {"Tukey, alpha 0.6", WindowKind::kTukey, 0.6, 0.245},
};

// Table 6.1: average precision and recall in percent at overlap 5 %, for sequences 1 to 10.
struct ThesisMotion {
  double precision;
  double recall;
};
inline constexpr std::array<ThesisMotion, 10> kThesisFrameDifferencing = {{{70.9, 85.1},
                                                                           {49.9, 70.3},
                                                                           {73.8, 66.7},
                                                                           {35.3, 90.4},
                                                                           {20.2, 55.3},
                                                                           {91.9, 17.5},
                                                                           {64.2, 48.3},
                                                                           {82.5, 25.1},
                                                                           {86.5, 64.6},
                                                                           {64.8, 52.2}}};
inline constexpr std::array<ThesisMotion, 10> kThesisFiltering = {{{95.9, 68.8},
                                                                   {86.9, 54.9},
                                                                   {96.3, 31.8},
                                                                   {98.0, 76.0},
                                                                   {68.7, 48.7},
                                                                   {96.8, 84.2},
                                                                   {97.5, 55.1},
                                                                   {95.8, 97.6},
                                                                   {97.4, 56.6},
                                                                   {95.5, 50.3}}};

// Index into the thesis' tables of a sequence called "01" to "10"; nothing for others.
std::optional<int> ThesisSequence(const std::string& id);

}  // namespace windhover::replay
