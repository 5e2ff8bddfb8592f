#include "tests/bench/radiance_quality.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <functional>

#include "client/light/environment_file.h"
#include "client/light/source_cube.h"
#include "client/light/sun_split.h"
#include "codec/radiance/bicluster.h"
#include "codec/radiance/bicluster_wire.h"
#include "codec/radiance/transfer_product.h"
#include "codec/radiance/visibility_wire.h"
#include "tests/bench/clustered_components.h"
#include "tests/bench/haar_rows.h"
#include "tests/bench/harmonic_transfer.h"
#include "tests/bench/irradiance_model.h"
#include "tests/bench/plain_shading.h"

namespace citystream::bench {

namespace {

using namespace codec::radiance;
using client::LightSum;
using Exact = Channels<double>;
using Maker = std::function<IrradianceModel(const RadianceSample&)>;

constexpr const char* kAreaLight = "area_light";
constexpr const char* kLayer = "layer-3";
constexpr double kAsNear = 1 + 1e-6;  ///< the same sum in another order
constexpr const char* kNotReached = "equal error, not reached";
constexpr double kLightRadius = 12 * 3.14159265358979323846 / 180;
constexpr float kLightRadiance = 200;

/// By a product whose rows are in quarters.
template <typename Product>
std::vector<LightSum> irradiance_in_quarters(std::span<const client::Direction> normals, std::span<const Rgb> radiance,
                                             uint32_t texels_across, const Product& product) {
    return irradiance_by_vectors(normals, radiance, texels_across, [&](std::span<const Exact> light) {
        std::vector<Exact> rows = product(light);
        for (Exact& row : rows) {
            for (double& channel : row) channel *= kQuarter;
        }
        return rows;
    });
}

/// The first steps on the wire, and the matrix that they make.
IrradianceModel layer_steps(const RadianceSample& sample, uint32_t local_side, uint32_t count) {
    const LocalDirections local(local_side);
    const std::vector<VisibilityStep> steps = encode_visibility(sample.visibility);
    IrradianceModel model{"layer-" + std::to_string(count), 0, {}};
    std::vector<std::span<const std::byte>> wire;
    for (uint32_t i = 0; i < count; ++i) {
        wire.emplace_back(steps[i].bytes);
        model.bytes += steps[i].bytes.size();
    }
    const VisibilityTile& whole = sample.visibility;
    const auto tile = decode_visibility({whole.side, whole.frames, whole.frame_of, {}}, wire,
                                        {.receivers = kMostReceivers, .entries = ~uint64_t{0}});
    const Transfer transfer = make_transfer(tile ? *tile : VisibilityTile{whole.side, {}, {}, {}}, local);
    model.irradiance = [transfer, side = whole.side, normals = receiver_normals(whole)](std::span<const Rgb> radiance) {
        return irradiance_in_quarters(normals, radiance, side, [&](std::span<const Exact> light) {
            return product_by_entries<double>(transfer, light);
        });
    };
    return model;
}

IrradianceModel lossy_biclusters(const RadianceSample& sample, uint32_t local_side, uint32_t row_budget) {
    const LocalDirections local(local_side);
    BiclusterOptions options;
    options.seeding = Seeding::kRow;  // fewer bytes
    options.row_budget = row_budget;
    const Biclusters clusters = find_biclusters(make_transfer(sample.visibility, local), options);
    return {"bicluster-" + std::to_string(row_budget), encode_biclusters(clusters, local.count()).size(),
            [clusters, side = sample.visibility.side,
             normals = receiver_normals(sample.visibility)](std::span<const Rgb> radiance) {
                return irradiance_in_quarters(normals, radiance, side, [&](std::span<const Exact> light) {
                    return product_by_clusters<double>(clusters, light);
                });
            }};
}

/// All steps on the wire, added up sample by sample.
IrradianceModel brute_force(const RadianceSample& sample) {
    IrradianceModel model = exact_irradiance(sample);
    model.name = "bits";
    for (const VisibilityStep& step : encode_visibility(sample.visibility)) model.bytes += step.bytes.size();
    return model;
}

/// Of one row a receiver.
Maker one_row(const std::function<IrradianceModel(const RadianceSample&, uint32_t local_side)>& make) {
    return [make](const RadianceSample& sample) {
        IrradianceModel model = make(sample, 1);
        model.name += "-one-row";
        return model;
    };
}

void add_one_row_makers(std::vector<Maker>& all, uint32_t texels_across) {
    for (const auto& [clusters, vectors] : {std::pair{1U, 4U}, {4U, 4U}, {8U, 8U}, {32U, 8U}})
        all.push_back(one_row([c = clusters, v = vectors](const RadianceSample& s, uint32_t local_side) {
            return clustered_components(s, local_side, c, v);
        }));
    if (!std::has_single_bit(texels_across)) return;
    for (const uint32_t terms : {4U, 8U, 12U, 16U, 32U, 64U, 128U})
        all.push_back(
            one_row([terms](const RadianceSample& s, uint32_t local_side) { return haar_rows(s, local_side, terms); }));
}

std::vector<Maker> makers(uint32_t local_side, uint32_t texels_across) {
    std::vector<Maker> all = {brute_force};
    for (const uint32_t steps : {1U, 2U, 3U})
        all.emplace_back([=](const RadianceSample& s) { return layer_steps(s, local_side, steps); });
    for (const uint32_t budget : {0U, 16U, 64U})
        all.emplace_back([=](const RadianceSample& s) { return lossy_biclusters(s, local_side, budget); });
    for (const uint32_t bands : {2U, 3U, 5U})
        all.emplace_back([=](const RadianceSample& s) { return harmonic_transfer(s, bands); });
    for (const auto& [clusters, vectors] : {std::pair{4U, 1U}, {8U, 2U}, {16U, 4U}, {32U, 8U}})
        all.emplace_back([=, c = clusters, v = vectors](const RadianceSample& s) {
            return clustered_components(s, local_side, c, v);
        });
    if (std::has_single_bit(texels_across)) {
        for (const uint32_t terms : {1U, 2U, 4U, 12U, 24U})
            all.emplace_back([=](const RadianceSample& s) { return haar_rows(s, local_side, terms); });
    }
    add_one_row_makers(all, texels_across);
    all.emplace_back(bent_normals);
    all.emplace_back(shadow_map_only);
    all.emplace_back(ambient_light);
    return all;
}

/// Sums of squares over all samples.
struct ErrorSum {
    double squares = 0, truth = 0;

    void add(std::span<const LightSum> made, std::span<const LightSum> exact) {
        for (size_t r = 0; r < exact.size(); ++r) {
            for (size_t c = 0; c < 3; ++c) {
                squares += (made[r][c] - exact[r][c]) * (made[r][c] - exact[r][c]);
                truth += exact[r][c] * exact[r][c];
            }
        }
    }
};

/// The name up to its numbers.
std::string family_of(const std::string& name) {
    return name.substr(0, name.find_first_of("-0123456789"));
}

void add_comparisons(std::vector<QualityLine>& lines) {
    const auto layer =
        std::find_if(lines.begin(), lines.end(), [](const QualityLine& line) { return line.representation == kLayer; });
    const uint64_t bytes = layer->bytes;
    const double error = layer->error(kAreaLight);
    std::vector<QualityLine> compared;
    for (const char* family : {"bits", "layer", "bicluster", "sh", "cpca", "haar", "occlusion", "shadow"}) {
        const QualityLine *at_bytes = nullptr, *at_error = nullptr, *nearest = nullptr;
        for (const QualityLine& line : lines) {
            if (family_of(line.representation) != family) continue;
            const auto is_nearer = [&line](const QualityLine* other) {
                return other == nullptr || line.error(kAreaLight) < other->error(kAreaLight);
            };
            if (is_nearer(nearest)) nearest = &line;
            if (line.bytes <= bytes && is_nearer(at_bytes)) at_bytes = &line;
            const bool smaller = at_error == nullptr || line.bytes < at_error->bytes;
            if (line.error(kAreaLight) <= kAsNear * error && smaller) at_error = &line;
        }
        const bool reached = at_error != nullptr;
        for (const auto& [line, what] : {std::pair{at_bytes, "equal bytes"},
                                         {reached ? at_error : nearest, reached ? "equal error" : kNotReached}}) {
            if (line == nullptr) continue;
            compared.push_back(*line);
            compared.back().beside = what;
        }
    }
    lines.insert(lines.end(), compared.begin(), compared.end());
}

}  // namespace

std::vector<Rgb> area_light(uint32_t texels_across) {
    const SampleDirections samples(texels_across);
    std::vector<Rgb> radiance(texel_count(texels_across));
    const client::Direction towards = {0.6, -0.48, 0.64};
    for (size_t s = 0; s < samples.texel.size(); ++s) {
        const bool inside = client::dot(samples.direction[s], towards) > std::cos(kLightRadius);
        for (float& channel : radiance[samples.texel[s]])
            channel += (inside ? kLightRadiance : 1) / static_cast<float>(kSamplesInTexel);
    }
    return radiance;
}

Result<std::vector<QualitySky>> quality_skies(uint32_t texels_across) {
    std::vector<QualitySky> skies = {
        {"uniform", std::vector<Rgb>(texel_count(texels_across), Rgb{1, 1, 1})},
        {kAreaLight, area_light(texels_across)},
    };
    const std::filesystem::path folder = CITYSTREAM_SOURCE_DIR "/../shared/data/hdr_env";
    std::error_code missing;
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder, missing)) {
        const auto extension = entry.path().extension();
        if (extension == ".hdr" || extension == ".exr") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    for (const auto& file : files) {
        auto read = client::read_environment(file.string());
        if (!read) return read.error();
        client::take_sun(read->map);
        skies.push_back({file.stem().string(), client::source_radiance(read->map, texels_across)});
    }
    return skies;
}

double QualityLine::worst_error() const {
    double worst = 0;
    for (const auto& [sky, error] : errors) worst = std::max(worst, std::isfinite(error) ? error : HUGE_VAL);
    return worst;
}

double QualityLine::error(const std::string& sky) const {
    for (const auto& [name, error] : errors) {
        if (name == sky) return error;
    }
    return HUGE_VAL;
}

std::vector<QualityLine> measure_quality(const RadianceSet& set, std::span<const QualitySky> skies, uint32_t local_side,
                                         const AreaLightListener& listener) {
    std::vector<std::vector<std::vector<LightSum>>> truth;  // of each sample, each sky
    for (const RadianceSample& sample : set.samples) {
        const IrradianceModel exact = exact_irradiance(sample);
        auto& of_skies = truth.emplace_back();
        for (const QualitySky& sky : skies) of_skies.push_back(exact.irradiance(sky.radiance));
    }
    std::vector<QualityLine> lines;
    for (const Maker& make : makers(local_side, set.samples.front().visibility.side)) {
        QualityLine line;
        std::vector<ErrorSum> sums(skies.size());
        for (size_t s = 0; s < set.samples.size(); ++s) {
            const IrradianceModel model = make(set.samples[s]);
            line.representation = model.name;
            line.bytes += model.bytes;
            for (size_t i = 0; i < skies.size(); ++i) {
                const std::vector<LightSum> irradiance = model.irradiance(skies[i].radiance);
                sums[i].add(irradiance, truth[s][i]);
                if (listener && s == 0 && skies[i].name == kAreaLight) listener(line, irradiance);
            }
        }
        for (size_t i = 0; i < skies.size(); ++i)
            line.errors.emplace_back(skies[i].name, std::sqrt(sums[i].squares / std::max(sums[i].truth, 1e-300)));
        lines.push_back(std::move(line));
    }
    add_comparisons(lines);
    return lines;
}

}  // namespace citystream::bench
