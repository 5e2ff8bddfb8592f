#include "tiles/city/generator_walls.h"

#include <algorithm>

namespace citystream::tiles::city::procedural {
namespace {

/// Textures for a building that wants one, against those of other uses: window rows differ more than bare walls.
constexpr std::array<uint32_t, kWallUses> kWeights = {10, 16, 20, 10, 5, 7, 4};

struct Wanted {
    WallUse front, ground_floor;
    bool has_ground_floor;
};

Wanted wanted_by(FacadeUse use) {
    switch (use) {
        case FacadeUse::kApartment:
            return {WallUse::kApartment, WallUse::kShop, true};
        case FacadeUse::kTower:
            return {WallUse::kTower, WallUse::kShop, true};
        case FacadeUse::kHall:
            return {WallUse::kHall, WallUse::kPlain, false};
        default:
            return {WallUse::kHouse, WallUse::kHouseDoor, true};
    }
}

/// Numbers below `textures` that are of this family.
uint32_t family_size(uint32_t textures, uint32_t family) {
    return textures / kWallFamilies + (textures % kWallFamilies > family ? 1 : 0);
}

/// Textures of each use: a few for whoever wants any, the rest by demand and weight, to none more than it can show.
std::array<uint32_t, kWallUses> shares_of(uint32_t textures, const WallDemand& demand) {
    std::array<uint32_t, kWallUses> shares{};
    const auto give = [&](size_t use, uint64_t count) {
        const auto given =
            static_cast<uint32_t>(std::min({count, uint64_t{demand[use] - shares[use]}, uint64_t{textures}}));
        shares[use] += given;
        textures -= given;
    };
    for (size_t use = 0; use < kWallUses; ++use) give(use, kWallFamilies);
    for (uint32_t before = 0; textures != before;) {
        uint64_t total = 0;
        for (size_t use = 0; use < kWallUses; ++use)
            if (shares[use] < demand[use]) total += uint64_t{kWeights[use]} * demand[use];
        before = textures;
        // Rounded up, so that each round gives something while anyone has room.
        for (size_t use = 0; use < kWallUses && total > 0; ++use)
            give(use, (uint64_t{before} * kWeights[use] * demand[use] + total - 1) / total);
    }
    return shares;
}

}  // namespace

void add_demand(WallDemand& demand, FacadeUse use) {
    const Wanted wanted = wanted_by(use);
    ++demand[static_cast<size_t>(wanted.front)];
    if (wanted.has_ground_floor) ++demand[static_cast<size_t>(wanted.ground_floor)];
    ++demand[static_cast<size_t>(WallUse::kPlain)];
}

WallDealer::WallDealer(CityCatalog& catalog, uint64_t seed, uint32_t textures, const WallDemand& demand)
    : catalog_(catalog), seed_(seed) {
    const std::array<uint32_t, kWallUses> shares = shares_of(std::max(textures, kLeastTextures), demand);
    for (size_t use = 0; use < kWallUses; ++use) {
        decks_[use].textures = shares[use];
        decks_[use].wanted = demand[use];
    }
}

WallDress WallDealer::deal(FacadeUse use, Random& random) {
    const Wanted wanted = wanted_by(use);
    WallDress dress;
    dress.front = next(wanted.front, random.below(kWallFamilies), random);
    const int family = dress.front.texture.family;
    dress.side = random.chance(55) ? dress.front : popular(wanted.front, family, random);
    dress.plain = next(WallUse::kPlain, family, random);
    dress.has_ground_floor = wanted.has_ground_floor;
    if (wanted.has_ground_floor) dress.ground_floor = next(wanted.ground_floor, family, random);
    return dress;
}

WallMaterial WallDealer::next(WallUse use, int family, Random& random) {
    Deck& from = deck(use);
    const uint64_t before = uint64_t{from.dealt} * from.textures / std::max(from.wanted, 1U),
                   after = uint64_t{from.dealt + 1} * from.textures / std::max(from.wanted, 1U);
    ++from.dealt;
    if (after == before) return popular(use, family, random);
    // A family that is used up leaves the new ones to the next.
    for (uint32_t step = 0; step < kWallFamilies; ++step) {
        const uint32_t of = (static_cast<uint32_t>(family) + step) % kWallFamilies;
        uint32_t& taken = from.next[of];
        if (taken < family_size(from.textures, of)) return material(use, kWallFamilies * taken++ + of);
    }
    return popular(use, family, random);
}

WallMaterial WallDealer::popular(WallUse use, int family, Random& random) {
    constexpr int kBits = 20;
    const auto of = static_cast<uint32_t>(family) % std::clamp<uint32_t>(deck(use).textures, 1, kWallFamilies);
    const uint64_t u = random.next() >> (64 - kBits);
    const uint64_t cube = (u * u >> kBits) * u >> kBits;
    return material(use,
                    kWallFamilies * static_cast<uint32_t>(family_size(deck(use).textures, of) * cube >> kBits) + of);
}

WallMaterial WallDealer::material(WallUse use, uint32_t number) {
    const WallTexture texture = describe_wall(use, number, seed_);
    const auto [known, is_new] =
        deck(use).materials.try_emplace(number, static_cast<uint32_t>(catalog_.materials.size()));
    if (is_new) {
        Material made;
        made.rgb = texture.colour;
        made.image = static_cast<int32_t>(catalog_.images.size());
        made.metres_per_repeat = static_cast<float>(texture.width_mm) / 1000.0F;
        catalog_.images.push_back({.make = [texture] { return draw_wall(texture); }});
        catalog_.materials.push_back(made);
    }
    return {known->second, texture};
}

}  // namespace citystream::tiles::city::procedural
