#include "server/pages.h"

#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>
#include <string_view>

#include "codec/html_text.h"

namespace citystream::server {
namespace {

using tiles::tileset::kLayerCount;
using tiles::tileset::kLayerNames;
using tiles::tileset::Manifest;

constexpr std::string_view kStyle = R"css(
:root{color-scheme:light dark;--ink:#1c2430;--soft:#5b6675;--line:#d9dee5;--card:#fff;--ground:#f3f5f8;--link:#0b5cad}
@media(prefers-color-scheme:dark){:root{--ink:#e6eaf0;--soft:#9aa6b5;--line:#333c48;--card:#1b212a;--ground:#11151b;--link:#7db7f5}}
*{box-sizing:border-box}
body{margin:0 auto;max-width:76rem;padding:2rem 1.25rem;background:var(--ground);color:var(--ink);font:16px/1.5 system-ui,sans-serif}
h1{font-size:1.5rem;margin:0 0 .25rem}h2{font-size:1.15rem;margin:0}
p{margin:.25rem 0 1rem}a{color:var(--link)}.soft{color:var(--soft)}
main{display:grid;gap:1.25rem;grid-template-columns:repeat(auto-fill,minmax(min(100%,22rem),1fr))}
main.one{grid-template-columns:minmax(0,44rem)}
article{background:var(--card);border:1px solid var(--line);border-radius:.6rem;overflow:hidden}
.picture{display:block;width:100%;aspect-ratio:16/9;object-fit:cover;background:var(--line)}
.none{display:grid;place-items:center;color:var(--soft)}
.text{padding:1rem 1.1rem 1.1rem}
table{border-collapse:collapse;width:100%;font-size:.9rem;margin-top:.75rem}
th{font-weight:600;text-align:left}td,th{padding:.2rem 0;border-bottom:1px solid var(--line)}
td.n,th.n{text-align:right;font-variant-numeric:tabular-nums}
code,pre{font:.85rem/1.5 ui-monospace,monospace}pre{overflow-x:auto;padding:.75rem;border:1px solid var(--line);border-radius:.4rem}
)css";

std::string grouped(uint64_t number) {
    std::string digits = fmt::format("{}", number);
    for (size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, "\u202f");
    return digits;
}

/// [xmin, ymin, zmin, xmax, ymax, zmax] in metres of the CRS.
std::array<double, 6> extent_of(const Manifest& m) {
    const double x = to_metres(m.origin.x), y = to_metres(m.origin.y);
    return {m.extent.min[0] + x, m.extent.min[1] + y, m.extent.min[2],
            m.extent.max[0] + x, m.extent.max[1] + y, m.extent.max[2]};
}

std::string title_of(const City& city) {
    return city.manifest.title.empty() ? city.name : city.manifest.title;
}

std::string page(std::string_view title, std::string_view body) {
    return fmt::format(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
        "<meta name=\"viewport\" "
        "content=\"width=device-width,initial-scale=1\"><title>{}</title><style>{}</style></head>\n<body>\n{}</body></"
        "html>\n",
        escape_html(title), kStyle, body);
}

std::string layer_table(const City& city) {
    const Manifest& m = city.manifest;
    std::string rows;
    for (size_t i = 0; i < kLayerCount; ++i) {
        if (!m.has_layer[i]) continue;
        rows += fmt::format("<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n", kLayerNames[i],
                            human_bytes(m.wire_bytes[i]), human_bytes(m.decoded_bytes[i]));
    }
    rows += fmt::format("<tr><td>archive</td><td class=\"n\">{}</td><td class=\"n\"></td></tr>\n",
                        human_bytes(city.archive->file_size()));
    return fmt::format(
        "<table><tr><th>layer</th><th class=\"n\">stored</th><th class=\"n\">decoded</th></tr>\n{}</table>\n", rows);
}

std::string facts(const City& city) {
    const Manifest& m = city.manifest;
    const auto e = extent_of(m);
    const std::string crs = m.epsg > 0 ? fmt::format("EPSG:{}", m.epsg) : "no CRS given";
    return fmt::format(
        "<p class=\"soft\">{} buildings, {} tiles on {} levels<br>{:.2f} km &times; {:.2f} km, {:.0f} m high, {}</p>\n",
        grouped(m.buildings), grouped(m.tiles), m.levels, (e[3] - e[0]) / 1000, (e[4] - e[1]) / 1000, e[5] - e[2], crs);
}

/// `base`: the relative URL of the city's folder as seen from the page ("" on its own page).
std::string card(const City& city, const std::string& base) {
    const std::string title = escape_html(title_of(city));
    const std::string picture =
        city.has_preview()
            ? fmt::format("<img class=\"picture\" src=\"{}preview.png\" alt=\"View of {}\">", base, title)
            : std::string("<div class=\"picture none\">no picture in this archive</div>");
    const std::string heading = base.empty() ? title : fmt::format("<a href=\"{}\">{}</a>", base, title);
    return fmt::format("<article>{}<div class=\"text\"><h2>{}</h2>\n{}{}</div></article>\n", picture, heading,
                       facts(city), layer_table(city));
}

}  // namespace

std::string human_bytes(uint64_t bytes) {
    static constexpr std::array<const char*, 5> kUnits = {"B", "kB", "MB", "GB", "TB"};
    auto value = static_cast<double>(bytes);
    size_t unit = 0;
    while (value >= 999.5 && unit + 1 < kUnits.size()) {
        value /= 1000;
        ++unit;
    }
    const int decimals = unit == 0 || value >= 99.95 ? 0 : value >= 9.995 ? 1 : 2;
    return fmt::format("{:.{}f} {}", value, decimals, kUnits[unit]);
}

std::string index_page(const std::vector<City>& cities) {
    std::string body =
        "<h1>Cities on this server</h1>\n<p class=\"soft\">Streamed by citystream. "
        "The same list for programs: <a href=\"cities.json\">cities.json</a>; <a href=\"metrics\">metrics</a>, <a "
        "href=\"healthz\">health</a>.</p>\n<main>\n";
    for (const City& city : cities) body += card(city, city.name + "/");
    body += "</main>\n";
    return page("citystream", body);
}

std::string city_page(const City& city) {
    const std::string body = fmt::format(
        "<p><a href=\"../\">All cities</a></p>\n<main class=\"one\">\n{}</main>\n"
        "<h2>Fly through it</h2>\n<pre>citystream-fly http://THIS-HOST/{} --path tour.csv --frames out/</pre>\n"
        "<p class=\"soft\">The directory is a 3D Tiles 1.1 tileset: <a href=\"tileset.json\">tileset.json</a>.</p>\n",
        card(city, ""), city.name);
    return page(title_of(city), body);
}

std::string cities_json(const std::vector<City>& cities) {
    auto list = nlohmann::ordered_json::array();
    for (const City& city : cities) {
        const Manifest& m = city.manifest;
        nlohmann::ordered_json layers = nlohmann::ordered_json::object();
        for (size_t i = 0; i < kLayerCount; ++i) {
            if (m.has_layer[i])
                layers[kLayerNames[i]] = {{"wire_bytes", m.wire_bytes[i]}, {"decoded_bytes", m.decoded_bytes[i]}};
        }
        nlohmann::ordered_json preview = nullptr;
        if (city.has_preview()) preview = fmt::format("/{}/preview.png", city.name);
        list.push_back({{"name", city.name},
                        {"title", title_of(city)},
                        {"tileset", fmt::format("/{}/tileset.json", city.name)},
                        {"preview", preview},
                        {"buildings", m.buildings},
                        {"triangles", m.triangles},
                        {"facades", m.facades},
                        {"tiles", m.tiles},
                        {"levels", m.levels},
                        {"extent", extent_of(m)},
                        {"epsg", m.epsg},
                        {"archive_bytes", city.archive->file_size()},
                        {"layers", layers}});
    }
    const nlohmann::ordered_json document = {{"cities", list}};
    return document.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace citystream::server
