#include "tiles/layers/city_archive.h"

#include <algorithm>
#include <map>

#include "codec/atlas/atlas_layout.h"
#include "tiles/archive/archive.h"
#include "tiles/tileset/chart_index.h"
#include "tiles/tileset/facade_index.h"
#include "tiles/tileset/subtree.h"
#include "tiles/tileset/tileset_json.h"

namespace citystream::tiles::layers {
namespace {

using tileset::TileAddress;

bool morton_less(const TileAddress& a, const TileAddress& b) {
    if (a.level != b.level) return a.level < b.level;
    return quadtree::morton(a.x, a.y) < quadtree::morton(b.x, b.y);
}

TileAddress subtree_root(TileAddress tile, uint32_t subtree_levels) {
    const uint32_t down = tile.level % subtree_levels;
    return {tile.level - down, tile.x >> down, tile.y >> down};
}

std::vector<tileset::Subtree> make_subtrees(const std::vector<BuiltTile>& tiles, uint32_t subtree_levels) {
    std::vector<const BuiltTile*> sorted;
    sorted.reserve(tiles.size());
    for (const BuiltTile& tile : tiles) sorted.push_back(&tile);
    std::sort(sorted.begin(), sorted.end(),
              [](const BuiltTile* a, const BuiltTile* b) { return morton_less(a->record.address, b->record.address); });
    std::map<TileAddress, tileset::Subtree> by_root;
    for (const BuiltTile* tile : sorted) {
        const TileAddress root = subtree_root(tile->record.address, subtree_levels);
        tileset::Subtree& subtree = by_root[root];
        subtree.root = root;
        subtree.tiles.push_back(tile->record);
        if (root == tile->record.address && root.level > 0) {
            by_root[subtree_root(root.parent(), subtree_levels)].child_subtrees.push_back(root);
        }
    }
    std::vector<tileset::Subtree> subtrees;
    subtrees.reserve(by_root.size());
    for (auto& [root, subtree] : by_root) subtrees.push_back(std::move(subtree));
    return subtrees;
}

void count_tiles(const ArchiveContents& contents) {
    tileset::Manifest& manifest = contents.manifest;
    manifest.tiles = contents.tiles.size();
    for (size_t i = 0; i < contents.tiles.size(); ++i) {
        const tileset::TileRecord& record = contents.tiles[i].record;
        if (contents.tree.nodes[i].leaf) manifest.triangles += contents.tiles[i].triangles;
        manifest.pages_or_alpha |= contents.tiles[i].pages_or_alpha;
        for (size_t layer = 0; layer < tileset::kLayerCount; ++layer) {
            const auto& steps = record.layers[layer];
            if (steps.empty()) continue;
            manifest.has_layer[layer] = true;
            manifest.wire_bytes[layer] += steps.back().end;
            for (const tileset::StepRecord& step : steps) manifest.decoded_bytes[layer] += step.decoded_bytes;
        }
    }
}

void note_alpha(const ArchiveContents& contents) {
    for (const tileset::ChartRecord& chart : contents.charts.records())
        contents.manifest.pages_or_alpha |= (chart.flags & ATLAS_CHART_ALPHA) != 0;
}

Status add_text(archive::ArchiveWriter& writer, const std::string& name, const std::string& text) {
    return writer.add(name, std::as_bytes(std::span(text)));
}

Status add_tile(archive::ArchiveWriter& writer, const ArchiveContents& contents, const BuiltTile& tile,
                std::vector<std::byte>& scratch) {
    for (size_t layer = 0; layer < tileset::kLayerCount; ++layer) {
        if (tile.record.layers[layer].empty()) continue;
        scratch.clear();
        if (Status status = contents.layer_spool.read(tile.layers[layer], scratch); !status) return status;
        const std::string name = tileset::layer_path(static_cast<tileset::Layer>(layer), tile.record.address);
        if (Status status = writer.add(name, scratch); !status) return status;
    }
    return Done{};
}

struct SubtreeFile {
    std::string name;
    std::vector<std::byte> bytes;
};

/// All of them, for the manifest before them says how large they get.
std::vector<SubtreeFile> make_subtree_files(const ArchiveContents& contents) {
    std::vector<SubtreeFile> files;
    for (const tileset::Subtree& subtree : make_subtrees(contents.tiles, contents.manifest.subtree_levels)) {
        files.push_back({tileset::subtree_path(subtree.root), tileset::write_subtree(subtree, contents.manifest)});
        uint64_t& greatest = contents.manifest.greatest_subtree_bytes;
        greatest = std::max<uint64_t>(greatest, files.back().bytes.size());
    }
    return files;
}

/// Nothing where no chart is shared.
std::vector<std::byte> make_chart_index(const ArchiveContents& contents) {
    if (contents.charts.records().empty()) return {};
    return tileset::write_chart_index(contents.charts.records(), contents.manifest);
}

Status add_directory(archive::ArchiveWriter& writer, const ArchiveContents& contents) {
    const std::vector<std::byte> index = tileset::write_facade_index(contents.facades.records(), contents.manifest);
    const std::vector<std::byte> chart_index = make_chart_index(contents);
    const std::vector<SubtreeFile> subtrees = make_subtree_files(contents);
    if (Status status = add_text(writer, tileset::kTilesetPath, tileset::write_tileset_json(contents.manifest));
        !status)
        return status;
    for (const SubtreeFile& subtree : subtrees) {
        if (Status status = writer.add(subtree.name, subtree.bytes); !status) return status;
    }
    if (Status status = writer.add(tileset::kFacadeIndexPath, index); !status) return status;
    if (Status status = contents.facades.write_entry(writer, contents.facade_spool); !status) return status;
    if (chart_index.empty()) return Done{};
    if (Status status = writer.add(tileset::kChartIndexPath, chart_index); !status) return status;
    return contents.charts.write_entry(writer, contents.chart_spool);
}

}  // namespace

Status write_city_archive(const ArchiveContents& contents) {
    count_tiles(contents);
    note_alpha(contents);
    auto opened = archive::ArchiveWriter::create(contents.options.output);
    if (!opened) return opened.error();
    archive::ArchiveWriter& writer = **opened;
    if (Status status = add_directory(writer, contents); !status) return status;
    std::vector<std::byte> scratch;
    uint64_t done = 0;
    for (const BuiltTile& tile : contents.tiles) {
        if (contents.options.cancel != nullptr && contents.options.cancel->load()) return Error{"interrupted"};
        if (Status status = add_tile(writer, contents, tile, scratch); !status) return status;
        if (contents.options.progress) contents.options.progress("archive", ++done, contents.tiles.size());
    }
    if (!contents.preview.empty()) {
        if (Status status = writer.add(tileset::kPreviewPath, contents.preview); !status) return status;
    }
    return writer.finish();
}

}  // namespace citystream::tiles::layers
