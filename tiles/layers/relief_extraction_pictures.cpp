#include "tiles/layers/relief_extraction_pictures.h"

#include <algorithm>
#include <cmath>

#include "tiles/layers/image_cache.h"

namespace citystream::tiles::layers::relief {
namespace {

constexpr uint32_t kSmallSide = 128;
constexpr int kSamplesAcross = 4;                 // of a triangle
constexpr double kWideArea = 0.25, kWide = 0.12;  // square metres; metres: twice the area over the outline
constexpr double kOneColour = 10;                 // of 255: greatest deviation that a wide surface may lose
constexpr int kColourStep = 6;

/// Sums over samples of one surface.
struct Mean {
    double weight = 0;
    std::array<double, 3> linear{}, shown{}, squares{};

    void add(const std::array<float, 3>& colour, double w) {
        weight += w;
        for (size_t k = 0; k < 3; ++k) {
            // The square root stands for the display's curve: it is near it and fast.
            const double value = static_cast<double>(colour[k]), level = 255 * std::sqrt(value);
            linear[k] += w * value;
            shown[k] += w * level;
            squares[k] += w * level * level;
        }
    }
    void add(const Mean& o) {
        weight += o.weight;
        for (size_t k = 0; k < 3; ++k) {
            linear[k] += o.linear[k];
            shown[k] += o.shown[k];
            squares[k] += o.squares[k];
        }
    }
    double deviation() const {
        double variance = 0;
        for (size_t k = 0; k < 3; ++k) variance += squares[k] / weight - std::pow(shown[k] / weight, 2);
        return std::sqrt(std::max(0.0, variance / 3));
    }
    std::array<uint8_t, 3> colour() const {
        std::array<uint8_t, 3> rgb{};
        for (size_t k = 0; k < 3; ++k) {
            const int level = linear_to_srgb(static_cast<float>(linear[k] / weight));
            rgb[k] = static_cast<uint8_t>(std::min(255, (level + kColourStep / 2) / kColourStep * kColourStep));
        }
        return rgb;
    }
};

Mean mean_of_part(const city::Triangle& triangle, const Part& part, Pictures& pictures) {
    Mean mean;
    const auto& [a, b, c] = triangle.texcoord;
    for (int i = 0; i < kSamplesAcross; ++i) {
        for (int k = 0; i + k < kSamplesAcross; ++k) {
            const double s = (i + 1.0 / 3) / kSamplesAcross, t = (k + 1.0 / 3) / kSamplesAcross;
            mean.add(pictures.at(part.material,
                                 {a.x + s * (b.x - a.x) + t * (c.x - a.x), a.y + s * (b.y - a.y) + t * (c.y - a.y)}),
                     std::max(part.area, 1e-9));
        }
    }
    return mean;
}

/// Half of a wide rectangle, as far as one triangle tells.
bool is_wide(const Part& part) {
    const auto& [a, b, c] = part.corner;
    const double longest = std::max({length(b - a), length(c - b), length(a - c)});
    return 2 * part.area > kWideArea && 2 * part.area > kWide * longest;
}

}  // namespace

const Pictures::Small& Pictures::small(uint32_t image) {
    const auto [found, is_new] = known_.try_emplace(image);
    Small& small = found->second;
    if (!is_new) return small;
    const city::ImageSource& source = catalog_.images[image];
    ChartImage whole;
    if (const auto drawn = source.drawn()) {
        whole.width = drawn->width;
        whole.height = drawn->height;
        whole.rgb = drawn->rgb;
    } else if (auto decoded = decode_image(source.path)) {
        whole = std::move(decoded).value();
    }
    if (whole.width == 0 || whole.height == 0) return small;
    small.width = std::min(whole.width, kSmallSide);
    small.height = std::min(whole.height, kSmallSide);
    small.texels.resize(size_t{small.width} * small.height);
    std::vector<uint32_t> count(small.texels.size(), 0);
    for (uint32_t y = 0; y < whole.height; ++y) {
        for (uint32_t x = 0; x < whole.width; ++x) {
            const size_t into =
                uint64_t{y} * small.height / whole.height * small.width + uint64_t{x} * small.width / whole.width;
            const size_t from = (size_t{y} * whole.width + x) * 3;
            for (size_t k = 0; k < 3; ++k) small.texels[into][k] += srgb_to_linear(whole.rgb[from + k]);
            ++count[into];
        }
    }
    for (size_t i = 0; i < count.size(); ++i) {
        for (float& channel : small.texels[i]) channel /= static_cast<float>(std::max(1U, count[i]));
    }
    return small;
}

std::array<float, 3> Pictures::at(uint32_t material, const city::Vec2& texcoord) {
    const city::Material& m = catalog_.materials[material];
    static const Small kNoImage;
    const Small& image = m.image < 0 ? kNoImage : small(static_cast<uint32_t>(m.image));
    if (image.width == 0) return {srgb_to_linear(m.rgb[0]), srgb_to_linear(m.rgb[1]), srgb_to_linear(m.rgb[2])};
    const auto texel = [&](double t, uint32_t size) {
        const double inside = m.repeat ? t - std::floor(t) : std::clamp(t, 0.0, 1.0);
        return std::min(size - 1, static_cast<uint32_t>(inside * size));
    };
    return image.texels[size_t{texel(texcoord.y, image.height)} * image.width + texel(texcoord.x, image.width)];
}

uint32_t Pictures::flat(const std::array<uint8_t, 3>& rgb, city::CityCatalog& catalog) {
    const auto [found, is_new] = flats_.try_emplace(rgb, 0);
    if (is_new) found->second = catalog.add_material({.rgb = rgb});
    return found->second;
}

void flatten_pictures(const city::CityObject& object, FacadeParts& facade, Pictures& pictures,
                      city::CityCatalog& catalog) {
    std::vector<double> around(facade.patches.size(), 0);
    for (const OutlineEdge& edge : outlines(facade)) around[edge.patch] += length(edge.to - edge.from);
    std::vector<Mean> patches(facade.patches.size());
    std::vector<std::array<uint8_t, 3>> colours(facade.parts.size());
    const auto has_image = [&](const Part& part) {
        return part.kind != PartKind::kSpeck && catalog.materials[part.material].image >= 0;
    };
    for (size_t i = 0; i < facade.parts.size(); ++i) {
        const Part& part = facade.parts[i];
        if (!has_image(part)) continue;
        const Mean mean = mean_of_part(object.triangles[part.triangle], part, pictures);
        colours[i] = mean.colour();
        if (part.patch != kNone) {
            patches[part.patch].add(mean);
        } else {
            facade.parts[i].patterned = is_wide(part) && mean.deviation() > kOneColour;
        }
    }
    for (size_t i = 0; i < facade.patches.size(); ++i) {
        Patch& patch = facade.patches[i];
        const bool wide = patch.area > kWideArea && 2 * patch.area > kWide * around[i];
        patch.kept = patches[i].weight > 0 && wide && patches[i].deviation() > kOneColour;
    }
    for (size_t i = 0; i < facade.parts.size(); ++i) {
        Part& part = facade.parts[i];
        if (!has_image(part)) continue;
        part.look = pictures.flat(part.patch != kNone ? patches[part.patch].colour() : colours[i], catalog);
    }
}

}  // namespace citystream::tiles::layers::relief
