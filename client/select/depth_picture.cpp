#include "client/select/depth_picture.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "codec/vector.h"

namespace citystream::client {
namespace {

using codec::dot;

constexpr size_t kMostCorners = 16;
// Of a box's nearness: what lies at the same depth as a wall is not hidden by it.
constexpr double kBehind = 1 + 1e-4;

/// out[i] = the least of rows[i - radius .. i + radius]. The frame's edge is no edge of a surface: what is outside of
/// it is not asked for.
void least_along_row(const float* row, uint32_t width, uint32_t radius, float* out) {
    std::copy_n(row, width, out);
    for (uint32_t shift = 1; shift <= radius && shift < width; ++shift) {
        for (uint32_t x = 0; x + shift < width; ++x) out[x] = std::min(out[x], row[x + shift]);
        for (uint32_t x = shift; x < width; ++x) out[x] = std::min(out[x], row[x - shift]);
    }
}

void least_of(const float* row, uint32_t width, float* out) {
    for (uint32_t x = 0; x < width; ++x) out[x] = std::min(out[x], row[x]);
}

}  // namespace

void DepthPicture::begin(const Camera& camera, uint32_t margin) {
    assert(margin >= 1 && margin <= 8);
    camera_ = camera;
    margin_ = margin;
    scale_ = camera.height / (2 * std::tan(camera.fov_y / 2));
    nearness_.assign(size_t{camera.width} * camera.height, 0);
    least_.clear();
    blocks_across_ = (camera.width + kBlock - 1) / kBlock;
    blocks_down_ = (camera.height + kBlock - 1) / kBlock;
}

std::array<double, 3> DepthPicture::view_of(const std::array<double, 3>& point) const {
    const std::array<double, 3> d = {point[0] - camera_.position[0], point[1] - camera_.position[1],
                                     point[2] - camera_.position[2]};
    return {dot(d, camera_.right), dot(d, camera_.up), dot(d, camera_.forward)};
}

DepthPicture::Projected DepthPicture::project(const std::array<double, 3>& view) const {
    const double nearness = 1 / view[2];
    return {camera_.width * 0.5 + view[0] * nearness * scale_, camera_.height * 0.5 - view[1] * nearness * scale_,
            nearness};
}

void DepthPicture::add(std::span<const std::array<double, 3>> corners) {
    assert(corners.size() >= 3 && corners.size() <= kMostCorners);
    std::array<Projected, 2 * kMostCorners> polygon;
    size_t count = 0;
    std::array<double, 3> before = view_of(corners.back());
    for (const auto& corner : corners) {
        const std::array<double, 3> view = view_of(corner);
        const bool was_in_front = before[2] >= camera_.near_plane, is_in_front = view[2] >= camera_.near_plane;
        if (was_in_front != is_in_front) {
            const double t = (camera_.near_plane - before[2]) / (view[2] - before[2]);
            polygon[count++] = project(
                {before[0] + t * (view[0] - before[0]), before[1] + t * (view[1] - before[1]), camera_.near_plane});
        }
        if (is_in_front) polygon[count++] = project(view);
        before = view;
    }
    if (count >= 3) fill({polygon.data(), count});
}

/// Nearness is linear over the frame: at (x, y) it is that of the first corner plus two slopes.
void DepthPicture::fill(std::span<const Projected> polygon) {
    double along_x = 0, along_y = 0, twice_area = 0, area_x = 0, area_y = 0;
    double top = std::numeric_limits<double>::infinity(), bottom = -top;
    const Projected& first = polygon[0];
    for (size_t i = 0; i < polygon.size(); ++i) {
        top = std::min(top, polygon[i].y);
        bottom = std::max(bottom, polygon[i].y);
        if (i + 1 >= polygon.size() || i == 0) continue;
        // Slopes from the triangle of the fan that covers most.
        const double ax = polygon[i].x - first.x, ay = polygon[i].y - first.y,
                     an = polygon[i].nearness - first.nearness;
        const double bx = polygon[i + 1].x - first.x, by = polygon[i + 1].y - first.y;
        const double bn = polygon[i + 1].nearness - first.nearness;
        const double area = ax * by - ay * bx;
        if (std::abs(area) <= std::abs(twice_area)) continue;
        twice_area = area;
        area_x = an * by - bn * ay;
        area_y = ax * bn - bx * an;
    }
    if (!(std::abs(twice_area) > 1e-9)) return;  // seen edge on
    along_x = area_x / twice_area;
    along_y = area_y / twice_area;
    const auto row_of = [&](double y) {
        return std::clamp(std::ceil(y - 0.5), 0.0, static_cast<double>(camera_.height));
    };
    const auto column_of = [&](double x) {
        return std::clamp(std::ceil(x - 0.5), 0.0, static_cast<double>(camera_.width));
    };
    for (auto row = static_cast<uint32_t>(row_of(top)), end = static_cast<uint32_t>(row_of(bottom)); row < end; ++row) {
        const double y = row + 0.5;
        double left = std::numeric_limits<double>::infinity(), right = -left;
        for (size_t i = 0; i < polygon.size(); ++i) {
            const Projected& a = polygon[i];
            const Projected& b = polygon[(i + 1) % polygon.size()];
            if ((a.y <= y) == (b.y <= y)) continue;
            const double x = a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x);
            left = std::min(left, x);
            right = std::max(right, x);
        }
        const auto begin = static_cast<uint32_t>(column_of(left)), stop = static_cast<uint32_t>(column_of(right));
        float* values = &nearness_[size_t{row} * camera_.width];
        const auto start =
            static_cast<float>(first.nearness + (begin + 0.5 - first.x) * along_x + (y - first.y) * along_y);
        const auto step = static_cast<float>(along_x);
        for (uint32_t x = begin; x < stop; ++x)
            values[x] = std::max(values[x], start + static_cast<float>(x - begin) * step);
    }
}

void DepthPicture::finish() {
    const uint32_t width = camera_.width, height = camera_.height;
    std::vector<float> along(nearness_.size());
    for (uint32_t y = 0; y < height; ++y)
        least_along_row(&nearness_[size_t{y} * width], width, margin_, &along[size_t{y} * width]);
    least_ = along;
    for (uint32_t y = 0; y < height; ++y) {
        float* out = &least_[size_t{y} * width];
        for (uint32_t k = y < margin_ ? 0 : y - margin_; k <= std::min(height - 1, y + margin_); ++k)
            least_of(&along[size_t{k} * width], width, out);
    }
    blocks_.assign(size_t{blocks_across_} * blocks_down_, std::numeric_limits<float>::infinity());
    for (uint32_t y = 0; y < height; ++y) {
        float* blocks = &blocks_[size_t{y / kBlock} * blocks_across_];
        const float* row = &least_[size_t{y} * width];
        for (uint32_t x = 0; x < width; ++x) blocks[x / kBlock] = std::min(blocks[x / kBlock], row[x]);
    }
}

bool DepthPicture::hides(const tiles::tileset::Bounds& bounds, const std::array<double, 2>& origin) const {
    if (least_.empty()) return false;
    double left = std::numeric_limits<double>::infinity(), top = left, right = -left, bottom = -left, nearest = 0;
    for (uint32_t corner = 0; corner < 8; ++corner) {
        const auto side = [&](uint32_t axis) {
            return (corner >> axis & 1) != 0 ? bounds.max[axis] : bounds.min[axis];
        };
        const auto view = view_of({side(0) + origin[0], side(1) + origin[1], side(2)});
        if (view[2] < camera_.near_plane) return false;
        const Projected point = project(view);
        left = std::min(left, point.x);
        right = std::max(right, point.x);
        top = std::min(top, point.y);
        bottom = std::max(bottom, point.y);
        nearest = std::max(nearest, point.nearness);
    }
    // Samples at whole numbers and a half that lie in the rectangle, and one more on every side.
    const auto low = [](double v, uint32_t size) {
        return static_cast<uint32_t>(std::clamp(std::floor(v - 1), 0.0, static_cast<double>(size)));
    };
    const auto high = [](double v, uint32_t size) {
        return static_cast<uint32_t>(std::clamp(std::ceil(v + 1), 0.0, static_cast<double>(size)));
    };
    return all_nearer(low(left, camera_.width), low(top, camera_.height), high(right, camera_.width),
                      high(bottom, camera_.height), static_cast<float>(nearest * kBehind));
}

/// Samples x0..x1 - 1, y0..y1 - 1: whole blocks by their least, the rest one by one.
bool DepthPicture::all_nearer(uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1, float nearness) const {
    for (uint32_t by = y0 / kBlock; by * kBlock < y1; ++by) {
        for (uint32_t bx = x0 / kBlock; bx * kBlock < x1; ++bx) {
            if (blocks_[size_t{by} * blocks_across_ + bx] > nearness) continue;
            const uint32_t end_y = std::min(y1, (by + 1) * kBlock), end_x = std::min(x1, (bx + 1) * kBlock);
            for (uint32_t y = std::max(y0, by * kBlock); y < end_y; ++y) {
                for (uint32_t x = std::max(x0, bx * kBlock); x < end_x; ++x) {
                    if (!(least_[size_t{y} * camera_.width + x] > nearness)) return false;
                }
            }
        }
    }
    return true;
}

double DepthPicture::covered() const {
    const auto count = std::count_if(nearness_.begin(), nearness_.end(), [](float v) { return v > 0; });
    return nearness_.empty() ? 0 : static_cast<double>(count) / static_cast<double>(nearness_.size());
}

}  // namespace citystream::client
