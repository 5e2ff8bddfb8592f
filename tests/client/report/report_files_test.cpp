#include "client/report/report_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "client/report/svg_plot.h"

namespace citystream::client {
namespace {

SweepResult two_settings() {
    SweepResult result;
    result.device = "a <device>";
    result.reference_pictures = {"reference_000.png", "reference_001.png"};
    result.reference_ms = {10, 12};
    result.reference_triangles = {100, 120};
    for (const double tolerance : {1.0, 4.0}) {
        SettingResult setting;
        setting.setting = {"tolerance", tolerance, {}, {}};
        for (uint32_t frame = 0; frame < 2; ++frame) {
            FrameRow row;
            row.frame = frame;
            row.gpu_ms = 20 / tolerance + frame;
            row.wire_bytes = frame == 0 ? static_cast<uint64_t>(4000 / tolerance) : 0;
            row.difference = {40 - tolerance, 0.99, 0.01 * tolerance};
            row.picture = "p.png";
            row.flip_picture = "q.png";
            setting.total_wire_bytes += row.wire_bytes;
            setting.frames.push_back(row);
        }
        result.settings.push_back(setting);
    }
    return result;
}

/// Settings with names beside the ones with numbers.
SweepResult named_settings() {
    SweepResult result = two_settings();
    result.settings[0].setting = {"facade-renderer", 0, "fdm", {}};
    result.settings[1].setting = {"archive", 0, "merged 2mm", "b.3tz"};
    result.settings[1].build_options = "--merge-tolerance <2>";
    result.settings[1].total_dictionary_bytes = 1234;
    return result;
}

TEST(Report, NamedSettingsKeepTheirNamesInEveryFile) {
    const auto json = nlohmann::json::parse(report_json(SweepOptions{}, named_settings()));
    EXPECT_EQ(json["settings"][0]["value"], "fdm");
    EXPECT_EQ(json["settings"][1]["value"], "merged 2mm");
    EXPECT_EQ(json["settings"][1]["build_options"], "--merge-tolerance <2>");
    EXPECT_EQ(json["settings"][1]["dictionary_bytes"], 1234);
    EXPECT_NE(frames_csv(named_settings()).find("facade-renderer,fdm,0,"), std::string::npos);
    const std::string html = report_html(SweepOptions{}, named_settings());
    EXPECT_NE(html.find("<td>archive</td><td>merged 2mm</td>"), std::string::npos);
    EXPECT_NE(html.find("archive merged 2mm: --merge-tolerance &lt;2&gt;"), std::string::npos);
}

/// Points of a plot, in order: their labels.
std::vector<std::string> labels_of(const std::string& svg) {
    std::vector<std::string> out;
    for (size_t at = svg.find("<circle"); at != std::string::npos; at = svg.find("<circle", at + 1)) {
        const size_t begin = svg.find('>', svg.find("<text", at)) + 1;
        out.push_back(svg.substr(begin, svg.find('<', begin) - begin));
    }
    return out;
}

TEST(Report, SaliencyMetricsAreLinesOfTheirOwnThatBeginWithoutSaliency) {
    SweepResult result = two_settings();
    for (const char* name : {"none", "ssim:0.99", "ssim:0.95", "flip:0.05"}) {
        result.settings.push_back(result.settings[0]);
        result.settings.back().setting = {"saliency", 0, name, "built.3tz"};
        result.settings.back().total_atlas_bytes = 1000;
    }
    result.settings.erase(result.settings.begin(), result.settings.begin() + 2);
    const std::string html = report_html(SweepOptions{}, result);
    const size_t plot = html.find("<svg");
    const std::string svg = html.substr(plot, html.find("</svg>", plot) - plot);
    EXPECT_EQ(labels_of(svg), (std::vector<std::string>{"none", "flip:0.05", "none", "ssim:0.99", "ssim:0.95"}));
    EXPECT_NE(svg.find(">saliency flip<"), std::string::npos);
    EXPECT_NE(svg.find(">saliency ssim<"), std::string::npos);
    EXPECT_NE(html.find("saliency ssim:0.95: "), std::string::npos) << "how the archive was built";
    result.settings.resize(1);
    EXPECT_EQ(labels_of(report_html(SweepOptions{}, result)).size(), 5u) << "no metric: the one point of each plot";
}

TEST(Report, BytesOfPicturesAreInEveryFile) {
    SweepResult result = two_settings();
    result.settings[0].total_atlas_bytes = 4321;
    result.settings[0].frames[1].atlas_bytes = 987;
    const auto json = nlohmann::json::parse(report_json(SweepOptions{}, result));
    EXPECT_EQ(json["settings"][0]["atlas_bytes"], 4321);
    EXPECT_NE(frames_csv(result).find(",987,"), std::string::npos);
    EXPECT_NE(report_html(SweepOptions{}, result).find("<td>4.3</td>"), std::string::npos);
}

TEST(Report, WhatMeshesTakeAndHowFarTheyAreOffIsInEveryFile) {
    SweepResult result = two_settings();
    for (SettingResult& setting : result.settings) setting.total_mesh_bytes = 54321;
    result.settings[0].frames[1].mesh_bytes = 876;
    result.settings[0].frames[1].position_error_pixels = 0.1875;
    for (FrameRow& row : result.settings[0].frames) row.position_bits = 13.5;
    const auto json = nlohmann::json::parse(report_json(SweepOptions{}, result));
    EXPECT_EQ(json["settings"][0]["mesh_bytes"], 54321);
    EXPECT_DOUBLE_EQ(json["settings"][0]["position_error_pixels_most"], 0.1875);
    EXPECT_DOUBLE_EQ(json["settings"][0]["position_bits_median"], 13.5);
    EXPECT_NE(frames_csv(result).find(",876,"), std::string::npos);
    EXPECT_NE(frames_csv(result).find(",0.1875,13.50,"), std::string::npos);
    const std::string html = report_html(SweepOptions{}, result);
    EXPECT_NE(html.find("<td>54.3</td>"), std::string::npos);
    EXPECT_NE(html.find("<td>0.1875</td><td>13.5</td>"), std::string::npos);
    EXPECT_NE(html.find("Error against bytes of meshes"), std::string::npos);
}

RadianceCost cost_of(uint64_t radiance_bytes, uint64_t receivers) {
    RadianceCost cost;
    cost.buildings = 10;
    cost.layer_bytes = {3000, 500, 500, radiance_bytes};
    cost.lattice_metres = 4;
    cost.texels_across = 32;
    cost.local_across = 8;
    cost.totals = tiles::tileset::RadianceTotals{};
    cost.totals->receivers = receivers;
    cost.totals->leaf_receivers = receivers - 20;
    cost.totals->wire_bytes = radiance_bytes;
    cost.totals->prefixes = {{radiance_bytes / 4, 0.125F}, {radiance_bytes, 0}};
    return cost;
}

/// 6000 bytes of 200 receivers beside 4000 of other layers, and the city on a wider lattice.
SweepResult lit_settings() {
    SweepResult result = two_settings();
    result.lit = true;
    result.environment = "a <sky>";
    result.rays_a_pixel = 256;
    result.radiance = cost_of(6000, 200);
    result.settings[0].setting = {"light-tolerance", 0.05, {}, {}};
    result.settings[0].radiance = result.radiance;
    result.settings[1].setting = {"lattice", 8, {}, "lattice_8.3tz"};
    result.settings[1].radiance = cost_of(1000, 50);
    for (SettingResult& setting : result.settings) {
        setting.total_radiance_bytes = 1500;
        setting.largest_radiance_gpu_bytes = 3 << 20;
        for (FrameRow& row : setting.frames) {
            row.light_ms = 7.25;
            row.shadow_ms = 3.5;
            row.light_decode_ms = 40;
            row.radiance_bytes = 750;
            row.radiance_gpu_bytes = 2 << 20;
            row.receivers = 180;
            row.row_error = 0.015625;
        }
    }
    return result;
}

TEST(LightReport, WhatEachSettingCostsIsInEveryFile) {
    const SweepResult result = lit_settings();
    const auto json = nlohmann::json::parse(report_json(SweepOptions{}, result));
    EXPECT_EQ(json["light"]["environment"], "a <sky>");
    EXPECT_EQ(json["light"]["rays_a_pixel"], 256);
    EXPECT_EQ(json["light"]["radiance"]["receivers"], 200);
    EXPECT_DOUBLE_EQ(json["light"]["radiance"]["percent_of_tile_bytes"], 60);
    const auto& light = json["settings"][0]["light"];
    EXPECT_DOUBLE_EQ(light["light_ms_median"], 7.25);
    EXPECT_DOUBLE_EQ(light["shadow_ms_median"], 3.5);
    EXPECT_DOUBLE_EQ(light["decode_ms"], 80);
    EXPECT_EQ(light["radiance_bytes"], 1500);
    EXPECT_EQ(light["radiance_gpu_bytes_most"], 3 << 20);
    EXPECT_EQ(light["receivers_most"], 180);
    EXPECT_DOUBLE_EQ(light["row_error_most"], 0.015625);
    EXPECT_DOUBLE_EQ(json["settings"][1]["light"]["archive"]["bytes_a_receiver"], 20);
    const std::string csv = frames_csv(result);
    EXPECT_NE(csv.find("light_ms,shadow_ms,light_decode_ms,radiance_bytes,radiance_gpu_bytes,receivers,row_error\n"),
              std::string::npos);
    EXPECT_NE(csv.find(",7.250,3.500,40.000,750,2097152,180,0.01562\n"), std::string::npos) << csv;
    const std::string html = report_html(SweepOptions{}, result);
    EXPECT_NE(html.find("lit by a &lt;sky&gt;"), std::string::npos);
    EXPECT_NE(html.find("256 rays a pixel"), std::string::npos);
    for (const char* title :
         {"PSNR against bytes of radiance", "PSNR against the time of light passes", "PSNR against memory of radiance",
          "PSNR against receivers", "PSNR against decoding of radiance"})
        EXPECT_NE(html.find(title), std::string::npos) << title;
}

TEST(LightReport, ThePageSaysWhatRadianceCostsAndWhyAndWhatBringsItDown) {
    SweepResult result = lit_settings();
    const std::string html = report_html(SweepOptions{}, result);
    EXPECT_NE(html.find("Radiance is 6000 of the 10000 bytes of the city's tiles: 60.0 %"), std::string::npos);
    EXPECT_NE(html.find("200 receivers (180 in tiles without tiles below them"), std::string::npos);
    EXPECT_NE(html.find("take 30.0 bytes each"), std::string::npos);
    EXPECT_NE(html.find("400 bytes a building, beside 20.0 receivers a building"), std::string::npos);
    // 15 % of what would then be 4000 / 0.85 bytes.
    EXPECT_NE(html.find("would have to take 706 bytes, 3.53 each"), std::string::npos);
    EXPECT_NE(html.find("the first alone (light tolerance 0.125): 1500 bytes, 27.3 %"), std::string::npos);
    EXPECT_NE(html.find("lattice 8 m: 50 receivers of 20.0 bytes, 1000 bytes, 20.0 %, at 36.00 dB"), std::string::npos)
        << html;
    result.radiance = cost_of(500, 50);
    const std::string cheap = report_html(SweepOptions{}, result);
    EXPECT_NE(cheap.find("Radiance is 500 of the 4500 bytes of the city's tiles: 11.1 %"), std::string::npos);
    EXPECT_EQ(cheap.find("What brings it down"), std::string::npos);
    result.radiance.reset();
    EXPECT_NE(report_html(SweepOptions{}, result).find("The city has no radiance layer"), std::string::npos);
}

TEST(LightReport, ReportsWithoutLightHaveNothingOfIt) {
    const std::string html = report_html(SweepOptions{}, two_settings());
    for (const char* word : {"radiance", "<h2>Light", "light passes"}) EXPECT_EQ(html.find(word), std::string::npos);
    EXPECT_FALSE(nlohmann::json::parse(report_json(SweepOptions{}, two_settings())).contains("light"));
}

TEST(Setting, FileNamesHaveNeitherBlanksNorColons) {
    EXPECT_EQ((Setting{"saliency", 0, "ssim:0.99", {}}).file_prefix(), "saliency_ssim_0.99");
    EXPECT_EQ((Setting{"archive", 0, "merged 2mm", {}}).file_prefix(), "archive_merged_2mm");
    EXPECT_EQ((Setting{"rate-distortion", 16, {}, {}}).file_prefix(), "rate-distortion_16");
}

TEST(Setting, LabelsHaveUnitsWhereThereAreNumbers) {
    EXPECT_EQ((Setting{"tolerance", 0.5, {}, {}}).label(), "0.5 px");
    EXPECT_EQ((Setting{"relief-tolerance", 2, {}, {}}).label(), "2 px");
    EXPECT_EQ((Setting{"texel-tolerance", 2, {}, {}}).label(), "2 px");
    EXPECT_EQ((Setting{"rate-distortion", 16, {}, {}}).label(), "16");
    EXPECT_EQ((Setting{"gpu-budget", 64, {}, {}}).label(), "64 MiB");
    EXPECT_EQ((Setting{"map-level", 0, "auto", {}}).label(), "auto");
    EXPECT_EQ((Setting{"lattice", 4, {}, {}}).label(), "4 m");
    EXPECT_EQ((Setting{"directions", 16, {}, {}}).label(), "16");
    EXPECT_EQ((Setting{"light-tolerance", 0.05, {}, {}}).label(), "0.05");
    EXPECT_EQ((Setting{"matrix-error", 0.01, {}, {}}).label(), "0.01");
    EXPECT_EQ((Setting{"matrix", 0, "rows", {}}).label(), "rows");
}

TEST(Report, JsonHasMediansTotalsAndTheLeastPsnrOfEverySetting) {
    const auto json = nlohmann::json::parse(report_json(SweepOptions{}, two_settings()));
    ASSERT_EQ(json["settings"].size(), 2u);
    EXPECT_DOUBLE_EQ(json["settings"][0]["gpu_ms_median"], 20.5);
    EXPECT_DOUBLE_EQ(json["settings"][1]["gpu_ms_median"], 5.5);
    EXPECT_EQ(json["settings"][0]["wire_bytes"], 4000);
    EXPECT_DOUBLE_EQ(json["settings"][1]["psnr_db_least"], 36);
}

TEST(Report, CsvHasARowForEveryFrameOfEverySetting) {
    const std::string csv = frames_csv(two_settings());
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
    const size_t header_columns =
        static_cast<size_t>(std::count(csv.begin(), csv.begin() + static_cast<long>(csv.find('\n')), ','));
    EXPECT_EQ(static_cast<size_t>(std::count(csv.begin(), csv.end(), ',')), 5 * header_columns);
}

TEST(Report, PageShowsEveryPictureAndEscapesText) {
    const std::string html = report_html(SweepOptions{}, two_settings());
    EXPECT_NE(html.find("a &lt;device&gt;"), std::string::npos);
    EXPECT_NE(html.find("pictures/reference_001.png"), std::string::npos);
    EXPECT_NE(html.find("Error against bytes"), std::string::npos);
    EXPECT_EQ(html.find("src='http"), std::string::npos);
}

TEST(SvgPlot, PutsPointsInsideTheAxesAndLeavesOutWhatALogarithmCannotShow) {
    const std::string svg = plot_svg({"t", "x", "y", true}, {{"s", {{1, 1, "a"}, {10, 2, "b"}, {0, 3, "left out"}}}});
    EXPECT_NE(svg.find(">a<"), std::string::npos);
    EXPECT_EQ(svg.find("left out"), std::string::npos);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_NE(plot_svg({"t", "x", "y", false}, {}).find("no points"), std::string::npos);
}

TEST(SvgPlot, NamesOfManyLinesStandInsideThePlotAndHaveColoursOfTheirOwn) {
    std::vector<PlotSeries> series;
    std::set<std::string> colours;
    for (int i = 0; i < 10; ++i) series.push_back({"mesh-transport-" + std::to_string(i), {{1.0 + i, 1, "a"}}});
    const std::string svg = plot_svg({"t", "x", "y", false}, series);
    for (const PlotSeries& one : series) {
        const size_t end = svg.find(">" + one.name + "<"), begin = svg.rfind("<text", end);
        ASSERT_NE(end, std::string::npos);
        const std::string text = svg.substr(begin, end - begin);
        EXPECT_LT(std::stod(text.substr(text.find("x='") + 3)) + 6.5 * static_cast<double>(one.name.size()), 640);
        EXPECT_GT(std::stod(text.substr(text.find("y='") + 3)), 22) << "on the title";
        colours.insert(text.substr(text.find("fill='")));
    }
    EXPECT_EQ(colours.size(), series.size());
}

TEST(SvgPlot, OnePointIsNoDivisionByZero) {
    const std::string svg = plot_svg({"t", "x", "y", false}, {{"s", {{0, 0, "only"}}}});
    EXPECT_NE(svg.find(">only<"), std::string::npos);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
}

}  // namespace
}  // namespace citystream::client
