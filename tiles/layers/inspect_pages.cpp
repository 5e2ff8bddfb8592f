#include "tiles/layers/inspect_pages.h"

#include <deque>
#include <map>

#include "codec/atlas/page_layer.h"
#include "codec/step_wire.h"
#include "tiles/tileset/subtree.h"

namespace citystream::tiles::layers {
namespace {

using codec::atlas::PageLayerView;
using tileset::Layer;
using tileset::TileAddress;
using tileset::TileRecord;

struct Sum {
    uint64_t tiles = 0, tiles_of_charts = 0, pages = 0, texels = 0;
    uint64_t charts = 0, flat_charts = 0, chart_texels = 0, border_texels = 0;
    std::map<uint32_t, uint64_t> tiles_by_mips;

    void add(const PageLayerView& view) {
        ++tiles;
        ++tiles_by_mips[view.mips()];
        pages += view.page_count();
        for (uint32_t page = 0; page < view.page_count(); ++page)
            texels += uint64_t{view.width(page)} * view.height(page);
        charts += view.chart_count();
        for (uint32_t i = 0; i < view.chart_count(); ++i) {
            const auto chart = view.chart(i);
            if (chart.flat) {
                ++flat_charts;
                continue;
            }
            const uint64_t border = view.border();
            const uint64_t width = codec::atlas::decode_wrap_axis(chart.packed.u, view.border()).size;
            const uint64_t height = codec::atlas::decode_wrap_axis(chart.packed.v, view.border()).size;
            chart_texels += width * height;
            border_texels += 2 * border * (width + height + 2 * border);
        }
    }

    nlohmann::json json() const {
        const auto percent = [this](uint64_t part) {
            return texels == 0 ? 0 : 100 * static_cast<double>(part) / static_cast<double>(texels);
        };
        nlohmann::json mips = nlohmann::json::object();
        for (const auto& [count, of] : tiles_by_mips) mips[std::to_string(count)] = of;
        return {{"tiles", tiles},
                {"tiles_of_charts", tiles_of_charts},
                {"mips", std::move(mips)},
                {"pages", pages},
                {"texels", texels},
                {"charts", charts},
                {"flat_charts", flat_charts},
                {"chart_texels", chart_texels},
                {"border_texels", border_texels},
                {"fill_percent", percent(chart_texels + border_texels)},
                {"border_percent", percent(border_texels)}};
    }
};

/// The charts and pages are in the first step.
Status add_tile(const archive::ArchiveReader& reader, const TileRecord& tile, Sum& sum) {
    const auto& steps = tile.steps(Layer::kAtlas);
    if (steps.empty()) return Done{};
    const std::string path = tileset::layer_path(Layer::kAtlas, tile.address);
    const auto bytes = reader.find(path);
    if (steps[0].end > bytes.size()) return Error{path + ": step 0 lies outside the entry"};
    const auto words = codec::decode_step(bytes.first(steps[0].end), steps[0].decoded_bytes);
    if (!words) return Error{path + ": " + words.error().text()};
    if (!codec::atlas::is_page_layer(*words)) {
        ++sum.tiles_of_charts;
        return Done{};
    }
    const std::array<uint32_t, 1> step_words = {static_cast<uint32_t>(words->size())};
    const auto view = PageLayerView::create(*words, step_words);
    if (!view) return Error{path + ": " + view.error().text()};
    sum.add(*view);
    return Done{};
}

}  // namespace

Result<nlohmann::json> page_json(const archive::ArchiveReader& reader, const tileset::Manifest& manifest) {
    Sum sum;
    std::deque<TileAddress> open = {TileAddress{}};
    for (; !open.empty(); open.pop_front()) {
        const std::string path = tileset::subtree_path(open.front());
        const auto subtree = tileset::parse_subtree(reader.find(path), open.front(), manifest);
        if (!subtree) return Error{path + ": " + subtree.error().text()};
        for (const TileRecord& tile : subtree->tiles) {
            if (Status status = add_tile(reader, tile, sum); !status) return status.error();
        }
        open.insert(open.end(), subtree->child_subtrees.begin(), subtree->child_subtrees.end());
    }
    return sum.json();
}

}  // namespace citystream::tiles::layers
