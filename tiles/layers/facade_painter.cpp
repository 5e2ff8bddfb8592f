#include "tiles/layers/facade_painter.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "codec/facade/facade_map.h"

namespace citystream::tiles::layers {
namespace {

using codec::facade::FacadeMapView;

constexpr double kMapTexelMetres = 0.01;
constexpr double kMeanTexelMetres = 0.5;
constexpr uint32_t kGreatestPicture = 2048;
constexpr uint32_t kSamples = 2;  // a texel and axis

/// What a material slot shows at a point of the wall.
struct SlotSampler {
    std::array<float, 3> flat{};
    std::shared_ptr<const ChartImage> image;
    double metres_per_repeat = 1;

    std::array<float, 3> at(double x, double y) const {
        if (!image) return flat;
        const auto wrap = [&](double metres, uint32_t size) {
            const double repeats = metres / metres_per_repeat;
            const auto texel = static_cast<int64_t>(std::floor((repeats - std::floor(repeats)) * size));
            return static_cast<size_t>(std::clamp<int64_t>(texel, 0, int64_t{size} - 1));
        };
        const uint8_t* rgb = image->rgb.data() + 3 * (wrap(y, image->height) * image->width + wrap(x, image->width));
        return {srgb_to_linear(rgb[0]), srgb_to_linear(rgb[1]), srgb_to_linear(rgb[2])};
    }
};

SlotSampler make_sampler(const city::CityCatalog& catalog, ImageCache& images, uint32_t material,
                         double sample_metres) {
    SlotSampler sampler;
    const city::Material& m = catalog.materials[material];
    const auto mean = images.mean_colour(material);
    for (size_t c = 0; c < 3; ++c) sampler.flat[c] = srgb_to_linear(mean[c]);
    if (m.image < 0) return sampler;
    sampler.metres_per_repeat = m.metres_per_repeat > 0 ? static_cast<double>(m.metres_per_repeat) : 1.0;
    const auto whole = images.mip(static_cast<uint32_t>(m.image), 0);
    if (!whole) return sampler;
    const uint32_t texels = std::max(whole->width, whole->height);
    uint32_t level = 0;
    while ((texels >> level) > 1 && sampler.metres_per_repeat / (texels >> level) < sample_metres) ++level;
    sampler.image = images.mip(static_cast<uint32_t>(m.image), level);
    return sampler;
}

/// For each sample along an axis the cell it falls in; `breaks` in map texels.
template <typename Break>
std::vector<uint32_t> cells_of_samples(uint32_t samples, uint32_t size, uint32_t cells, const Break& break_at) {
    std::vector<uint32_t> out(samples);
    uint32_t cell = 0;
    for (uint32_t i = 0; i < samples; ++i) {
        const double at = (i + 0.5) * size / samples;
        while (cell + 1 < cells && at >= break_at(cell + 1)) ++cell;
        out[i] = cell;
    }
    return out;
}

uint32_t texels_for(double metres, double texel) {
    return static_cast<uint32_t>(
        std::clamp(std::ceil(metres / texel - 1e-9), 1.0, static_cast<double>(kGreatestPicture)));
}

}  // namespace

const FacadeFacts& FacadePainter::facts(uint32_t map) {
    {
        const std::lock_guard lock(mutex_);
        const auto found = facts_.find(map);
        if (found != facts_.end()) return found->second;
    }
    FacadeFacts facts;
    const auto view = FacadeMapView::create(catalog_.facade_maps[map]);
    if (view) {
        facts.valid = true;
        facts.width_metres = view->width() * kMapTexelMetres;
        facts.height_metres = view->height() * kMapTexelMetres;
        facts.depth_min_mm = static_cast<int16_t>(view->depth_min_mm());
        facts.depth_max_mm = static_cast<int16_t>(view->depth_max_mm());
        facts.depth_metres = std::max(std::abs(view->depth_min_mm()), std::abs(view->depth_max_mm())) * 0.001;
        for (uint32_t row = 0; row < view->rows(); ++row) {
            for (uint32_t column = 0; column < view->columns(); ++column)
                facts.slots |= 1U << ((view->label(column, row) >> 16) & 15U);
        }
    }
    const std::lock_guard lock(mutex_);
    return facts_.emplace(map, facts).first->second;
}

ChartImage FacadePainter::picture(uint32_t map, uint32_t palette, double texel) {
    const FacadeFacts& known = facts(map);
    const auto view = FacadeMapView::create(catalog_.facade_maps[map]);
    ChartImage out;
    out.width = texels_for(known.width_metres, texel);
    out.height = texels_for(known.height_metres, texel);
    out.metres_per_texel =
        static_cast<float>(std::max(known.width_metres / out.width, known.height_metres / out.height));
    out.rgb.resize(size_t{3} * out.width * out.height);
    std::array<SlotSampler, FACADE_PALETTE_SLOTS> slots;
    for (uint32_t slot = 0; slot < slots.size(); ++slot) {
        if ((known.slots >> slot) & 1U)
            slots[slot] = make_sampler(catalog_, images_, catalog_.palettes[palette].material[slot], texel / kSamples);
    }
    const auto columns = cells_of_samples(out.width * kSamples, view->width(), view->columns(),
                                          [&](uint32_t i) { return view->x_break(i); });
    const auto rows = cells_of_samples(out.height * kSamples, view->height(), view->rows(),
                                       [&](uint32_t i) { return view->y_break(i); });
    const double step_x = known.width_metres / (out.width * kSamples),
                 step_y = known.height_metres / (out.height * kSamples);
    for (uint32_t y = 0; y < out.height; ++y) {
        for (uint32_t x = 0; x < out.width; ++x) {
            std::array<float, 3> sum{};
            for (uint32_t s = 0; s < kSamples * kSamples; ++s) {
                const uint32_t sx = x * kSamples + s % kSamples, sy = y * kSamples + s / kSamples;
                const uint32_t slot = (view->label(columns[sx], rows[sy]) >> 16) & 15U;
                const auto rgb = slots[slot].at((sx + 0.5) * step_x, (sy + 0.5) * step_y);
                for (size_t c = 0; c < 3; ++c) sum[c] += rgb[c];
            }
            for (size_t c = 0; c < 3; ++c) {
                out.rgb[3 * (size_t{y} * out.width + x) + c] =
                    linear_to_srgb(sum[c] / static_cast<float>(kSamples * kSamples));
            }
        }
    }
    return out;
}

std::array<uint8_t, 3> FacadePainter::mean_colour(uint32_t map, uint32_t palette) {
    const uint64_t key = uint64_t{map} << 32 | palette;
    {
        const std::lock_guard lock(mutex_);
        const auto found = means_.find(key);
        if (found != means_.end()) return found->second;
    }
    const auto mean = mean_of(picture(map, palette, kMeanTexelMetres));
    const std::lock_guard lock(mutex_);
    return means_[key] = mean;
}

}  // namespace citystream::tiles::layers
