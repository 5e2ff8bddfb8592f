// A scatter plot with labelled points and joined series, as SVG text.
#pragma once

#include <string>
#include <vector>

namespace citystream::client {

struct PlotPoint {
    double x = 0, y = 0;
    std::string label;
};

struct PlotSeries {
    std::string name;
    std::vector<PlotPoint> points;  ///< joined in this order
};

struct PlotAxes {
    std::string title, x_label, y_label;
    bool log_x = false;  ///< points with x <= 0 are left out
};

/// 640 x 400 units, text escaped; an empty plot says so.
std::string plot_svg(const PlotAxes& axes, const std::vector<PlotSeries>& series);

}  // namespace citystream::client
