#include "client/report/light_page.h"

#include <fmt/format.h>

#include "client/report/setting_summary.h"
#include "codec/html_text.h"

namespace citystream::client {

using tiles::tileset::Layer;
using tiles::tileset::RadianceTotals;

namespace {

double ratio(uint64_t part, uint64_t of) {
    return of == 0 ? 0 : static_cast<double>(part) / static_cast<double>(of);
}

std::string archive_cells(const std::optional<RadianceCost>& cost) {
    if (!cost) return "<td>none</td><td></td><td></td>";
    const std::string share = fmt::format("<td>{:.1f}</td>", cost->percent());
    if (!cost->totals) return "<td></td><td></td>" + share;
    return fmt::format("<td>{}</td><td>{:.1f}</td>", cost->totals->receivers, cost->totals->bytes_a_receiver()) + share;
}

std::string light_table(const SweepResult& result) {
    std::string out =
        "<table><tr><th>knob</th><th>setting</th><th>PSNR dB, median</th><th>SSIM</th><th>FLIP</th><th>light passes "
        "ms, median</th><th>decoding radiance ms, all</th><th>frame ms, median</th><th>sun's shadow maps ms</th>"
        "<th>radiance kB</th><th>of all wire bytes, %</th><th>radiance in GPU memory MiB, most</th><th>receivers of a "
        "frame's tiles, most</th><th>error of a row, most</th><th>receivers of the archive</th><th>bytes "
        "each</th><th>of tiles' bytes, "
        "%</th></tr>\n";
    for (const SettingResult& setting : result.settings) {
        const SettingSummary s = summarise(setting);
        out += fmt::format(
            "<tr><td>{}</td><td>{}</td><td>{:.2f}</td><td>{:.4f}</td><td>{:.4f}</td><td>{:.2f}</td><td>{:.1f}</td>"
            "<td>{:.2f}</td><td>{:.2f}</td><td>{:.1f}</td><td>{:.1f}</td><td>{:.2f}</td><td>{}</td><td>{:.4f}</td>{}</"
            "tr>\n",
            setting.setting.knob, escape_html(setting.setting.label()), s.psnr_db, s.ssim, s.flip, s.light_ms,
            s.light_decode_ms, s.gpu_ms, s.shadow_ms, static_cast<double>(setting.total_radiance_bytes) / 1e3,
            100 * ratio(setting.total_radiance_bytes, setting.total_wire_bytes),
            static_cast<double>(setting.largest_radiance_gpu_bytes) / (1 << 20), s.receivers, s.row_error,
            archive_cells(setting.radiance));
    }
    return out +
           "</table>\n<p>Light passes run when the light changes, not when the view does: their time is for all tiles "
           "of a frame, and no part of the frame's. A place's light may be wrong by the light tolerance, under an even "
           "sky.</p>\n";
}

/// What the share is made of.
std::string why(const RadianceCost& cost) {
    if (!cost.totals) return "";
    const RadianceTotals& totals = *cost.totals;
    const uint64_t others = cost.tile_bytes() - cost.radiance_bytes();
    std::string out = fmt::format(
        "<p>{} receivers ({} in tiles without tiles below them, on a lattice of {} m; 6 x {} x {} directions, {} x {} "
        "on the surface) take {:.1f} bytes each.",
        totals.receivers, totals.leaf_receivers, cost.lattice_metres, cost.texels_across, cost.texels_across,
        cost.local_across, cost.local_across, totals.bytes_a_receiver());
    if (cost.percent() > kMostRadiancePercent) {
        const double share = kMostRadiancePercent / 100;
        const double most = share / (1 - share) * static_cast<double>(others);
        out += fmt::format(
            " That is more than {:g} % because the other layers are small: {:.0f} bytes a building, beside {:.1f} "
            "receivers a building (those of the ground counted). For {:g} % all receivers together would have to take "
            "{:.0f} bytes, {:.2f} each.",
            kMostRadiancePercent, ratio(others, cost.buildings), ratio(totals.receivers, cost.buildings),
            kMostRadiancePercent, most, most / static_cast<double>(std::max<uint64_t>(totals.receivers, 1)));
    }
    return out + "</p>\n";
}

/// Prefixes of the archive, and the archives beside it, each with what it comes to.
std::string what_brings_it_down(const SweepResult& result, const RadianceCost& cost) {
    std::string items;
    if (cost.totals) {
        const auto& prefixes = cost.totals->prefixes;
        for (size_t i = 0; i + 1 < prefixes.size(); ++i)
            items += fmt::format(
                "<li>of its {} steps the first{} alone (light tolerance {:.3g}): {} bytes, {:.1f} % of the tiles' "
                "bytes that are fetched then</li>\n",
                prefixes.size(), i == 0 ? std::string() : fmt::format(" {}", i + 1), prefixes[i].error,
                prefixes[i].wire_bytes, cost.percent_with(prefixes[i].wire_bytes));
        const uint64_t leaves = cost.totals->leaf_receivers, inner = cost.totals->receivers - leaves;
        if (inner > 0)
            items += fmt::format(
                "<li>fewer of the {} receivers of tiles above others, which near views do not fetch</li>\n", inner);
    }
    for (const SettingResult& setting : result.settings) {
        if (setting.setting.place.empty() || !setting.radiance || !setting.radiance->totals) continue;
        if (setting.radiance->radiance_bytes() >= cost.radiance_bytes()) continue;
        items +=
            fmt::format("<li>{} {}: {} receivers of {:.1f} bytes, {} bytes, {:.1f} %, at {:.2f} dB</li>\n",
                        setting.setting.knob, escape_html(setting.setting.label()), setting.radiance->totals->receivers,
                        setting.radiance->totals->bytes_a_receiver(), setting.radiance->radiance_bytes(),
                        setting.radiance->percent(), summarise(setting).psnr_db);
    }
    return items.empty() ? items : "<p>What brings it down:</p><ul>\n" + items + "</ul>\n";
}

std::string cost_text(const SweepResult& result) {
    if (!result.radiance)
        return "<p>The city has no radiance layer (citystream-build --layers ...,radiance): its sky's light is not "
               "shaded, and costs no bytes.</p>\n";
    const RadianceCost& cost = *result.radiance;
    const auto of = [&](Layer layer) { return cost.layer_bytes[static_cast<size_t>(layer)]; };
    std::string out = fmt::format(
        "<p>Radiance is {} of the {} bytes of the city's tiles: {:.1f} % (mesh {}, facade {}, atlas {}; what tiles "
        "share "
        "lies beside them).</p>\n",
        cost.radiance_bytes(), cost.tile_bytes(), cost.percent(), of(Layer::kMesh), of(Layer::kFacade),
        of(Layer::kAtlas));
    out += why(cost);
    return cost.percent() > kMostRadiancePercent ? out + what_brings_it_down(result, cost) : out;
}

}  // namespace

std::string light_section(const SweepResult& result) {
    if (!result.lit) return "";
    return fmt::format(
               "<h2>Light</h2><p>All frames are lit by {}. Compared with the uncompressed city in the same light by "
               "{} rays a pixel.</p>\n",
               escape_html(result.environment), result.rays_a_pixel) +
           light_table(result) + "<h3>What radiance costs</h3>\n" + cost_text(result);
}

}  // namespace citystream::client
