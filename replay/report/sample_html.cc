// SPDX-License-Identifier: Apache-2.0
#include "replay/report/sample_html.h"

#include <algorithm>

#include "replay/report/markup.h"

namespace windhover::replay {
namespace {

using Kind = SampleFrame::Kind;
constexpr Kind kKinds[] = {Kind::kHit, Kind::kFalseAlarm, Kind::kMiss};

const char* ClassOf(Kind kind) {
  switch (kind) {
    case Kind::kHit:
      return "hit";
    case Kind::kFalseAlarm:
      return "false-alarm";
    case Kind::kMiss:
      return "miss";
  }
  return "";
}

const char* Plural(Kind kind) {
  switch (kind) {
    case Kind::kHit:
      return "hits";
    case Kind::kFalseAlarm:
      return "false alarms";
    case Kind::kMiss:
      return "misses";
  }
  return "";
}

// One pixel outside the box, so that a small object stays visible.
std::string MarkSvg(const Box& box, Kind kind) {
  const std::string place = "' x='" + Px(box.x - 1) + "' y='" + Px(box.y - 1) + "' width='" +
                            Px(box.width + 2) + "' height='" + Px(box.height + 2) + "'/>";
  return "<rect class='casing" + place + "<rect class='mark " + ClassOf(kind) + place;
}

std::string LegendHtml() {
  std::string html = "<div class='legend'>";
  for (const Kind kind : kKinds) {
    html += "<span><svg class='key' viewBox='0 0 26 14'>" + MarkSvg({4, 3, 18, 8}, kind) +
            "</svg>" + NameOf(kind) + "</span>";
  }
  return html + "</div>\n";
}

std::string CountText(const SampleFrame::View& view) {
  std::string text = view.title + ":";
  for (const Kind kind : kKinds) {
    const auto count =
        std::count_if(view.marks.begin(), view.marks.end(),
                      [&](const SampleFrame::Mark& mark) { return mark.kind == kind; });
    text += std::string(kind == Kind::kHit ? " " : ", ") + std::to_string(count) + " " +
            (count == 1 ? NameOf(kind) : Plural(kind));
  }
  return text;
}

std::string SampleHtml(const SampleFrame& sample, const std::string& picture) {
  std::string html = "<figure><figcaption>Sequence " + Escaped(sample.sequence) + ", frame " +
                     std::to_string(sample.frame) + "</figcaption><div class='views'>";
  for (const SampleFrame::View& view : sample.views) {
    const std::string width = std::to_string(sample.width);
    const std::string height = std::to_string(sample.height);
    const std::string counts = Escaped(CountText(view));
    html.append("<div><p>").append(counts).append("</p><svg viewBox='-0.5 -0.5 ");
    html.append(width).append(" ").append(height).append("' role='img' aria-label='");
    html.append(counts).append("'>");
    if (&view == &sample.views.front()) {
      html.append("<image id='").append(picture).append("' x='-0.5' y='-0.5' width='");
      html.append(width).append("' height='").append(height);
      html.append("' href='data:image/jpeg;base64,").append(Escaped(sample.jpeg_base64));
      html.append("'/>");
    } else {
      html.append("<use href='#").append(picture).append("'/>");
    }
    for (const SampleFrame::Mark& mark : view.marks) html += MarkSvg(mark.box, mark.kind);
    html += "</svg></div>";
  }
  return html + "</div></figure>\n";
}

}  // namespace

std::string SamplesHtml(const std::vector<SampleFrame>& samples, const std::string& prefix) {
  if (samples.empty()) return "";
  std::string html = "<h3>Sample frames</h3>\n" + LegendHtml();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    html += SampleHtml(samples[i], prefix + "-" + std::to_string(i));
  }
  return html;
}

}  // namespace windhover::replay
