#include "tests/bench/irradiance_model.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>

#include "codec/radiance/source_light.h"

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

std::vector<LightSum> irradiance_by_vectors(std::span<const Direction> normals, std::span<const Rgb> radiance,
                                            uint32_t texels_across, const RowProduct& product) {
    const std::vector<Rgb> weighted = codec::radiance::weighted_light(radiance, texels_across);
    const auto directions = codec::radiance::texel_directions(texels_across);
    std::vector<LightSum> result(normals.size());
    std::vector<std::array<double, 3>> light(weighted.size());
    for (size_t axis = 0; axis < 3; ++axis) {
        for (size_t k = 0; k < light.size(); ++k) {
            for (size_t c = 0; c < 3; ++c) light[k][c] = weighted[k][c] * directions[k][axis];
        }
        const auto rows = product(light);
        const size_t rows_a_receiver = rows.size() / normals.size();
        for (size_t j = 0; j < rows.size(); ++j) {
            for (size_t c = 0; c < 3; ++c)
                result[j / rows_a_receiver][c] += normals[j / rows_a_receiver][axis] * rows[j][c];
        }
    }
    for (LightSum& sum : result) {
        for (double& channel : sum) channel = std::max(0.0, channel);
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
