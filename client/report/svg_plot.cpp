#include "client/report/svg_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "codec/html_text.h"

namespace citystream::client {
namespace {

constexpr double kWidth = 640, kHeight = 414, kLeft = 70, kRight = 20, kTop = 66, kBottom = 55;
constexpr std::array<const char*, 10> kColours = {"#1f6fb4", "#c8443c", "#2e8b57", "#8a5fb0", "#c08a1e",
                                                  "#4a4a4a", "#1b9aaa", "#d6569b", "#7a5230", "#7f8c1d"};

/// One axis: a range of values and how they map to 0..1.
struct Scale {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    bool logarithmic = false;

    void include(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
    void widen() {
        if (low > high) return;
        if (logarithmic) {
            low /= 1.3;
            high *= 1.3;
        } else {
            const double margin = std::max((high - low) * 0.08, 1e-9 + std::abs(high) * 0.01);
            low -= margin;
            high += margin;
        }
    }
    double position(double value) const {
        return logarithmic ? std::log(value / low) / std::log(high / low) : (value - low) / (high - low);
    }
    std::vector<double> ticks() const {
        std::vector<double> out;
        if (logarithmic) {
            for (int exponent = static_cast<int>(std::floor(std::log10(low))); std::pow(10, exponent) <= high;
                 ++exponent)
                for (const int digit : {1, 2, 5}) {
                    const double tick = digit * std::pow(10, exponent);
                    if (tick >= low && tick <= high) out.push_back(tick);
                }
        } else {
            const double rough = (high - low) / 5, magnitude = std::pow(10, std::floor(std::log10(rough)));
            double step = magnitude * 10;
            for (const double candidate : {1.0, 2.0, 5.0})
                if (candidate * magnitude >= rough) {
                    step = candidate * magnitude;
                    break;
                }
            const double first = std::ceil(low / step);
            for (int i = 0; (first + i) * step <= high; ++i) out.push_back((first + i) * step);
        }
        return out;
    }
};

double pixel_x(const Scale& scale, double x) {
    return kLeft + scale.position(x) * (kWidth - kLeft - kRight);
}
double pixel_y(const Scale& scale, double y) {
    return kHeight - kBottom - scale.position(y) * (kHeight - kTop - kBottom);
}

std::string grid(const Scale& x, const Scale& y) {
    std::string out;
    for (const double tick : x.ticks()) {
        const double at = pixel_x(x, tick);
        out += fmt::format(
            "<path d='M{0:.1f} {1}V{2}' stroke='#ddd'/><text x='{0:.1f}' y='{3}' text-anchor='middle'>{4:.4g}</text>\n",
            at, kTop, kHeight - kBottom, kHeight - kBottom + 16, tick);
    }
    for (const double tick : y.ticks()) {
        const double at = pixel_y(y, tick);
        out += fmt::format(
            "<path d='M{1} {0:.1f}H{2}' stroke='#ddd'/><text x='{3}' y='{4:.1f}' text-anchor='end'>{5:.4g}</text>\n",
            at, kLeft, kWidth - kRight, kLeft - 6, at + 4, tick);
    }
    return out;
}

bool drawable(const PlotAxes& axes, const PlotPoint& point) {
    return std::isfinite(point.x) && std::isfinite(point.y) && (!axes.log_x || point.x > 0);
}

std::string draw_series(const PlotAxes& axes, const PlotSeries& series, size_t index, const Scale& x, const Scale& y) {
    const char* colour = kColours[index % kColours.size()];
    std::string line, marks;
    for (const PlotPoint& point : series.points) {
        if (!drawable(axes, point)) continue;
        const double px = pixel_x(x, point.x), py = pixel_y(y, point.y);
        line += fmt::format("{}{:.1f} {:.1f}", line.empty() ? "M" : "L", px, py);
        // Labels of neighbouring lines stand on different sides of their points.
        marks += fmt::format(
            "<circle cx='{0:.1f}' cy='{1:.1f}' r='4' fill='{2}'/><text x='{3:.1f}' y='{4:.1f}' fill='{2}'>{5}</text>\n",
            px, py, colour, px + 6, index % 2 == 0 ? py - 6 : py + 14, escape_html(point.label));
    }
    return fmt::format("<path d='{}' fill='none' stroke='{}' stroke-width='1.5'/>\n{}", line, colour, marks);
}

/// The names of the lines, side by side above the axes, in rows from below.
std::string legend(const std::vector<PlotSeries>& series) {
    constexpr double kLetter = 6.5, kGap = 14, kRow = 14;  // about, of a 12-unit font
    std::string out;
    double x = kLeft, y = kTop - 8;
    for (size_t i = 0; i < series.size(); ++i) {
        const double width = kLetter * static_cast<double>(series[i].name.size());
        if (x > kLeft && x + width > kWidth - kRight) {
            x = kLeft;
            y -= kRow;
        }
        out += fmt::format("<text x='{:.1f}' y='{}' fill='{}'>{}</text>\n", x, y, kColours[i % kColours.size()],
                           escape_html(series[i].name));
        x += width + kGap;
    }
    return out;
}

}  // namespace

std::string plot_svg(const PlotAxes& axes, const std::vector<PlotSeries>& series) {
    Scale x, y;
    x.logarithmic = axes.log_x;
    for (const PlotSeries& one : series) {
        for (const PlotPoint& point : one.points) {
            if (!drawable(axes, point)) continue;
            x.include(point.x);
            y.include(point.y);
        }
    }
    std::string out = fmt::format(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0} {1}' width='{0}' height='{1}' "
        "font-family='sans-serif' font-size='12'>\n"
        "<rect width='{0}' height='{1}' fill='white'/><text x='{2}' y='22' font-size='15'>{3}</text>\n",
        kWidth, kHeight, kLeft, escape_html(axes.title));
    if (x.low > x.high) return out + "<text x='70' y='200'>no points</text></svg>\n";
    x.widen();
    y.widen();
    out += grid(x, y);
    for (size_t i = 0; i < series.size(); ++i) out += draw_series(axes, series[i], i, x, y);
    out += legend(series);
    out += fmt::format(
        "<text x='{}' y='{}' text-anchor='middle'>{}</text><text transform='translate(16 {}) rotate(-90)' "
        "text-anchor='middle'>{}</text></svg>\n",
        (kLeft + kWidth - kRight) / 2, kHeight - 14, escape_html(axes.x_label), (kTop + kHeight - kBottom) / 2,
        escape_html(axes.y_label));
    return out;
}

}  // namespace citystream::client
