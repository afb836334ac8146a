// SPDX-License-Identifier: Apache-2.0
#include "replay/report/plot_svg.h"

#include <algorithm>
#include <vector>

#include "replay/report/markup.h"
#include "replay/report/plot_scale.h"

namespace windhover::replay {
namespace {

constexpr int kColumns = 5;        // of panels
constexpr double kOnCurve = 0.65;  // size of markers there

// Sizes in px of the drawing's own coordinates.
struct PanelShape {
  double width;
  double height;
  double left;
  double right;
  double top;
  double bottom;
};
constexpr PanelShape kAlone = {1120, 440, 66, 14, 24, 56};
constexpr PanelShape kOneOfMany = {224, 210, 40, 11, 22, 40};

std::string Line(double x1, double y1, double x2, double y2, const char* look) {
  return "<line class='" + std::string(look) + "' x1='" + Px(x1) + "' y1='" + Px(y1) + "' x2='" +
         Px(x2) + "' y2='" + Px(y2) + "'/>";
}

std::string Text(double x, double y, const char* look, const std::string& text,
                 const std::string& more = "") {
  return "<text class='" + std::string(look) + "' x='" + Px(x) + "' y='" + Px(y) + "'" + more +
         ">" + Escaped(text) + "</text>";
}

class PanelDrawing {
 public:
  PanelDrawing(const FigurePlot& plot, const PanelShape& shape, SeriesStyles& styles)
      : plot_(plot),
        shape_(shape),
        styles_(styles),
        x_(plot.x, Values(&PlotPoint::x)),
        y_(plot.y, Values(&PlotPoint::y)) {}

  std::string Draw(const FigurePlot::Panel& panel, bool with_x_label, bool with_y_label);

 private:
  std::vector<double> Values(double PlotPoint::*coordinate) const;
  double X(double value) const {
    return shape_.left + x_.At(value) * (shape_.width - shape_.left - shape_.right);
  }
  double Y(double value) const {
    return shape_.top + (1 - y_.At(value)) * (shape_.height - shape_.top - shape_.bottom);
  }
  void DrawAxes(bool with_x_label, bool with_y_label);
  void DrawSeries(const PlotSeries& series, double offset);

  const FigurePlot& plot_;
  const PanelShape& shape_;
  SeriesStyles& styles_;
  PlotScale x_;
  PlotScale y_;
  std::string svg_;
};

std::vector<double> PanelDrawing::Values(double PlotPoint::*coordinate) const {
  std::vector<double> values;
  for (const FigurePlot::Panel& panel : plot_.panels) {
    for (const PlotSeries& series : panel.series) {
      for (const PlotPoint& point : series.points) {
        values.push_back(point.*coordinate);
        if (coordinate == &PlotPoint::y && point.y_high) values.push_back(*point.y_high);
      }
    }
  }
  return values;
}

void PanelDrawing::DrawAxes(bool with_x_label, bool with_y_label) {
  const double right = shape_.width - shape_.right;
  const double bottom = shape_.height - shape_.bottom;
  for (const PlotTick& tick : y_.ticks()) {
    const double y = shape_.top + (1 - tick.at) * (bottom - shape_.top);
    svg_ += Line(shape_.left, y, right, y, "grid");
    svg_ += Text(shape_.left - 6, y + 3.5, "tick end", tick.label);
  }
  for (const PlotTick& tick : x_.ticks()) {
    const double x = shape_.left + tick.at * (right - shape_.left);
    if (plot_.x.categories.empty()) svg_ += Line(x, shape_.top, x, bottom, "grid");
    svg_ += Line(x, bottom, x, bottom + 4, "axis");
    svg_ += Text(x, bottom + 16, "tick middle", tick.label);
  }
  for (std::size_t i = 1; i < plot_.x.categories.size(); ++i) {
    const double x = X(static_cast<double>(i) - 0.5);
    svg_ += Line(x, shape_.top, x, bottom, "grid");
  }
  svg_ += Line(shape_.left, bottom, right, bottom, "axis");
  svg_ += Line(shape_.left, shape_.top, shape_.left, bottom, "axis");
  if (with_x_label) {
    svg_ += Text((shape_.left + right) / 2, shape_.height - 6, "label middle", plot_.x.label);
  }
  if (with_y_label) {
    const double x = 10;
    const double y = (shape_.top + bottom) / 2;
    svg_ += Text(x, y, "label middle", plot_.y.label,
                 " transform='rotate(-90 " + Px(x) + " " + Px(y) + ")'");
  }
}

void PanelDrawing::DrawSeries(const PlotSeries& series, double offset) {
  const SeriesStyle& style = styles_.For(series.name);
  std::string line;
  std::string markers;
  for (const PlotPoint& point : series.points) {
    if (!x_.Shows(point.x) || !y_.Shows(point.y)) continue;
    const double x = X(point.x) + offset;
    const double y = Y(point.y);
    line += Px(x) + "," + Px(y) + " ";
    if (point.y_high && y_.Shows(*point.y_high)) {
      const double high = Y(*point.y_high);
      markers += Line(x, y, x, high, "whisker") + Line(x - 4, high, x + 4, high, "whisker");
    }
    markers += style.Marker(x, y, series.line ? kOnCurve : 1);
  }
  svg_ += "<g stroke='" + style.colour + "' stroke-width='0'>";
  if (series.line && !line.empty()) {
    line.pop_back();
    svg_ += "<polyline class='curve' points='" + line + "'/>";
  }
  svg_ += markers + "</g>";
}

std::string PanelDrawing::Draw(const FigurePlot::Panel& panel, bool with_x_label,
                               bool with_y_label) {
  svg_ = "<svg viewBox='0 0 " + Px(shape_.width) + " " + Px(shape_.height) +
         "' role='img' aria-label='" + Escaped(plot_.title + " " + panel.title) + "'>";
  DrawAxes(with_x_label, with_y_label);
  if (!panel.title.empty()) {
    svg_ += Text(shape_.left + 2, shape_.top - 8, "panel-title", panel.title);
  }
  // Points of one category stand beside each other.
  const std::size_t count = panel.series.size();
  const double band = plot_.x.categories.empty() ? 0 : X(1) - X(0);
  const double step =
      std::min(11.0, 0.75 * band / static_cast<double>(std::max<std::size_t>(count, 1)));
  for (std::size_t i = 0; i < count; ++i) {
    const bool beside = !panel.series[i].line;
    DrawSeries(panel.series[i],
               beside ? (static_cast<double>(i) - static_cast<double>(count - 1) / 2) * step : 0);
  }
  return svg_ + "</svg>";
}

std::string LegendHtml(const FigurePlot& plot, SeriesStyles& styles) {
  std::vector<std::string> names;
  std::string html = "<div class='legend'>";
  for (const FigurePlot::Panel& panel : plot.panels) {
    for (const PlotSeries& series : panel.series) {
      if (std::find(names.begin(), names.end(), series.name) != names.end()) continue;
      names.push_back(series.name);
      const SeriesStyle& style = styles.For(series.name);
      html += "<span><svg class='key' viewBox='0 0 26 14'>";
      if (series.line) {
        html +=
            "<line x1='0' y1='7' x2='26' y2='7' stroke='" + style.colour + "' stroke-width='1.6'/>";
      }
      html += style.Marker(13, 7, series.line ? kOnCurve : 1) + "</svg>" + Escaped(series.name) +
              "</span>";
    }
  }
  return html + "</div>";
}

}  // namespace

std::string PlotHtml(const FigurePlot& plot, SeriesStyles& styles) {
  const std::size_t count = plot.panels.size();
  const bool many = count > 1;
  PanelDrawing drawing(plot, many ? kOneOfMany : kAlone, styles);
  std::string html = "<figure class='plot' id='plot-" + Escaped(plot.name) + "'><figcaption>" +
                     Escaped(plot.title) + "</figcaption>" + LegendHtml(plot, styles) +
                     "<div class='" + (many ? "panels" : "panel") + "'>";
  for (std::size_t i = 0; i < count; ++i) {
    html += drawing.Draw(plot.panels[i], i + kColumns >= count, i % kColumns == 0);
  }
  return html + "</div></figure>\n";
}

}  // namespace windhover::replay
