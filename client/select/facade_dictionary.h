// What a client knows of the city's facade dictionary: where each level of each map lies, how large it is, and which of
// them can be had. And the rule that chooses a level.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "tiles/tileset/directory.h"

namespace citystream::client {

/// One level of one facade map: what is fetched, kept and drawn as a unit. Numbers grow as payloads follow each other
/// in the maps entry.
using MapPiece = uint32_t;
static_assert(codec::facade::kMostFacadeLevels == 4, "a piece has two bits for the level");
constexpr MapPiece map_piece(uint32_t map, uint32_t level) {
    return map << 2 | level;
}
constexpr uint32_t map_of(MapPiece piece) {
    return piece >> 2;
}
constexpr uint32_t level_of(MapPiece piece) {
    return piece & 3;
}

/// How fine a map must be where it stands.
struct MapDemand {
    double texel_metres = 0;        ///< what is smaller may be missing
    std::optional<uint32_t> level;  ///< this level instead, or the finest where a map has fewer
};

/// Texels of a map's level may project to this share of the tolerance. Levels take the label that covers most of a
/// texel, so bars and frames of up to half a texel vanish together and a facade of bars changes its colour. Four views
/// over a generated city of 1,000 buildings against the reference: 22 to 27 dB at a whole pixel, 31 to 38 at a quarter,
/// 36 to 39 at an eighth as with the exact maps.
inline constexpr double kTexelShare = 0.125;

/// Which relief is drawn, and from which levels.
struct ReliefOptions {
    std::optional<double> tolerance_pixels;  ///< relief that projects to less is drawn flat; empty: as all errors
    std::optional<uint32_t> map_level;  ///< empty: the coarsest whose texels project below kTexelShare of the tolerance
    double texel_share = kTexelShare;   ///< of the tolerance
};

class FacadeDictionary {
  public:
    using SharedMaps = std::shared_ptr<const std::vector<tiles::tileset::FacadeMapRecord>>;
    /// Takes the facade index, which others may share; all levels count as usable.
    void learn(SharedMaps maps);
    void learn(std::vector<tiles::tileset::FacadeMapRecord> maps);
    bool known() const { return size() > 0; }
    size_t size() const { return maps_->size(); }
    const tiles::tileset::FacadeMapRecord& record(uint32_t map) const { return (*maps_)[map]; }
    const tiles::tileset::FacadeLevelRecord& record_of(MapPiece piece) const {
        return record(map_of(piece)).level[level_of(piece)];
    }

    /// Metres: width of what may be missing from a level; 0 of an exact one.
    double texel_error(MapPiece piece) const {
        const uint32_t cm = record_of(piece).texel_cm;
        return cm <= 1 ? 0 : cm * 0.01;
    }

    /// In the maps entry.
    uint64_t begin(MapPiece piece) const;
    uint64_t end(MapPiece piece) const { return record_of(piece).end; }
    uint64_t wire_bytes(MapPiece piece) const { return end(piece) - begin(piece); }
    /// The piece whose payload follows; after the last one a piece of map size().
    MapPiece next(MapPiece piece) const;

    /// In the store: as learnt from converting it, else as shipped.
    uint64_t resident_bytes(MapPiece piece) const;
    bool size_learnt(MapPiece piece) const { return piece < learnt_bytes_.size() && learnt_bytes_[piece] > 0; }
    void learn_size(MapPiece piece, uint64_t bytes);

    /// False: damaged, or too large for the client.
    bool usable(MapPiece piece) const { return (broken_levels_[map_of(piece)] >> level_of(piece) & 1) == 0; }
    void set_usable(MapPiece piece, bool usable);
    bool has_usable_level(uint32_t map) const;

    /// Whether a level is known to have no open cells: learnt when it comes.
    bool opaque(MapPiece piece) const { return (opaque_levels_[map_of(piece)] >> level_of(piece) & 1) != 0; }
    void learn_opaque(MapPiece piece);

    /// The coarsest level whose texels are fine enough; where that cannot be had the next coarser one, else the next
    /// finer one. Nothing when no level can be had, or nothing is known of the map.
    std::optional<MapPiece> wanted(uint32_t map, const MapDemand& demand) const;

    uint64_t host_bytes() const;
    /// Grows whenever a choice made before may be another one now.
    uint64_t changes() const { return changes_; }

  private:
    SharedMaps maps_ = std::make_shared<const std::vector<tiles::tileset::FacadeMapRecord>>();
    std::vector<uint8_t> broken_levels_;  ///< by map: a bit a level
    std::vector<uint8_t> opaque_levels_;  ///< by map: a bit a level
    std::vector<uint64_t> learnt_bytes_;  ///< by piece, 0: unknown; empty until the first is learnt
    uint64_t changes_ = 0;
};

}  // namespace citystream::client
