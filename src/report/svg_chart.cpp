#include "report/svg_chart.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/html_text.h"
#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

constexpr double kWidth = 1120, kHeight = 250;
constexpr double kLeft = 56, kRight = 16, kTop = 34, kBottom = 30;
constexpr int kTicksX = 12, kTicksY = 5;

struct Axes {
  double first = 0, last = 1;  // frames
  double low = 0, high = 1;    // values
  double x(double frame) const {
    return kLeft + (kWidth - kLeft - kRight) * (frame - first) / std::max(last - first, 1.0);
  }
  double y(double value) const {
    return kTop + (kHeight - kTop - kBottom) * (high - std::clamp(value, low, high)) / (high - low);
  }
};

Axes axes_of(const Chart& chart) {
  Axes axes;
  axes.first = static_cast<double>(chart.frames.front());
  axes.last = static_cast<double>(chart.frames.back());
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const auto take = [&](double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  };
  for (const ChartSeries& series : chart.series) {
    for (double value : series.values) take(value);
  }
  if (chart.has_bar) take(chart.bar);
  if (chart.from_zero) low = std::min(low, 0.0);
  const double step = nice_step(high - low, kTicksY);
  axes.low = std::floor(low / step) * step;
  axes.high = std::ceil(high / step) * step;
  if (axes.high <= axes.low) axes.high = axes.low + step;
  if (chart.at_most > 0) axes.high = std::min(axes.high, chart.at_most);
  return axes;
}

std::string grid(const Chart& chart, const Axes& axes) {
  std::string svg;
  const double step_y = nice_step(axes.high - axes.low, kTicksY);
  const int digits = std::max(0, static_cast<int>(-std::floor(std::log10(step_y) + 1e-9)));
  for (double value = axes.low; value <= axes.high + step_y * 1e-6; value += step_y) {
    const double y = axes.y(value);
    svg += format("<line class=\"grid\" x1=\"%g\" x2=\"%g\" y1=\"%.1f\" y2=\"%.1f\"/>", kLeft, kWidth - kRight, y, y);
    svg += format("<text class=\"tick\" text-anchor=\"end\" x=\"%g\" y=\"%.1f\">%.*f</text>", kLeft - 7, y + 4, digits,
                  value);
  }
  const double step_x = std::max(1.0, nice_step(axes.last - axes.first, kTicksX));
  for (double frame = std::ceil(axes.first / step_x) * step_x; frame <= axes.last; frame += step_x) {
    svg += format("<text class=\"tick\" text-anchor=\"middle\" x=\"%.1f\" y=\"%g\">%.0f</text>", axes.x(frame),
                  kHeight - kBottom + 18, frame);
  }
  if (chart.has_bar) {
    const double y = axes.y(chart.bar);
    svg += format("<line class=\"bar\" x1=\"%g\" x2=\"%g\" y1=\"%.1f\" y2=\"%.1f\"/>", kLeft, kWidth - kRight, y, y);
  }
  return svg;
}

std::string polyline(const ChartSeries& series, const Chart& chart, const Axes& axes) {
  std::string path;
  bool open = false;
  for (size_t i = 0; i < series.values.size(); ++i) {
    if (!std::isfinite(series.values[i])) {
      open = false;
      continue;
    }
    path +=
        format("%s%.1f %.1f", open ? "L" : "M", axes.x(static_cast<double>(chart.frames[i])), axes.y(series.values[i]));
    open = true;
  }
  return "<path class=\"curve\" style=\"stroke:" + series.color + "\" d=\"" + path + "\"/>";
}

std::string value_text(const Chart& chart, double value) {
  return std::isfinite(value) ? format("%.*f%s", chart.digits, value, chart.unit.c_str()) : "none";
}

// A column over each frame: shaded where nothing was tracked, with the values to be shown when the pointer is on it.
std::string columns(const Chart& chart, const Axes& axes) {
  std::string svg;
  for (size_t i = 0; i < chart.frames.size(); ++i) {
    const double x = axes.x(static_cast<double>(chart.frames[i]));
    const double width = axes.x(axes.first + 1) - axes.x(axes.first);
    std::string tip = format("frame %lld", static_cast<long long>(chart.frames[i]));
    for (const ChartSeries& series : chart.series) {
      tip.append("\n").append(html_escaped(series.name)).append(": ").append(value_text(chart, series.values[i]));
    }
    const bool lost = !chart.tracked.empty() && !chart.tracked[i];
    svg += format("<rect class=\"%s\" x=\"%.1f\" y=\"%g\" width=\"%.2f\" height=\"%g\"><title>",
                  lost ? "lost" : "hover", x - width / 2, kTop, width, kHeight - kTop - kBottom) +
           tip + "</title></rect>";
  }
  return svg;
}

// The title on the left; on the right the series with their means, each behind a square of its colour.
std::string heading(const Chart& chart) {
  std::string svg = format("<text class=\"title\" x=\"%g\" y=\"20\">", kLeft) + html_escaped(chart.title) + "</text>";
  svg += format("<text class=\"legend\" text-anchor=\"end\" x=\"%g\" y=\"20\">", kWidth - kRight);
  for (const ChartSeries& series : chart.series) {
    double sum = 0;
    int n = 0;
    for (double value : series.values) {
      if (!std::isfinite(value)) continue;
      sum += value;
      ++n;
    }
    svg +=
        format("&#160;&#160;&#160;&#160;<tspan style=\"fill:%s\">&#9632;</tspan><tspan>&#160;", series.color.c_str());
    svg += html_escaped(series.name + ", mean " + value_text(chart, n > 0 ? sum / n : std::nan(""))) + "</tspan>";
  }
  return svg + "</text>";
}

}  // namespace

double nice_step(double span, int n) {
  if (!(span > 0) || !std::isfinite(span) || n < 1) return 1;
  const double raw = span / n;
  const double power = std::pow(10, std::floor(std::log10(raw)));
  for (double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= raw * (1 - 1e-9)) return factor * power;
  }
  return 10 * power;
}

std::string svg_chart(const Chart& chart) {
  bool any = false;
  for (const ChartSeries& series : chart.series) {
    if (series.values.size() != chart.frames.size()) {
      throw LogicError(format("chart %s: %zu values for %zu frames", chart.title.c_str(), series.values.size(),
                              chart.frames.size()));
    }
    any |= std::any_of(series.values.begin(), series.values.end(), [](double v) { return std::isfinite(v); });
  }
  if (!chart.tracked.empty() && chart.tracked.size() != chart.frames.size()) throw LogicError("chart: flags of frames");
  if (!any) return {};
  const Axes axes = axes_of(chart);
  std::string svg = format("<svg class=\"chart\" viewBox=\"0 0 %g %g\" role=\"img\">", kWidth, kHeight);
  svg += heading(chart) + grid(chart, axes) + columns(chart, axes);
  for (auto series = chart.series.rbegin(); series != chart.series.rend(); ++series) {
    svg += polyline(*series, chart, axes);
  }
  return svg + "</svg>\n";
}

}  // namespace livecap
