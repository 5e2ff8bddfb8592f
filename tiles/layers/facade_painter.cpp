#include "tiles/layers/facade_painter.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "codec/facade/run_grid.h"

namespace citystream::tiles::layers {
namespace {

using codec::facade::RunGrid;

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
std::vector<uint32_t> cells_of_samples(uint32_t samples, const std::vector<uint32_t>& breaks) {
    std::vector<uint32_t> out(samples);
    uint32_t cell = 0;
    for (uint32_t i = 0; i < samples; ++i) {
        const double at = (i + 0.5) * breaks.back() / samples;
        while (cell + 2 < breaks.size() && at >= breaks[cell + 1]) ++cell;
        out[i] = cell;
    }
    return out;
}

uint32_t slot_of(uint32_t label) {
    return codec::facade::material_of(label) % FACADE_PALETTE_SLOTS;
}

FacadeFacts facts_of(const RunGrid& map) {
    FacadeFacts facts;
    facts.width_metres = map.width() * kMapTexelMetres;
    facts.height_metres = map.height() * kMapTexelMetres;
    const codec::facade::DepthRange depths = map.depths();
    facts.depth_min_mm = static_cast<int16_t>(depths.min_mm);
    facts.depth_max_mm = static_cast<int16_t>(depths.max_mm);
    facts.depth_metres = std::max(std::abs(depths.min_mm), std::abs(depths.max_mm)) * 0.001;
    facts.flat = flat_panels(map);
    for (const uint32_t label : map.labels) facts.slots |= 1U << slot_of(label);
    return facts;
}

/// The samples of one texel, averaged: open cells only where there is nothing else.
class TexelMean {
  public:
    void add(const std::array<float, 3>& rgb, bool open) {
        Sum& sum = open ? open_ : closed_;
        for (size_t c = 0; c < 3; ++c) sum.rgb[c] += rgb[c];
        ++sum.count;
    }
    void write(uint8_t* rgb) const {
        const Sum& sum = closed_.count > 0 ? closed_ : open_;
        for (size_t c = 0; c < 3; ++c) rgb[c] = linear_to_srgb(sum.rgb[c] / static_cast<float>(sum.count));
    }

  private:
    struct Sum {
        std::array<float, 3> rgb{};
        int count = 0;
    };
    Sum closed_, open_;
};

uint32_t texels_for(double metres, double texel) {
    return static_cast<uint32_t>(
        std::clamp(std::ceil(metres / texel - 1e-9), 1.0, static_cast<double>(kGreatestPicture)));
}

}  // namespace

double FacadeFacts::flat_loss() const {
    return std::max(depth_metres, flat.error_metres / kReliefWeight);
}

const FacadeFacts& FacadePainter::facts(uint32_t map) {
    {
        const std::lock_guard lock(mutex_);
        const auto found = facts_.find(map);
        if (found != facts_.end()) return found->second;
    }
    const FacadeFacts facts = facts_of(catalog_.facade_maps.map(map));
    const std::lock_guard lock(mutex_);
    return facts_.emplace(map, facts).first->second;
}

ChartImage FacadePainter::picture(uint32_t map, uint32_t palette, double texel) {
    const FacadeFacts& known = facts(map);
    const RunGrid grid = catalog_.facade_maps.map(map);
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
    const auto columns = cells_of_samples(out.width * kSamples, grid.x_breaks);
    const auto rows = cells_of_samples(out.height * kSamples, grid.y_breaks);
    const double step_x = known.width_metres / (out.width * kSamples),
                 step_y = known.height_metres / (out.height * kSamples);
    for (uint32_t y = 0; y < out.height; ++y) {
        for (uint32_t x = 0; x < out.width; ++x) {
            TexelMean mean;
            for (uint32_t s = 0; s < kSamples * kSamples; ++s) {
                const uint32_t sx = x * kSamples + s % kSamples, sy = y * kSamples + s / kSamples;
                const uint32_t label = grid.label(columns[sx], rows[sy]);
                mean.add(slots[slot_of(label)].at((sx + 0.5) * step_x, (sy + 0.5) * step_y),
                         codec::facade::displacement_of(label) == codec::facade::kOpenDisplacement);
            }
            mean.write(&out.rgb[3 * (size_t{y} * out.width + x)]);
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
