// Facades and rays that try the shaders' ray casting, and the judgement of a hit against the double-precision
// reference. Shared by the tests on the CPU (tests/shaders) and on the GPU (tests/client/render).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "codec/facade/facade_ray.h"
#include "codec/facade/run_grid.h"

namespace citystream::shaders_test {

using Ray = std::array<float, 6>;  ///< origin and direction in facade space

struct FacadeCase {
    std::string name;
    codec::facade::RunGrid grid;
};

/// Overlapping boxes of relief in and out of the wall on a wall of `width` x `height` texels; `open`: some are
/// openings.
codec::facade::RunGrid random_facade(uint32_t seed, uint32_t width, uint32_t height, uint32_t boxes, bool open = false);

/// The shapes that break casters: flat, 1 x N, N x 1, one texel, checkerboard, all texels different, full depth beside
/// open, all open, relief in and out of the wall, thin slats.
std::vector<FacadeCase> awkward_facades();

/// `count` rays at a facade: from in front, from beside, from behind, from inside; one in eight parallel to a plane,
/// one in eight starting on a face of the volume or on a break, one in eight at 85 to 89.9 degrees, one in eight
/// through a corner of the volume.
std::vector<Ray> rays_at(const codec::facade::RunGrid& grid, uint32_t seed, size_t count);
/// Whether ray i is one of those that run along planes, start on them or go through corners: there float and double may
/// decide differently.
constexpr bool is_on_edges(size_t i) {
    return i % 8 == 1 || i % 8 == 2 || i % 8 == 4;
}

struct CastResult {
    bool hit = false;
    float t = 0;
    uint32_t label = 0;
    int axis = 2, side = 1;
};

enum class Judgement {
    kSame,      ///< hit, label, normal and place
    kNearEdge,  ///< what the reference says of the ray moved by float's rounding
    kWrong,
};

class RayJudge {
  public:
    explicit RayJudge(const codec::facade::RunGrid& grid) : grid_(grid), depths_(grid.depths()) {}
    codec::facade::FacadeRayHit reference(const Ray& ray) const;
    Judgement judge(const Ray& ray, const CastResult& got) const;

  private:
    bool agrees(const double origin[3], const double direction[3], const CastResult& got) const;

    const codec::facade::RunGrid& grid_;
    codec::facade::DepthRange depths_;
};

/// Counts over many rays.
struct RayTally {
    uint64_t rays = 0, hits = 0, near_edges = 0, wrong = 0;
    std::string first_wrong;  ///< for the message of a failed test

    void add(const RayJudge& judge, const Ray& ray, const CastResult& got, const std::string& name);
};

/// That no ray was wrong and float's rounding mattered to few: prints the counts.
void expect_exact(const RayTally& ordinary, const RayTally& on_edges);

}  // namespace citystream::shaders_test
