// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "replay/report/measured_document.h"

namespace windhover::replay {

// One self-contained HTML page, well-formed XML too: runs, and for each document its plots, tables,
// sample frames, figures and what was left out. A number in a table stands in a <data> element with
// its full value.
std::string PageHtml(const std::vector<MeasuredDocument>& documents);

}  // namespace windhover::replay
