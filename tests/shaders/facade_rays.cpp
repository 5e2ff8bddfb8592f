#include "tests/shaders/facade_rays.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

namespace citystream::shaders_test {

using codec::facade::DepthRange;
using codec::facade::FacadeMatrices;
using codec::facade::FacadeRayHit;
using codec::facade::kOpenDisplacement;
using codec::facade::RunGrid;

namespace {

/// The same numbers from every standard library.
struct Dice {
    std::mt19937 engine;
    uint32_t below(uint32_t n) { return static_cast<uint32_t>(uint64_t{engine()} * n >> 32); }
    double unit() { return static_cast<double>(engine()) * 0x1p-32; }
    double between(double low, double high) { return low + unit() * (high - low); }
};

template <typename Depth, typename Material>
RunGrid facade_of(uint32_t width, uint32_t height, Depth depth, Material material) {
    FacadeMatrices matrices{width, height, {}, {}};
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            matrices.displacement_mm.push_back(static_cast<int16_t>(depth(x, y)));
            matrices.material.push_back(static_cast<uint16_t>(material(x, y)));
        }
    }
    return *codec::facade::make_run_grid(matrices);
}

}  // namespace

RunGrid random_facade(uint32_t seed, uint32_t width, uint32_t height, uint32_t boxes, bool open) {
    Dice dice{std::mt19937(seed)};
    FacadeMatrices matrices{width, height, std::vector<int16_t>(size_t{width} * height, 0),
                            std::vector<uint16_t>(size_t{width} * height, 0)};
    for (uint32_t box = 0; box < boxes; ++box) {
        const uint32_t x0 = dice.below(width), y0 = dice.below(height);
        const uint32_t x1 = std::min(width, x0 + 1 + dice.below(width / 3 + 1));
        const uint32_t y1 = std::min(height, y0 + 1 + dice.below(height / 3 + 1));
        const bool is_open = open && dice.below(4) == 0;
        const int depth = is_open ? kOpenDisplacement : static_cast<int>(dice.below(701)) - 300;
        const uint32_t material = dice.below(16);
        for (uint32_t y = y0; y < y1; ++y) {
            for (uint32_t x = x0; x < x1; ++x) {
                matrices.displacement_mm[size_t{y} * width + x] = static_cast<int16_t>(depth);
                matrices.material[size_t{y} * width + x] = static_cast<uint16_t>(material);
            }
        }
    }
    return *codec::facade::make_run_grid(matrices);
}

std::vector<FacadeCase> awkward_facades() {
    const auto none = [](uint32_t, uint32_t) { return 0; };
    const auto stripe = [](uint32_t x, uint32_t y) { return (x + y) % 5; };
    std::vector<FacadeCase> cases;
    cases.push_back({"one texel", facade_of(1, 1, none, none)});
    cases.push_back({"flat at the wall", facade_of(40, 30, none, none)});
    cases.push_back({"flat, far out, materials differ", facade_of(
                                                            33, 17, [](uint32_t, uint32_t) { return 250; }, stripe)});
    cases.push_back(
        {"1 x 200", facade_of(
                        1, 200, [](uint32_t, uint32_t y) { return static_cast<int>(y * 7 % 40) - 20; }, stripe)});
    cases.push_back(
        {"200 x 1", facade_of(
                        200, 1, [](uint32_t x, uint32_t) { return static_cast<int>(x * 11 % 60) - 30; }, stripe)});
    cases.push_back(
        {"checkerboard", facade_of(
                             32, 32, [](uint32_t x, uint32_t y) { return (x + y) % 2 == 0 ? 40 : -40; }, stripe)});
    cases.push_back({"all texels different",
                     facade_of(
                         31, 29, [](uint32_t x, uint32_t y) { return static_cast<int>(x * 131 + y * 37) % 899 - 449; },
                         [](uint32_t x, uint32_t y) { return (x * 29 + y) % 977; })});
    cases.push_back(
        {"full depth in and out",
         facade_of(
             24, 24, [](uint32_t x, uint32_t y) { return (x / 6 + y / 6) % 2 == 0 ? 32767 : -32767; }, stripe)});
    cases.push_back({"full depth beside open", facade_of(
                                                   24, 24,
                                                   [](uint32_t x, uint32_t y) {
                                                       return x / 6 % 2 == 0 ? kOpenDisplacement : y < 12 ? 500 : -500;
                                                   },
                                                   stripe)});
    cases.push_back({"all open", facade_of(
                                     20, 20, [](uint32_t, uint32_t) { return kOpenDisplacement; }, stripe)});
    cases.push_back({"only into the wall",
                     facade_of(
                         60, 40, [](uint32_t x, uint32_t y) { return x % 20 > 5 && y % 20 > 8 ? -180 : 0; }, stripe)});
    cases.push_back({"only out of the wall",
                     facade_of(
                         60, 40, [](uint32_t x, uint32_t y) { return x % 20 > 5 && y % 20 > 8 ? 180 : 0; }, none)});
    cases.push_back(
        {"slats of a millimetre", facade_of(
                                      64, 64, [](uint32_t x, uint32_t) { return static_cast<int>(x % 2); }, none)});
    cases.push_back(
        {"staircase", facade_of(
                          50, 20, [](uint32_t x, uint32_t) { return static_cast<int>(x) * 20 - 500; }, stripe)});
    return cases;
}

std::vector<Ray> rays_at(const RunGrid& grid, uint32_t seed, size_t count) {
    Dice dice{std::mt19937(seed)};
    const DepthRange depths = grid.depths();
    const double size[3] = {double(grid.width()), double(grid.height()),
                            std::max(50.0, double(depths.max_mm - depths.min_mm))};
    const double low[3] = {0, 0, double(depths.min_mm)};
    const double reach = std::max(size[0], size[1]);
    std::vector<Ray> rays;
    rays.reserve(count);
    for (size_t i = 0; i < count; ++i) {
        double origin[3], target[3], direction[3];
        for (int a = 0; a < 3; ++a) target[a] = low[a] + dice.unit() * size[a];
        for (int a = 0; a < 3; ++a) origin[a] = low[a] + (dice.unit() * 1.6 - 0.3) * size[a];
        // Most look at the wall from in front, some from behind and from inside.
        const uint32_t from = dice.below(10);
        if (from < 7) origin[2] = depths.max_mm + dice.unit() * 10 * reach;
        if (from == 7) origin[2] = depths.min_mm - dice.unit() * 10 * reach;
        for (int a = 0; a < 3; ++a) direction[a] = target[a] - origin[a];
        switch (i % 8) {
            case 1:  // parallel to a plane, to two planes
                direction[dice.below(3)] = 0;
                if (dice.below(2) == 0) direction[dice.below(3)] = 0;
                break;
            case 2: {  // starts on a face of the volume, or on a break
                const uint32_t a = dice.below(3);
                origin[a] = dice.below(2) == 0 ? low[a] : a == 2 ? depths.max_mm : size[a];
                if (a == 0 && dice.below(2) == 0) origin[0] = grid.x_breaks[dice.below(grid.columns() + 1)];
                if (a == 1 && dice.below(2) == 0) origin[1] = grid.y_breaks[dice.below(grid.rows() + 1)];
                break;
            }
            case 3: {  // 85 to 89.9 degrees from the normal (10 mm a texel)
                const double angle = dice.between(85, 89.9) * 3.14159265358979323846 / 180;
                const double azimuth = dice.unit() * 6.283185307179586;
                direction[0] = std::sin(angle) * std::cos(azimuth) * 100;
                direction[1] = std::sin(angle) * std::sin(azimuth) * 100;
                direction[2] = -std::cos(angle) * 1000;
                const double back = (target[2] - depths.max_mm - 1) / direction[2];
                for (int a = 0; a < 3; ++a) origin[a] = target[a] - back * direction[a];
                break;
            }
            case 4:  // through a corner of the volume
                for (int a = 0; a < 2; ++a) target[a] = dice.below(2) == 0 ? 0 : size[a];
                target[2] = dice.below(2) == 0 ? depths.min_mm : depths.max_mm;
                for (int a = 0; a < 3; ++a) direction[a] = target[a] - origin[a];
                break;
            default:
                break;
        }
        Ray ray{};
        for (size_t a = 0; a < 3; ++a) {
            ray[a] = static_cast<float>(origin[a]);
            ray[3 + a] = static_cast<float>(direction[a]);
        }
        rays.push_back(ray);
    }
    return rays;
}

FacadeRayHit RayJudge::reference(const Ray& ray) const {
    const double origin[3] = {ray[0], ray[1], ray[2]};
    const double direction[3] = {ray[3], ray[4], ray[5]};
    return codec::facade::cast_facade_ray(grid_, depths_, origin, direction);
}

bool RayJudge::agrees(const double origin[3], const double direction[3], const CastResult& got) const {
    const FacadeRayHit want = codec::facade::cast_facade_ray(grid_, depths_, origin, direction);
    if (want.hit != got.hit) return false;
    if (!want.hit) return true;
    if (want.label != got.label || want.normal_axis != got.axis || want.normal_sign != got.side) return false;
    // A hundredth of a texel or a tenth of a millimetre, more by float's rounding where the hit is far away.
    const double t = static_cast<double>(got.t);
    double moved = 0, travelled = 0;
    for (int a = 0; a < 3; ++a) {
        const double length = std::abs(direction[a]) * (a == 2 ? 0.1 : 1);
        moved = std::max(moved, std::abs(t - want.t) * length);
        travelled = std::max(travelled, std::abs(want.t) * length);
    }
    return moved <= 0.01 + travelled * 1e-6;
}

Judgement RayJudge::judge(const Ray& ray, const CastResult& got) const {
    const double origin[3] = {ray[0], ray[1], ray[2]};
    const double direction[3] = {ray[3], ray[4], ray[5]};
    if (agrees(origin, direction, got)) return Judgement::kSame;
    // The rounding of a product is relative to how far the ray has come.
    const double scale =
        std::max({1.0, std::abs(origin[0]) * 1e-3, std::abs(origin[1]) * 1e-3, std::abs(origin[2]) * 1e-4});
    for (const double step : {1e-3, 1e-4, 1e-5, 1e-6}) {
        for (int i = 0; i < 27; ++i) {
            const double moved[3] = {origin[0] + (i % 3 - 1) * step * scale, origin[1] + (i / 3 % 3 - 1) * step * scale,
                                     origin[2] + (i / 9 - 1) * 10 * step * scale};
            if (agrees(moved, direction, got)) return Judgement::kNearEdge;
        }
    }
    return Judgement::kWrong;
}

void RayTally::add(const RayJudge& judge, const Ray& ray, const CastResult& got, const std::string& name) {
    const Judgement verdict = judge.judge(ray, got);
    ++rays;
    hits += got.hit ? 1 : 0;
    near_edges += verdict == Judgement::kNearEdge ? 1 : 0;
    if (verdict != Judgement::kWrong) return;
    if (wrong++ != 0) return;
    const FacadeRayHit want = judge.reference(ray);
    char text[400];
    std::snprintf(text, sizeof text,
                  "%s: ray (%.9g %.9g %.9g) + t (%.9g %.9g %.9g): hit %d t %.9g label %x axis %d side %d, reference %d "
                  "%.9g %x %d %d",
                  name.c_str(), ray[0], ray[1], ray[2], ray[3], ray[4], ray[5], got.hit, got.t, got.label, got.axis,
                  got.side, want.hit, want.t, want.label, want.normal_axis, want.normal_sign);
    first_wrong = text;
}

void expect_exact(const RayTally& ordinary, const RayTally& on_edges) {
    EXPECT_EQ(ordinary.wrong, 0u) << ordinary.first_wrong;
    EXPECT_EQ(on_edges.wrong, 0u) << on_edges.first_wrong;
    EXPECT_GT(ordinary.hits, ordinary.rays / 4);
    EXPECT_LE(ordinary.near_edges, ordinary.rays / 1000);
    EXPECT_LE(on_edges.near_edges, on_edges.rays / 20);
    const auto number = [](uint64_t n) { return static_cast<unsigned long long>(n); };
    std::printf("%llu rays, %llu hits, %llu within rounding of an edge; made to meet edges: %llu, %llu, %llu\n",
                number(ordinary.rays), number(ordinary.hits), number(ordinary.near_edges), number(on_edges.rays),
                number(on_edges.hits), number(on_edges.near_edges));
}

}  // namespace citystream::shaders_test
