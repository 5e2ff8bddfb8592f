#include "client/report/report_files.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "client/report/svg_plot.h"
#include "codec/html_text.h"

namespace citystream::client {
namespace {

/// What a setting amounts to, for tables and plots.
struct SettingSummary {
    double gpu_ms, facade_ms, psnr_db, least_psnr_db, ssim, flip, achieved_error_pixels, position_error_pixels,
        position_bits;
};

// Equal pictures have no finite PSNR; 99 dB stands for them where a number is needed.
double finite_psnr(double psnr_db) {
    return std::min(psnr_db, 99.0);
}

SettingSummary summarise(const SettingResult& setting) {
    SettingSummary out{};
    out.gpu_ms = median_of(setting.frames, [](const FrameRow& row) { return row.gpu_ms; });
    out.facade_ms = median_of(setting.frames, [](const FrameRow& row) { return row.facade_ms; });
    out.psnr_db = median_of(setting.frames, [](const FrameRow& row) { return finite_psnr(row.difference.psnr_db); });
    out.ssim = median_of(setting.frames, [](const FrameRow& row) { return row.difference.ssim; });
    out.flip = median_of(setting.frames, [](const FrameRow& row) { return row.difference.flip; });
    out.position_bits = median_of(setting.frames, [](const FrameRow& row) { return row.position_bits; });
    out.least_psnr_db = 99;
    for (const FrameRow& row : setting.frames) {
        out.least_psnr_db = std::min(out.least_psnr_db, finite_psnr(row.difference.psnr_db));
        out.achieved_error_pixels = std::max(out.achieved_error_pixels, row.achieved_error_pixels);
        out.position_error_pixels = std::max(out.position_error_pixels, row.position_error_pixels);
    }
    return out;
}

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

std::map<std::string, std::string> plots_of(const SweepResult& result) {
    return {
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
}

Status write_text(const std::filesystem::path& file, const std::string& text) {
    std::ofstream out(file, std::ios::binary);
    out << text;
    out.flush();
    if (!out) return Error{file.string() + ": cannot be written"};
    return Done{};
}

std::string summary_table(const SweepResult& result) {
    std::string out =
        "<table><tr><th>knob</th><th>setting</th><th>wire MB</th><th>of it facade maps, kB</th><th>pictures, "
        "kB</th><th>meshes, kB</th><th>GPU MiB, most</th>"
        "<th>frame ms, median</th><th>of it relief</th><th>PSNR dB, median</th><th>PSNR dB, least</th><th>SSIM</th>"
        "<th>FLIP</th><th>stated error px, most</th><th>of it positions</th><th>bits a coordinate</th></tr>\n";
    for (const SettingResult& setting : result.settings) {
        const SettingSummary s = summarise(setting);
        out += fmt::format(
            "<tr><td>{}</td><td>{}</td><td>{:.3f}</td><td>{:.1f}</td><td>{:.1f}</td><td>{:.1f}</td><td>{:.2f}</"
            "td><td>{:.2f}</"
            "td><td>{:.2f}</td>"
            "<td>{:.2f}</td><td>{:.2f}</td><td>{:.4f}</td><td>{:.4f}</td><td>{:.3f}</td><td>{:.4f}</td><td>{:.1f}</td>"
            "</tr>\n",
            setting.setting.knob, escape_html(setting.setting.label()),
            static_cast<double>(setting.total_wire_bytes) / 1e6,
            static_cast<double>(setting.total_dictionary_bytes) / 1e3,
            static_cast<double>(setting.total_atlas_bytes) / 1e3, static_cast<double>(setting.total_mesh_bytes) / 1e3,
            static_cast<double>(setting.largest_gpu_bytes) / (1 << 20), s.gpu_ms, s.facade_ms, s.psnr_db,
            s.least_psnr_db, s.ssim, s.flip, s.achieved_error_pixels, s.position_error_pixels, s.position_bits);
    }
    return out + "</table>\n";
}

/// How each archive was built: what makes them differ.
std::string archive_list(const SweepResult& result) {
    std::string out;
    for (const SettingResult& setting : result.settings) {
        if (setting.setting.place.empty()) continue;
        out += fmt::format("<li>{} {}: {}</li>\n", setting.setting.knob, escape_html(setting.setting.label()),
                           escape_html(setting.build_options.empty() ? "options unknown" : setting.build_options));
    }
    return out.empty() ? out : "<p>Archives and how they were built:</p><ul>\n" + out + "</ul>\n";
}

std::string picture_rows(const SweepResult& result) {
    std::string out;
    for (size_t i = 0; i < result.reference_pictures.size(); ++i) {
        out += fmt::format(
            "<h3>Frame {0}</h3><div class='row'><figure><a href='pictures/{1}'><img src='pictures/{1}' "
            "alt='reference'></a><figcaption>reference: {2} triangles, {3:.0f} ms</figcaption></figure>\n",
            i, result.reference_pictures[i], result.reference_triangles[i], result.reference_ms[i]);
        for (const SettingResult& setting : result.settings) {
            const FrameRow& row = setting.frames[i];
            out += fmt::format(
                "<figure><a href='pictures/{0}'><img src='pictures/{0}' alt=''></a><a href='pictures/{1}'><img "
                "src='pictures/{1}' alt='FLIP'></a><figcaption>{2} {3}: {4:.2f} dB, FLIP {5:.4f}, {6} "
                "tiles</figcaption></figure>\n",
                row.picture, row.flip_picture, setting.setting.knob, escape_html(setting.setting.label()),
                finite_psnr(row.difference.psnr_db), row.difference.flip, row.tiles);
        }
        out += "</div>\n";
    }
    return out;
}

}  // namespace

std::string frames_csv(const SweepResult& result) {
    std::string out =
        "knob,value,frame,t,gpu_ms,facade_ms,select_ms,decode_ms,wire_bytes,dictionary_bytes,atlas_bytes,mesh_bytes,"
        "gpu_bytes,tiles,relief_tiles,tolerance_used,achieved_error_pixels,position_error_pixels,position_bits,psnr_db,"
        "ssim,flip\n";
    for (const SettingResult& setting : result.settings)
        for (const FrameRow& row : setting.frames)
            out += fmt::format(
                "{},{},{},{:g},{:.3f},{:.3f},{:.3f},{:.3f},{},{},{},{},{},{},{},{:.4f},{:.4f},{:.4f},{:.2f},{:.3f},"
                "{:.5f},{:.5f}\n",
                setting.setting.knob, setting.setting.value_text(), row.frame, row.t, row.gpu_ms, row.facade_ms,
                row.select_ms, row.decode_ms, row.wire_bytes, row.dictionary_bytes, row.atlas_bytes, row.mesh_bytes,
                row.gpu_bytes, row.tiles, row.relief_tiles, row.tolerance_used, row.achieved_error_pixels,
                row.position_error_pixels, row.position_bits, finite_psnr(row.difference.psnr_db), row.difference.ssim,
                row.difference.flip);
    return out;
}

std::string report_json(const SweepOptions& options, const SweepResult& result) {
    nlohmann::ordered_json root;
    root["city"] = options.city;
    root["device"] = result.device;
    root["reference_device"] = result.reference_device;
    root["size"] = {options.width, options.height};
    root["supersample"] = options.supersample;
    root["reference"] = {{"gpu_bytes", result.reference_gpu_bytes},
                         {"frame_ms", result.reference_ms},
                         {"triangles", result.reference_triangles}};
    for (const SettingResult& setting : result.settings) {
        const SettingSummary s = summarise(setting);
        nlohmann::ordered_json one = {{"knob", setting.setting.knob},
                                      {"value", setting.setting.value},
                                      {"wire_bytes", setting.total_wire_bytes},
                                      {"dictionary_bytes", setting.total_dictionary_bytes},
                                      {"atlas_bytes", setting.total_atlas_bytes},
                                      {"mesh_bytes", setting.total_mesh_bytes},
                                      {"gpu_bytes_most", setting.largest_gpu_bytes},
                                      {"gpu_ms_median", s.gpu_ms},
                                      {"facade_ms_median", s.facade_ms},
                                      {"psnr_db_median", s.psnr_db},
                                      {"psnr_db_least", s.least_psnr_db},
                                      {"ssim_median", s.ssim},
                                      {"flip_median", s.flip},
                                      {"achieved_error_pixels_most", s.achieved_error_pixels},
                                      {"position_error_pixels_most", s.position_error_pixels},
                                      {"position_bits_median", s.position_bits},
                                      {"warnings", setting.warnings}};
        if (setting.setting.is_named()) one["value"] = setting.setting.name;
        if (!setting.setting.place.empty()) one["build_options"] = setting.build_options;
        root["settings"].push_back(std::move(one));
    }
    return root.dump(2) + "\n";
}

std::string report_html(const SweepOptions& options, const SweepResult& result) {
    std::string out =
        "<!doctype html><html lang='en'><head><meta charset='utf-8'><title>citystream report</title><style>"
        "body{font-family:sans-serif;margin:2em;max-width:1400px}table{border-collapse:collapse}td,th{border:1px solid "
        "#ccc;padding:.3em .6em;text-align:right}"
        ".row{display:flex;flex-wrap:wrap;gap:8px}figure{margin:0}img{width:320px}figcaption{font-size:12px}</style></"
        "head><body>\n";
    out += fmt::format(
        "<h1>Error against run time and bytes</h1><p>City {}, {} x {} pixels, {} cameras along the path. Drawn on {}; "
        "reference (uncompressed triangles, {:.1f} MiB) on {}. "
        "Each setting starts cold. FLIP: mean per frame at 67 pixels a degree.</p>\n",
        escape_html(std::filesystem::path(options.city).filename().string()), options.width, options.height,
        result.reference_pictures.size(), escape_html(result.device),
        static_cast<double>(result.reference_gpu_bytes) / (1 << 20), escape_html(result.reference_device));
    out += summary_table(result) + archive_list(result);
    out += "<div class='row'>\n";
    for (const auto& [name, svg] : plots_of(result)) out += svg;
    out += "</div>\n";
    std::set<std::string> warnings;
    for (const SettingResult& setting : result.settings)
        warnings.insert(setting.warnings.begin(), setting.warnings.end());
    for (const std::string& warning : warnings) out += "<p>Warning: " + escape_html(warning) + "</p>\n";
    return out + picture_rows(result) + "</body></html>\n";
}

Status write_report(const std::string& folder, const SweepOptions& options, const SweepResult& result) {
    const std::filesystem::path base(folder);
    if (Status s = write_text(base / "frames.csv", frames_csv(result)); !s) return s;
    if (Status s = write_text(base / "report.json", report_json(options, result)); !s) return s;
    for (const auto& [name, svg] : plots_of(result))
        if (Status s = write_text(base / name, svg); !s) return s;
    return write_text(base / "index.html", report_html(options, result));
}

}  // namespace citystream::client
