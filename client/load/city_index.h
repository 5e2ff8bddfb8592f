// The directory of the city under load as its clients have received it: which tile a draw shows, and how many wire
// bytes a prefix has.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <map>
#include <optional>
#include <set>
#include <shared_mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "client/render/frame.h"
#include "client/select/chart_dictionary.h"
#include "client/select/facade_dictionary.h"
#include "tiles/tileset/directory.h"
#include "tiles/tileset/subtree.h"

namespace citystream::client {

/// Address in "tiles/LEVEL/X/Y.LAYER" or "subtrees/LEVEL/X/Y.subtree"; nothing for other paths.
std::optional<tiles::tileset::TileAddress> address_in_path(std::string_view path, std::string_view folder);

/// Shared by all clients of a run: thread-safe. Records stay where they are once learnt.
class CityIndex {
  public:
    /// Learns from a received piece of the directory (tileset.json, a subtree, an index); others and repeated
    /// ones are ignored.
    void learn(const std::string& path, std::span<const std::byte> bytes);
    /// The record of the tile that is drawn, or null.
    const tiles::tileset::TileRecord* find(const TileDraw& draw) const;
    /// Wire bytes of a level of a facade map; 0 when the facade index is not known.
    uint64_t map_bytes(MapPiece piece) const;
    /// Wire bytes of a prefix of a shared chart; 0 when the chart index is not known.
    uint64_t chart_bytes(const ChartPrefix& prefix) const;

  private:
    void learn_subtree(tiles::tileset::TileAddress root, std::span<const std::byte> bytes);

    mutable std::shared_mutex mutex_;
    std::set<std::string> known_paths_;
    std::optional<tiles::tileset::Manifest> manifest_;
    std::list<tiles::tileset::Subtree> subtrees_;
    std::map<tiles::tileset::TileAddress, const tiles::tileset::TileRecord*> tiles_;
    FacadeDictionary dictionary_;
    ChartDictionary charts_;
};

}  // namespace citystream::client
