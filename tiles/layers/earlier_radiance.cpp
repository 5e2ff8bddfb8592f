#include "tiles/layers/earlier_radiance.h"

#include <deque>
#include <filesystem>
#include <system_error>

#include "codec/radiance/radiance_layer.h"
#include "tiles/tileset/subtree.h"
#include "tiles/tileset/tileset_json.h"

namespace citystream::tiles::layers {

using tileset::TileAddress;

namespace {

constexpr auto kLayer = tileset::Layer::kRadiance;

}  // namespace

Result<std::unique_ptr<EarlierRadiance>> EarlierRadiance::open(const std::string& path) {
    std::error_code failed;
    if (!std::filesystem::is_regular_file(path, failed)) return std::unique_ptr<EarlierRadiance>();
    auto reader = archive::ArchiveReader::open(path);
    if (!reader) return reader.error();
    auto earlier = std::make_unique<EarlierRadiance>();
    earlier->reader_ = std::move(reader).value();
    if (Status status = earlier->read_directory(); !status) return status.error();
    if (earlier->places_.empty() && earlier->damaged_ == 0) return std::unique_ptr<EarlierRadiance>();
    return earlier;
}

Status EarlierRadiance::read_directory() {
    const auto manifest = tileset::parse_tileset_json(reader_->find(tileset::kTilesetPath));
    if (!manifest) return manifest.error();
    if (!manifest->has_layer[static_cast<size_t>(kLayer)]) return Done{};
    for (std::deque<TileAddress> open = {TileAddress{}}; !open.empty(); open.pop_front()) {
        const std::string path = tileset::subtree_path(open.front());
        const auto subtree = tileset::parse_subtree(reader_->find(path), open.front(), *manifest);
        if (!subtree) return Error{path + ": " + subtree.error().text()};
        for (const tileset::TileRecord& tile : subtree->tiles) {
            if (!tile.steps(kLayer).empty()) note(tile);
        }
        open.insert(open.end(), subtree->child_subtrees.begin(), subtree->child_subtrees.end());
    }
    return Done{};
}

void EarlierRadiance::note(const tileset::TileRecord& tile) {
    Place place{tileset::layer_path(kLayer, tile.address), tile.steps(kLayer)};
    const auto bytes = reader_->find(place.entry);
    // Nothing of a layer that is not as long as the directory says.
    const auto first = bytes.first(place.steps.back().end == bytes.size() ? place.steps.front().end : 0);
    const auto hash = codec::radiance::read_bake_hash(first);
    const auto transport = codec::radiance::read_radiance_transport(first);
    if (hash && transport) {
        place.transport = *transport;
        places_.emplace(*hash, std::move(place));
    } else {
        ++damaged_;
    }
}

std::optional<EarlierRadiance::Layer> EarlierRadiance::find(uint64_t bake_hash) const {
    const auto found = places_.find(bake_hash);
    if (found == places_.end()) return std::nullopt;
    const Place& place = found->second;
    const auto bytes = reader_->find(place.entry);
    uint64_t begin = 0;
    for (const tileset::StepRecord& step : place.steps) {
        if (tileset::checksum_of(bytes.data() + begin, step.end - begin) != step.checksum) {
            ++damaged_;
            return std::nullopt;
        }
        begin = step.end;
    }
    return Layer{bytes, place.steps, place.transport};
}

}  // namespace citystream::tiles::layers
