// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace windhover::replay {

// The page's style sheet: for a window 1280 px wide and for paper. Without '<' and '&', so that the
// page stays well-formed XML.
inline constexpr const char* kPageStyle = R"css(
:root { --ink: #1a1d21; --soft: #5b6470; --rule: #d5dae0; --band: #f5f7f9; }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 44px 40px 64px; max-width: 1240px; background: #ffffff; color: var(--ink);
  font: 15px/1.5 "Helvetica Neue", Helvetica, Arial, "Liberation Sans", "DejaVu Sans", sans-serif; }
h1, h2, h3 { font-family: Charter, "Bitstream Charter", Cambria, Georgia, "DejaVu Serif", serif; line-height: 1.2; }
h1 { font-size: 32px; margin: 0 0 6px; }
h2 { font-size: 24px; margin: 56px 0 8px; padding-top: 14px; border-top: 2px solid var(--ink); }
h3 { font-size: 17px; margin: 36px 0 8px; }
p { margin: 6px 0 14px; max-width: 78ch; }
.soft { color: var(--soft); font-size: 13.5px; }
table { border-collapse: collapse; font-size: 13.5px; font-variant-numeric: tabular-nums;
  border-top: 1.5px solid var(--ink); border-bottom: 1.5px solid var(--ink); }
caption { white-space: nowrap; caption-side: top; text-align: left; font-weight: 600; font-size: 15px; padding: 0 0 7px; }
th, td { padding: 4px 11px; text-align: right; vertical-align: baseline; }
th { font-weight: 600; vertical-align: bottom; }
thead th { border-bottom: 1px solid var(--ink); }
#runs td:nth-child(7) { overflow-wrap: anywhere; }
#runs td:nth-child(2), #runs td:nth-child(8) { white-space: nowrap; }
th.text, td.text { text-align: left; }
tbody tr:nth-child(even) { background: var(--band); }
td.none { color: #9aa3ad; }
td.best { font-weight: 700; }
tr.thesis td { color: var(--soft); font-style: italic; }
.table { margin: 30px 0; overflow-x: auto; }
.wide table { font-size: 12.5px; }
.wide th, .wide td { padding: 4px 7px; }
figure { margin: 34px 0; }
figcaption { font-weight: 600; margin-bottom: 6px; }
.legend { display: flex; flex-wrap: wrap; gap: 2px 22px; margin: 2px 0 10px; font-size: 13px; }
.legend span { display: inline-flex; align-items: center; gap: 7px; }
.legend svg.key { width: 26px; height: 14px; }
.panel svg, .panels svg { display: block; width: 100%; height: auto; }
.panels { display: grid; grid-template-columns: repeat(5, 1fr); gap: 10px 8px; }
svg text { fill: var(--ink); font-family: inherit; font-variant-numeric: tabular-nums; }
svg .tick { font-size: 12px; fill: var(--soft); }
svg .label { font-size: 13px; }
svg .panel-title { font-size: 13px; font-weight: 600; }
.panels svg .tick { font-size: 10px; }
.panels svg .label { font-size: 11px; }
svg .middle { text-anchor: middle; }
svg .end { text-anchor: end; }
svg .grid { stroke: #e4e8ec; stroke-width: 1; }
svg .axis { stroke: #5b6470; stroke-width: 1; }
svg .curve { fill: none; stroke-width: 1.6; }
svg .whisker { stroke-width: 1.2; }
.views { display: grid; grid-template-columns: 1fr 1fr; gap: 12px; }
.views svg { display: block; width: 100%; height: auto; }
.views p { margin: 0 0 4px; font-size: 13px; }
.mark { fill: none; stroke-width: 1.8; }
.casing { fill: none; stroke: #000000; stroke-opacity: 0.55; stroke-width: 3.4; }
.hit { stroke: #2ee06a; }
.false-alarm { stroke: #ff3b30; stroke-dasharray: 5 2; }
.miss { stroke: #ffe11a; stroke-dasharray: 2 2; }
.columns { columns: 3; column-gap: 26px; font-size: 12px; font-variant-numeric: tabular-nums; }
.columns div { display: flex; justify-content: space-between; gap: 10px; border-bottom: 1px solid #eceff2;
  padding: 1.5px 0; break-inside: avoid; }
.columns span:first-child { overflow-wrap: anywhere; }
.columns span:last-child { white-space: nowrap; }
code { font-family: "SFMono-Regular", Consolas, "DejaVu Sans Mono", monospace; font-size: 0.92em; }
@page { size: A4 landscape; margin: 12mm; }
@media print {
  body { padding: 0; max-width: none; }
  h2 { break-before: page; margin-top: 0; }
  h3, caption, figcaption { break-after: avoid; }
  figure, table, tr, .views { break-inside: avoid; }
  .table { overflow: visible; margin: 20px 0; }
  table { font-size: 11.5px; }
  th, td { padding: 2.5px 7px; }
  .wide table { font-size: 11px; }
  .wide th, .wide td { padding: 2.5px 5px; }
  .columns { font-size: 9.5px; }
  * { print-color-adjust: exact; }
}
)css";

}  // namespace windhover::replay
