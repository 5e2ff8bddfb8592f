#include "client/report/report_plots.h"

#include <algorithm>
#include <vector>

#include "client/report/setting_summary.h"
#include "client/report/svg_plot.h"

namespace citystream::client {
namespace {

using Column = double (*)(const SettingResult&, const SettingSummary&);

/// Series in the order of their names. What is of all metrics begins the line of each, or stands alone.
std::vector<PlotSeries> joined(std::map<std::string, PlotSeries> by_name,
                               const std::vector<PlotPoint>& of_all_metrics) {
    const auto is_metric = [](const auto& entry) { return entry.first.starts_with("saliency "); };
    if (!of_all_metrics.empty() && std::none_of(by_name.begin(), by_name.end(), is_metric)) by_name["saliency "] = {};
    std::vector<PlotSeries> series;
    series.reserve(by_name.size());
    for (auto& [name, one] : by_name) {
        one.name = name;
        if (name.starts_with("saliency "))
            one.points.insert(one.points.begin(), of_all_metrics.begin(), of_all_metrics.end());
        series.push_back(std::move(one));
    }
    return series;
}

std::string plot_of(const SweepResult& result, const PlotAxes& axes, Column x, Column y) {
    std::map<std::string, PlotSeries> by_name;
    std::vector<PlotPoint> of_all_metrics;
    for (const SettingResult& setting : result.settings) {
        const SettingSummary summary = summarise(setting);
        const PlotPoint point{x(setting, summary), y(setting, summary), setting.setting.label()};
        const std::string name = setting.setting.series();
        if (name.empty()) {
            of_all_metrics.push_back(point);
        } else {
            by_name[name].points.push_back(point);
        }
    }
    return plot_svg(axes, joined(std::move(by_name), of_all_metrics));
}

double megabytes(const SettingResult& setting, const SettingSummary&) {
    return static_cast<double>(setting.total_wire_bytes) / 1e6;
}
double picture_megabytes(const SettingResult& setting, const SettingSummary&) {
    return static_cast<double>(setting.total_atlas_bytes) / 1e6;
}
double mesh_megabytes(const SettingResult& setting, const SettingSummary&) {
    return static_cast<double>(setting.total_mesh_bytes) / 1e6;
}
double frame_time(const SettingResult&, const SettingSummary& summary) {
    return summary.gpu_ms;
}
double flip_error(const SettingResult&, const SettingSummary& summary) {
    return summary.flip;
}
double psnr_value(const SettingResult&, const SettingSummary& summary) {
    return summary.psnr_db;
}

double light_time(const SettingResult&, const SettingSummary& summary) {
    return summary.light_ms;
}
double light_decode_time(const SettingResult&, const SettingSummary& summary) {
    return summary.light_decode_ms;
}
double radiance_kilobytes(const SettingResult& setting, const SettingSummary&) {
    return static_cast<double>(setting.total_radiance_bytes) / 1e3;
}
double radiance_mebibytes(const SettingResult& setting, const SettingSummary&) {
    return static_cast<double>(setting.largest_radiance_gpu_bytes) / (1 << 20);
}
double receiver_count(const SettingResult&, const SettingSummary& summary) {
    return static_cast<double>(summary.receivers);
}

void add_light_plots(const SweepResult& result, std::map<std::string, std::string>& plots) {
    const auto add = [&](const char* file, const char* title, const char* x_label, bool log_x, Column x) {
        plots[file] = plot_of(result, {title, x_label, "median PSNR, dB", log_x}, x, psnr_value);
    };
    add("psnr-light-time.svg", "PSNR against the time of light passes",
        "median of all passes of a frame's tiles, ms (GPU)", false, light_time);
    add("psnr-light-decode.svg", "PSNR against decoding of radiance", "of the whole path, ms (all cores together)",
        false, light_decode_time);
    add("psnr-radiance-bytes.svg", "PSNR against bytes of radiance", "wire bytes of radiance layers, kB", true,
        radiance_kilobytes);
    add("psnr-radiance-memory.svg", "PSNR against memory of radiance", "radiance in GPU memory, most, MiB", true,
        radiance_mebibytes);
    add("psnr-receivers.svg", "PSNR against receivers", "receivers of a frame's tiles, most", true, receiver_count);
}

}  // namespace

std::map<std::string, std::string> plots_of(const SweepResult& result) {
    std::map<std::string, std::string> plots = {
        {"error-time.svg",
         plot_of(result, {"Error against run time", "median frame time, ms (GPU)", "median FLIP", false}, frame_time,
                 flip_error)},
        {"error-bytes.svg",
         plot_of(result, {"Error against bytes", "wire bytes of the whole path, MB", "median FLIP", true}, megabytes,
                 flip_error)},
        {"error-mesh-bytes.svg",
         plot_of(result, {"Error against bytes of meshes", "wire bytes of mesh layers, MB", "median FLIP", true},
                 mesh_megabytes, flip_error)},
        {"error-picture-bytes.svg", plot_of(result,
                                            {"Error against bytes of pictures",
                                             "wire bytes of atlases and shared charts, MB", "median FLIP", true},
                                            picture_megabytes, flip_error)},
        {"psnr-time.svg",
         plot_of(result, {"PSNR against run time", "median frame time, ms (GPU)", "median PSNR, dB", false}, frame_time,
                 psnr_value)},
        {"psnr-bytes.svg",
         plot_of(result, {"PSNR against bytes", "wire bytes of the whole path, MB", "median PSNR, dB", true}, megabytes,
                 psnr_value)},
    };
    if (result.lit) add_light_plots(result, plots);
    return plots;
}

}  // namespace citystream::client
