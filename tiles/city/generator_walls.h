// Which texture of a city dresses which wall, when walls are textured instead of carrying relief.
//
// The law: the T textures are shared out among the uses (flats, shops, bare walls, ...) by how many buildings want one,
// times a weight. Of the P buildings that want one of a use's K textures, K <= P take a new one, evenly spread, so that
// each texture is seen at least once; the others take number floor(K * u^3) for u evenly in 0..1, of their own colour
// family: density n^(-2/3), so that an eighth of the textures has half of these buildings. Sides and rears follow the
// second rule alone.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "tiles/city/city_model.h"
#include "tiles/city/generator_random.h"
#include "tiles/city/grammar_facades.h"
#include "tiles/city/procedural_wall.h"

namespace citystream::tiles::city::procedural {

/// How many buildings want a texture of each use.
using WallDemand = std::array<uint32_t, kWallUses>;

/// A texture as the catalog knows it.
struct WallMaterial {
    uint32_t material = 0;
    WallTexture texture;
};

/// The textures of one building.
struct WallDress {
    WallMaterial front, side, ground_floor, plain;
    bool has_ground_floor = true;
};

/// Counts what a building of this use wants.
void add_demand(WallDemand& demand, FacadeUse use);

/// Deals textures to buildings in the order of the stream. Adds material and image (made when it is needed) to the
/// catalog when a texture is first dealt: the catalog holds only what is seen.
class WallDealer {
  public:
    /// `textures` >= kLeastTextures.
    WallDealer(CityCatalog& catalog, uint64_t seed, uint32_t textures, const WallDemand& demand);
    WallDress deal(FacadeUse use, Random& random);

  private:
    struct Deck {
        uint32_t textures = 0, wanted = 0, dealt = 0;
        std::array<uint32_t, kWallFamilies> next{};  // of each family: how many were new once
        std::map<uint32_t, uint32_t> materials;      // by number
    };
    WallMaterial next(WallUse use, int family, Random& random);
    WallMaterial popular(WallUse use, int family, Random& random);
    WallMaterial material(WallUse use, uint32_t number);
    Deck& deck(WallUse use) { return decks_[static_cast<size_t>(use)]; }

    CityCatalog& catalog_;
    uint64_t seed_;
    std::array<Deck, kWallUses> decks_;
};

/// Every use with a colour family each.
inline constexpr uint32_t kLeastTextures = kWallUses * kWallFamilies;

}  // namespace citystream::tiles::city::procedural
