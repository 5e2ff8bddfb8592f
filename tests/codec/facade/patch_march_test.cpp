// The shaders' march through patch maps against a walk over all cells by the same float rules (facade_ray.glsl): the
// same hit to the last bit, whatever the ray.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "codec/facade/patch_map.h"
#include "tests/codec/facade/relief_cases.h"
#include "tests/shaders/facade_on_cpu.h"

namespace citystream::codec::facade {
namespace {

using shaders_test::ShaderCost;
using shaders_test::ShaderHit;

constexpr float kNever = 1e30f;

/// Walks the cells of the run grid by the rules of facade_ray.glsl.
class CellWalk {
  public:
    CellWalk(const RunGrid& grid, const float origin[3], const float direction[3]) : grid_(grid) {
        for (int axis = 0; axis < 3; ++axis) {
            origin_[axis] = origin[axis];
            direction_[axis] = std::abs(direction[axis]) < 1e-18f ? 0 : direction[axis];
            inverse_[axis] = direction_[axis] == 0 ? 0 : 1 / direction_[axis];
        }
    }

    ShaderHit cast() {
        const DepthRange depths = grid_.depths();
        const float low[3] = {0, 0, static_cast<float>(depths.min_mm)};
        const float high[3] = {static_cast<float>(grid_.width()), static_cast<float>(grid_.height()),
                               static_cast<float>(depths.max_mm)};
        float enter = 0;
        int axis = -1;
        for (int a = 0; a < 3; ++a) {
            if (direction_[a] == 0) {
                if (origin_[a] < low[a] || origin_[a] > high[a]) return {};
                continue;
            }
            const float near = std::min(plane(a, low[a]), plane(a, high[a]));
            if (near > enter) {
                enter = near;
                axis = a;
            }
            leave_ = std::min(leave_, std::max(plane(a, low[a]), plane(a, high[a])));
        }
        return enter > leave_ ? ShaderHit{} : walk(enter, axis);
    }

  private:
    float plane(int axis, float at) const { return (at - origin_[axis]) * inverse_[axis]; }

    uint32_t start(int axis, const std::vector<uint32_t>& breaks, float t) const {
        const float at = origin_[axis] + t * direction_[axis];
        const float texel = direction_[axis] < 0 ? std::ceil(at) - 1 : std::floor(at);
        const float last = static_cast<float>(breaks.back() - 1);
        const auto place = static_cast<uint32_t>(std::clamp(texel, 0.0f, last));
        return static_cast<uint32_t>(std::upper_bound(breaks.begin(), breaks.end(), place) - breaks.begin()) - 1;
    }

    /// Where the ray leaves the cell along an axis.
    float exit(int axis, const std::vector<uint32_t>& breaks, uint32_t cell) const {
        if (direction_[axis] == 0) return kNever;
        const bool rises = direction_[axis] > 0;
        if (rises ? cell + 2 == breaks.size() : cell == 0) return kNever;
        return plane(axis, static_cast<float>(breaks[rises ? cell + 1 : cell]));
    }

    bool is_below(float t, float depth) const {
        if (direction_[2] == 0) return origin_[2] < depth;
        return direction_[2] < 0 ? t > plane(2, depth) : t < plane(2, depth);
    }

    ShaderHit hit_at(float t, uint32_t label, int axis) const {
        const bool rises = axis >= 0 && direction_[axis] > 0;
        return {true, t, label, axis < 0 ? 2 : axis, rises ? -1 : 1, false};
    }

    ShaderHit walk(float t, int axis) const {
        uint32_t x = start(0, grid_.x_breaks, t), y = start(1, grid_.y_breaks, t);
        const auto is_open = [](uint32_t label) { return displacement_of(label) == kOpenDisplacement; };
        if (axis == 2 && direction_[2] > 0 && !is_open(grid_.label(x, y))) return hit_at(t, grid_.label(x, y), 2);
        for (;;) {
            const uint32_t label = grid_.label(x, y);
            const auto depth = static_cast<float>(displacement_of(label));
            if (axis != 2 && !is_open(label) && is_below(t, depth)) return hit_at(t, label, axis);
            const float across = exit(0, grid_.x_breaks, x), up = exit(1, grid_.y_breaks, y);
            const float until = std::max(t, std::min(std::min(across, up), leave_));
            if (direction_[2] < 0 && !is_open(label) && plane(2, depth) <= until)
                return hit_at(std::max(plane(2, depth), t), label, 2);
            if (until >= leave_) return {};
            t = until;
            axis = across <= up ? 0 : 1;
            uint32_t& cell = axis == 0 ? x : y;
            cell = direction_[axis] > 0 ? cell + 1 : cell - 1;
        }
    }

    const RunGrid& grid_;
    float origin_[3], direction_[3], inverse_[3];
    float leave_ = kNever;
};

/// Rays of all kinds: by the case, from in front at up to 89.9 degrees, along planes, from breaks, corner to corner,
/// from behind and from inside.
struct Ray {
    float origin[3], direction[3];
};

class RayMaker {
  public:
    RayMaker(const RunGrid& grid, uint64_t seed) : grid_(grid), depths_(grid.depths()), numbers_(seed) {}

    Ray make(uint32_t kind) {
        Ray ray{};
        const float size[2] = {static_cast<float>(grid_.width()), static_cast<float>(grid_.height())};
        const auto top = static_cast<float>(depths_.max_mm), bottom = static_cast<float>(depths_.min_mm);
        const float degrees = kind % 8 == 1 ? 89.9f : static_cast<float>(numbers_.below(86));
        const float angle = degrees * 3.14159265f / 180, turn = unit() * 6.2831853f;
        ray.origin[0] = unit() * size[0];
        ray.origin[1] = unit() * size[1];
        ray.origin[2] = top;
        ray.direction[0] = std::sin(angle) * std::cos(turn);
        ray.direction[1] = std::sin(angle) * std::sin(turn);
        ray.direction[2] = -10 * std::cos(angle);
        if (kind % 8 == 2) ray.direction[numbers_.below(3)] = 0;
        if (kind % 8 == 3) on_breaks(ray);
        if (kind % 8 == 4) {  // from corner to corner, by whole numbers
            for (int a = 0; a < 2; ++a) ray.direction[a] = numbers_.below(2) == 0 ? size[a] : -size[a];
            for (int a = 0; a < 2; ++a) ray.origin[a] = ray.direction[a] > 0 ? 0 : size[a];
            ray.direction[2] = bottom - top;
        }
        if (kind % 8 == 5) {  // from behind
            ray.origin[2] = bottom - 10;
            ray.direction[2] = -ray.direction[2];
        }
        if (kind % 8 == 6) ray.origin[2] = bottom + unit() * (top - bottom);  // from inside
        if (kind % 8 == 7) {                                                  // from beside
            for (float& at : ray.origin) at = at - 500 * (unit() - 0.5f);
        }
        return ray;
    }

  private:
    float unit() { return static_cast<float>(numbers_.below(1u << 20)) / (1u << 20); }
    /// Starts on breaks and goes diagonally, so that it meets corners exactly.
    void on_breaks(Ray& ray) {
        ray.origin[0] = static_cast<float>(grid_.x_breaks[numbers_.below(grid_.columns() + 1)]);
        ray.origin[1] = static_cast<float>(grid_.y_breaks[numbers_.below(grid_.rows() + 1)]);
        ray.direction[0] = numbers_.below(2) == 0 ? 1.0f : -1.0f;
        ray.direction[1] = numbers_.below(3) == 0 ? 0.0f : numbers_.below(2) == 0 ? 1.0f : -1.0f;
    }

    const RunGrid& grid_;
    DepthRange depths_;
    TestNumbers numbers_;
};

void expect_same_hits(const ReliefCase& c, uint32_t rays, ShaderCost& cost) {
    const RunGrid grid = make_run_grid(c.relief).value();
    const auto words = encode_patch_map(grid).value();
    RayMaker maker(grid, 7);
    for (uint32_t i = 0; i < rays; ++i) {
        const Ray ray = maker.make(i);
        const ShaderHit got =
            shaders_test::cast_on_cpu(client::FacadeRenderer::kPatch, words, ray.origin, ray.direction, 0, 0, &cost);
        const ShaderHit want = CellWalk(grid, ray.origin, ray.direction).cast();
        ASSERT_EQ(got.hit, want.hit) << c.name << ", ray " << i;
        if (!got.hit) continue;
        ASSERT_EQ(got.t, want.t) << c.name << ", ray " << i;
        ASSERT_EQ(got.label, want.label) << c.name << ", ray " << i;
        ASSERT_EQ(got.axis, want.axis) << c.name << ", ray " << i;
        ASSERT_EQ(got.side, want.side) << c.name << ", ray " << i;
    }
}

TEST(PatchMarch, HitsWhatTheWalkOverAllCellsHits) {
    ShaderCost cost;
    for (const ReliefCase& c : small_reliefs()) expect_same_hits(c, 8000, cost);
    for (const ReliefCase& c : large_reliefs()) expect_same_hits(c, 8000, cost);
}

TEST(PatchMarch, TakesFewLoads) {
    const RunGrid grid = make_run_grid(window_relief(900, 700, 3, false)).value();
    const auto words = encode_patch_map(grid).value();
    ShaderCost cost, lookups;
    const uint32_t rays = 4000;
    RayMaker maker(grid, 7);
    for (uint32_t i = 0; i < rays; ++i) {
        const Ray ray = maker.make(0);
        (void)shaders_test::cast_on_cpu(client::FacadeRenderer::kPatch, words, ray.origin, ray.direction, 0, 0, &cost);
    }
    EXPECT_LT(cost.loads, 16 * rays);
    TestNumbers numbers(3);
    for (uint32_t i = 0; i < rays; ++i)
        (void)shaders_test::lookup_on_cpu(words, numbers.below(900), numbers.below(700), &lookups);
    EXPECT_LT(lookups.loads, 9 * rays);
    std::printf("%.2f loads a ray, %.2f a lookup\n", static_cast<double>(cost.loads) / rays,
                static_cast<double>(lookups.loads) / rays);
}

}  // namespace
}  // namespace citystream::codec::facade
