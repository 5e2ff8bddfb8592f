#include "tiles/layers/preview.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

namespace citystream::tiles::layers {
namespace {

using quadtree::BuildObject;
using quadtree::PaintKind;

constexpr std::array<double, 3> kSun = {-0.48, 0.36, 0.8};

std::array<uint8_t, 3> shade(const std::array<uint8_t, 3>& rgb, const std::array<double, 3>& n) {
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    const double light =
        length > 0 ? 0.45 + 0.6 * std::max(0.0, (n[0] * kSun[0] + n[1] * kSun[1] + n[2] * kSun[2]) / length) : 1;
    std::array<uint8_t, 3> out{};
    for (size_t c = 0; c < 3; ++c) out[c] = static_cast<uint8_t>(std::clamp(std::lround(rgb[c] * light), 0L, 255L));
    return out;
}

}  // namespace

Preview::Preview(const quadtree::GridBox& extent, ImageCache& images) : corner_(extent.lo), images_(images) {
    const auto wide = static_cast<double>(std::max<int64_t>(extent.hi.x - extent.lo.x, 1));
    const auto high = static_cast<double>(std::max<int64_t>(extent.hi.y - extent.lo.y, 1));
    pixels_per_unit_ = kSize / std::max(wide, high);
    width_ = static_cast<uint32_t>(std::clamp(std::ceil(wide * pixels_per_unit_), 1.0, double{kSize}));
    height_ = static_cast<uint32_t>(std::clamp(std::ceil(high * pixels_per_unit_), 1.0, double{kSize}));
    pixels_.resize(size_t{width_} * height_);
}

void Preview::draw(const std::vector<BuildObject>& objects) {
    for (const BuildObject& object : objects) {
        std::vector<std::array<uint8_t, 3>> colours;
        for (const quadtree::Paint& paint : object.paints) {
            colours.push_back(paint.kind == PaintKind::kMaterial ? images_.mean_colour(paint.a) : paint.rgb());
        }
        const std::lock_guard lock(mutex_);
        for (const quadtree::BuildTriangle& triangle : object.triangles) {
            const std::array<GridPoint, 3> corners = {object.vertices[triangle.vertex[0]],
                                                      object.vertices[triangle.vertex[1]],
                                                      object.vertices[triangle.vertex[2]]};
            const auto normal = quadtree::triangle_normal(corners[0], corners[1], corners[2]);
            if (normal[2] > 0) draw_triangle(corners, shade(colours[triangle.paint], normal));
        }
    }
}

void Preview::draw_triangle(const std::array<GridPoint, 3>& corners, const std::array<uint8_t, 3>& rgb) {
    std::array<std::array<double, 2>, 3> p{};
    for (size_t k = 0; k < 3; ++k) {
        p[k] = {static_cast<double>(corners[k].x - corner_.x) * pixels_per_unit_,
                static_cast<double>(corners[k].y - corner_.y) * pixels_per_unit_};
    }
    const auto range = [&](size_t axis, uint32_t size) {
        const auto [low, high] = std::minmax({p[0][axis], p[1][axis], p[2][axis]});
        return std::array<int64_t, 2>{std::max<int64_t>(0, std::llround(low)),
                                      std::min<int64_t>(size, std::llround(high))};
    };
    const auto xs = range(0, width_), ys = range(1, height_);
    const int64_t z = std::max({corners[0].z, corners[1].z, corners[2].z});
    for (int64_t y = ys[0]; y < ys[1]; ++y) {
        for (int64_t x = xs[0]; x < xs[1]; ++x) {
            const double px = static_cast<double>(x) + 0.5, py = static_cast<double>(y) + 0.5;
            bool inside = true;
            for (size_t k = 0; k < 3 && inside; ++k) {
                const auto& a = p[k];
                const auto& b = p[(k + 1) % 3];
                inside = (b[0] - a[0]) * (py - a[1]) - (b[1] - a[1]) * (px - a[0]) >= 0;
            }
            if (!inside) continue;
            Pixel& pixel = pixels_[static_cast<size_t>(y) * width_ + static_cast<size_t>(x)];
            if (z > pixel.z || (z == pixel.z && rgb > pixel.rgb)) pixel = {z, rgb};
        }
    }
}

std::vector<std::byte> Preview::encode(const std::string& scratch_path) const {
    std::vector<uint8_t> rgb(size_t{3} * width_ * height_);
    for (uint32_t y = 0; y < height_; ++y) {
        for (uint32_t x = 0; x < width_; ++x) {
            const Pixel& pixel = pixels_[size_t{height_ - 1 - y} * width_ + x];
            std::copy(pixel.rgb.begin(), pixel.rgb.end(),
                      rgb.begin() + static_cast<ptrdiff_t>(3 * (size_t{y} * width_ + x)));
        }
    }
    auto output = OIIO::ImageOutput::create(scratch_path);
    OIIO::ImageSpec spec(static_cast<int>(width_), static_cast<int>(height_), 3, OIIO::TypeDesc::UINT8);
    if (!output || !output->open(scratch_path, spec) || !output->write_image(OIIO::TypeDesc::UINT8, rgb.data()) ||
        !output->close())
        return {};
    std::ifstream file(scratch_path, std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    std::vector<std::byte> bytes(text.size());
    std::transform(text.begin(), text.end(), bytes.begin(), [](char c) { return static_cast<std::byte>(c); });
    return bytes;
}

}  // namespace citystream::tiles::layers
