#include "client/report/report_files.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "client/report/light_page.h"
#include "client/report/report_plots.h"
#include "client/report/setting_summary.h"
#include "codec/html_text.h"

namespace citystream::client {
namespace {

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

nlohmann::ordered_json light_json(const SettingResult& setting, const SettingSummary& summary) {
    nlohmann::ordered_json out = {{"light_ms_median", summary.light_ms},
                                  {"shadow_ms_median", summary.shadow_ms},
                                  {"decode_ms", summary.light_decode_ms},
                                  {"radiance_bytes", setting.total_radiance_bytes},
                                  {"radiance_gpu_bytes_most", setting.largest_radiance_gpu_bytes},
                                  {"receivers_most", summary.receivers},
                                  {"row_error_most", summary.row_error}};
    if (setting.radiance) out["archive"] = radiance_cost_json(*setting.radiance);
    return out;
}

}  // namespace

std::string frames_csv(const SweepResult& result) {
    std::string out =
        "knob,value,frame,t,gpu_ms,facade_ms,select_ms,decode_ms,wire_bytes,dictionary_bytes,atlas_bytes,mesh_bytes,"
        "gpu_bytes,tiles,relief_tiles,tolerance_used,achieved_error_pixels,position_error_pixels,position_bits,psnr_db,"
        "ssim,flip,light_ms,shadow_ms,light_decode_ms,radiance_bytes,radiance_gpu_bytes,receivers,row_error\n";
    for (const SettingResult& setting : result.settings)
        for (const FrameRow& row : setting.frames)
            out += fmt::format(
                "{},{},{},{:g},{:.3f},{:.3f},{:.3f},{:.3f},{},{},{},{},{},{},{},{:.4f},{:.4f},{:.4f},{:.2f},{:.3f},"
                "{:.5f},{:.5f},{:.3f},{:.3f},{:.3f},{},{},{},{:.5f}\n",
                setting.setting.knob, setting.setting.value_text(), row.frame, row.t, row.gpu_ms, row.facade_ms,
                row.select_ms, row.decode_ms, row.wire_bytes, row.dictionary_bytes, row.atlas_bytes, row.mesh_bytes,
                row.gpu_bytes, row.tiles, row.relief_tiles, row.tolerance_used, row.achieved_error_pixels,
                row.position_error_pixels, row.position_bits, finite_psnr(row.difference.psnr_db), row.difference.ssim,
                row.difference.flip, row.light_ms, row.shadow_ms, row.light_decode_ms, row.radiance_bytes,
                row.radiance_gpu_bytes, row.receivers, row.row_error);
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
    if (result.lit) {
        root["light"] = {{"environment", result.environment}, {"rays_a_pixel", result.rays_a_pixel}};
        if (result.radiance) root["light"]["radiance"] = radiance_cost_json(*result.radiance);
    }
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
        if (result.lit) one["light"] = light_json(setting, s);
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
        "reference (uncompressed triangles{}) on {}. "
        "Each setting starts cold. FLIP: mean per frame at 67 pixels a degree.</p>\n",
        escape_html(std::filesystem::path(options.city).filename().string()), options.width, options.height,
        result.reference_pictures.size(), escape_html(result.device),
        result.lit ? std::string()
                   : fmt::format(", {:.1f} MiB", static_cast<double>(result.reference_gpu_bytes) / (1 << 20)),
        escape_html(result.reference_device));
    out += summary_table(result) + light_section(result) + archive_list(result);
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
