#include "tiles/layers/relief_extraction_surroundings.h"

#include <algorithm>
#include <cmath>

namespace citystream::tiles::layers::relief {
namespace {

constexpr double kBucketMetres = 0.25, kMarginMetres = 0.5;
constexpr double kFront = 0.95;  // parts that face more to the front than this cover no side

double distance_to_segment(const Point& p, const Point& a, const Point& b) {
    const Point d = b - a;
    const double size = dot(d, d);
    const double t = size > 0 ? std::clamp(dot(p - a, d) / size, 0.0, 1.0) : 0.0;
    return length(p - (a + d * t));
}

bool near_bounds(const Point& p, const Part& part, double reach) {
    return p.u >= part.low.u - reach && p.u <= part.high.u + reach && p.v >= part.low.v - reach &&
           p.v <= part.high.v + reach && p.w >= part.low.w - reach && p.w <= part.high.w + reach;
}

}  // namespace

double distance_to_part(const Point& p, const Part& part) {
    const auto& [a, b, c] = part.corner;
    const Point& n = part.normal;
    const bool over = dot(cross(b - a, p - a), n) >= 0 && dot(cross(c - b, p - b), n) >= 0 &&
                      dot(cross(a - c, p - c), n) >= 0 && dot(n, n) > 0;
    if (over) return std::abs(dot(p - a, n));
    return std::min({distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
}

Surroundings::Surroundings(const WallFrame& frame, const FacadeParts& facade, double reach)
    : facade_(facade), reach_(reach) {
    const auto buckets = [](double metres) {
        return static_cast<size_t>(std::ceil((metres + 2 * kMarginMetres) / kBucketMetres)) + 1;
    };
    constexpr float kRounding = 1e-4F;
    for (const Part& part : facade.parts) {
        const auto low = [](double x) { return static_cast<float>(x) - kRounding; };
        const auto high = [](double x) { return static_cast<float>(x) + kRounding; };
        bounds_.push_back({low(part.low.u), high(part.high.u), low(part.low.v), high(part.high.v), low(part.low.w),
                           high(part.high.w)});
    }
    across_ = buckets(frame.width);
    up_ = buckets(frame.height);
    const auto each = [&](const auto& use) {
        for (uint32_t i = 0; i < facade.parts.size(); ++i) {
            const Part& part = facade.parts[i];
            if (part.kind == PartKind::kFlat || std::abs(part.normal.w) > kFront) continue;
            const size_t low = bucket_of(part.low.u - reach, part.low.v - reach);
            const size_t high = bucket_of(part.high.u + reach, part.high.v + reach);
            for (size_t row = low / across_; row <= high / across_; ++row) {
                for (size_t column = low % across_; column <= high % across_; ++column) use(row * across_ + column, i);
            }
        }
    };
    begin_.assign(across_ * up_ + 1, 0);
    each([&](size_t bucket, uint32_t) { ++begin_[bucket + 1]; });
    for (size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    entries_.resize(begin_.back());
    std::vector<uint32_t> next(begin_.begin(), begin_.end() - 1);
    each([&](size_t bucket, uint32_t part) { entries_[next[bucket]++] = part; });
}

size_t Surroundings::bucket_of(double u, double v) const {
    const auto index = [](double at, size_t count) {
        const double bucket = std::floor((at + kMarginMetres) / kBucketMetres);
        return static_cast<size_t>(std::clamp(bucket, 0.0, static_cast<double>(count - 1)));
    };
    return index(v, up_) * across_ + index(u, across_);
}

bool Surroundings::covers(const Point& p) const {
    const size_t bucket = bucket_of(p.u, p.v);
    return std::any_of(entries_.begin() + begin_[bucket], entries_.begin() + begin_[bucket + 1], [&](uint32_t i) {
        const Part& part = facade_.parts[i];
        return near_bounds(p, part, reach_) && distance_to_part(p, part) <= reach_;
    });
}

bool Surroundings::encloses(const Point& p, bool along_u, double sign) const {
    const Point direction = along_u ? Point{sign, 0, 0} : Point{0, sign, 0};
    const auto u = static_cast<float>(p.u), v = static_cast<float>(p.v), w = static_cast<float>(p.w);
    double nearest = 1e300;
    bool from_back = false;
    for (size_t i = 0; i < bounds_.size(); ++i) {
        const Bounds& box = bounds_[i];
        const bool beside = along_u ? v < box.low_v || v > box.high_v : u < box.low_u || u > box.high_u;
        if (beside || w < box.low_w || w > box.high_w) continue;
        const Part& part = facade_.parts[i];
        const double facing = dot(part.normal, direction);
        if (facing == 0) continue;
        const double t = dot(part.corner[0] - p, part.normal) / facing;
        if (t < 0 || t >= nearest) continue;
        const Point hit = p + direction * t;
        const auto& [a, b, c] = part.corner;
        const bool inside = dot(cross(b - a, hit - a), part.normal) >= 0 &&
                            dot(cross(c - b, hit - b), part.normal) >= 0 &&
                            dot(cross(a - c, hit - c), part.normal) >= 0;
        if (!inside) continue;
        nearest = t;
        from_back = facing > 0;
    }
    return from_back;
}

}  // namespace citystream::tiles::layers::relief
