// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "replay/benchmarks/figures.h"
#include "replay/report/series_style.h"

namespace windhover::replay {

// An HTML figure: legend, one drawing for each panel, caption. Its classes are those of
// page_style.h.
std::string PlotHtml(const FigurePlot& plot, SeriesStyles& styles);

}  // namespace windhover::replay
