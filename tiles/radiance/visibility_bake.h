// A tile's receivers and what each of them sees, by ray casting: the radiance layer before it is coded.
//
// A receiver casts a ray for each of the 24 n^2 sample directions (codec/radiance/source_directions.h) above its plane.
// The result depends on the input alone, not on the number of threads; and for a receiver that two tiles have in common
// it is the same in both, as long as both are given all triangles within reach of it and heights to the horizon.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "codec/radiance/visibility_bits.h"
#include "codec/result.h"
#include "tiles/radiance/height_grid.h"
#include "tiles/radiance/occluder_scene.h"
#include "tiles/radiance/receiver_lattice.h"
#include "tiles/radiance/surface_triangle.h"

namespace citystream::tiles::radiance {

struct BakeInput {
    std::span<const SurfaceTriangle> own;  ///< the tile's
    /// Its neighbours': all as far as reach.triangles and kDecisiveSpacings spacings from its own, for a receiver may
    /// stand on a neighbour's surface; further ones change nothing.
    std::span<const SurfaceTriangle> around;
    const HeightGrid* heights = nullptr;  ///< of the city as far as reach.horizon; null: nothing is there
};

struct BakeOptions {
    LatticeOptions lattice = {};  ///< `jobs` of it counts for the rays, too
    uint32_t texels_across = 32;  ///< n of the source: 1..codec::radiance::kMostCubeSide
    OccluderReach reach = {};
    const std::atomic<bool>* cancel = nullptr;  ///< set from elsewhere: the bake ends soon
    /// How many receivers there are, before their bits take memory and their rays time; from the thread that bakes.
    std::function<void(uint64_t receivers)> placed{};
    /// Receivers; called from any thread, one call at a time.
    std::function<void(uint64_t done, uint64_t total)> progress{};
};

struct BakedTile {
    std::vector<Receiver> receivers;
    codec::radiance::VisibilityTile visibility;  ///< of the receivers, in their order
    uint64_t rays = 0;
};

/// Frame code of a receiver: its normal, no turn.
uint32_t frame_of(const Receiver& receiver);

/// Error: more than codec::radiance::kMostReceivers, Embree's, "interrupted". Memory: 3 n^2 bytes a receiver, the
/// triangles in reach as occluder_scene.h has them, and the lattice's candidates (about 90 bytes a triangle and
/// column).
Result<BakedTile> bake_tile(const BakeInput& input, const BakeOptions& options);

/// What each receiver sees in a scene. False when it was cancelled.
bool cast_visibility(std::span<const Receiver> receivers, const OccluderScene& scene, const BakeOptions& options,
                     BakedTile& result);

/// A number that changes with whatever bake_tile's result depends on (but for 1 in 2^64): own triangles, those in reach
/// (in any order), heights in reach of the horizon, spacing, n, reach and the version of these rules. Places count from
/// `corner`, so that a city moved by a multiple of the spacing and of kHeightCell keeps its numbers.
uint64_t bake_hash(const BakeInput& input, const BakeOptions& options, const GridPoint& corner);

}  // namespace citystream::tiles::radiance
