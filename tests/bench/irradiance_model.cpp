#include "tests/bench/irradiance_model.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>

#include "codec/radiance/transfer_product.h"

namespace citystream::bench {

using client::Direction;
using client::LightSum;
using codec::radiance::Rgb;

SampleDirections::SampleDirections(uint32_t texels_across) {
    const uint32_t side = codec::radiance::kSamplesAcross * texels_across;
    for (uint32_t s = 0; s < codec::radiance::cube_cells(side); ++s) {
        const auto d = codec::radiance::cell_direction(side, s);
        const double x = d[0], y = d[1], z = d[2], length = std::sqrt(x * x + y * y + z * z);
        direction.push_back({x / length, y / length, z / length});
        solid_angle.push_back(codec::radiance::cell_solid_angle(side, s));
        texel.push_back(codec::radiance::texel_of_sample(texels_across, s));
    }
}

std::vector<Direction> receiver_normals(const codec::radiance::VisibilityTile& tile) {
    std::vector<Direction> of_frames, normals;
    for (const uint32_t code : tile.frames) {
        const auto axis = codec::radiance::unpack_frame(code).axes[2];
        const double x = axis[0], y = axis[1], z = axis[2], length = std::sqrt(x * x + y * y + z * z);
        of_frames.push_back({x / length, y / length, z / length});
    }
    for (const uint32_t frame : tile.frame_of) normals.push_back(of_frames[frame]);
    return normals;
}

std::vector<LightSum> irradiance_of_rows(std::span<const double> cosines,
                                         std::span<const std::array<double, 3>> row_light) {
    std::vector<LightSum> result(row_light.size() / cosines.size());
    for (size_t r = 0; r < result.size(); ++r) {
        for (size_t j = 0; j < cosines.size(); ++j) {
            for (size_t c = 0; c < 3; ++c) result[r][c] += cosines[j] * row_light[r * cosines.size() + j][c];
        }
    }
    return result;
}

IrradianceModel exact_irradiance(const RadianceSample& sample) {
    const auto directions = std::make_shared<const SampleDirections>(sample.visibility.side);
    const auto& tile = sample.visibility;
    return {"exact", 0, [&tile, directions](std::span<const Rgb> radiance) {
                const auto normals = receiver_normals(tile);
                std::vector<LightSum> result(tile.receivers());
                for (uint32_t r = 0; r < tile.receivers(); ++r) {
                    const auto words = tile.of(r);
                    for (uint32_t w = 0; w < words.size(); ++w) {
                        for (uint32_t bits = words[w]; bits != 0; bits &= bits - 1) {
                            const uint32_t s = 32 * w + static_cast<uint32_t>(std::countr_zero(bits));
                            const double cosine = std::max(0.0, client::dot(normals[r], directions->direction[s]));
                            const Rgb& light = radiance[directions->texel[s]];
                            for (size_t c = 0; c < 3; ++c)
                                result[r][c] += cosine * directions->solid_angle[s] * light[c];
                        }
                    }
                }
                return result;
            }};
}

}  // namespace citystream::bench
