#include "client/stream/layer_decoder.h"

#include <algorithm>

#include "codec/step_wire.h"
#include "codec/stop.h"

namespace citystream::client {

using tiles::tileset::Layer;

namespace {

Status append_words(std::span<const std::byte> wire, uint32_t decoded_bytes, std::vector<uint32_t>& words) {
    const auto step = codec::decode_step(wire, decoded_bytes);
    if (!step) return step.error();
    words.insert(words.end(), step->begin(), step->end());
    return Done{};
}

std::vector<std::span<const std::byte>> spans_of(std::span<const std::vector<std::byte>> wire, size_t steps) {
    const auto first = wire.first(steps);
    return {first.begin(), first.end()};
}

Result<LayerFacts> check_atlas(const DecodedPrefix& prefix, uint64_t dictionary_size) {
    auto atlas = codec::atlas::check_atlas(prefix.words, prefix.step_words, dictionary_size);
    if (!atlas) return atlas.error();
    LayerFacts facts;
    facts.atlas = std::move(*atlas);
    return facts;
}

Result<LayerFacts> check_facade(const DecodedPrefix& prefix, uint32_t chart_count, uint32_t map_count) {
    auto tile = codec::facade::decode_facades(prefix.words, map_count, chart_count);
    if (!tile) return tile.error();
    LayerFacts facts;
    facts.placements = std::move(tile->placements);
    for (const auto& placement : facts.placements) facts.facade_maps.push_back(placement.map);
    std::sort(facts.facade_maps.begin(), facts.facade_maps.end());
    facts.facade_maps.erase(std::unique(facts.facade_maps.begin(), facts.facade_maps.end()), facts.facade_maps.end());
    return facts;
}

}  // namespace

bool decompress_prefix(std::span<const std::vector<std::byte>> wire, std::span<const tiles::tileset::StepRecord> steps,
                       DecodedPrefix& out, DecodeFailure& failure) {
    out = {};
    uint64_t total = 0;
    for (const auto& step : steps) total += step.decoded_bytes / 4;
    out.words.reserve(total);
    for (uint32_t i = 0; i < steps.size(); ++i) {
        const Status appended = append_words(wire[i], steps[i].decoded_bytes, out.words);
        if (!appended) {
            failure = {i, appended.error().text()};
            return false;
        }
        out.step_words.push_back(steps[i].decoded_bytes / 4);
    }
    return true;
}

bool decode_mesh(std::span<const std::vector<std::byte>> wire, std::span<const tiles::tileset::StepRecord> steps,
                 uint32_t chart_count, codec::mesh::MeshLayer& out, DecodeFailure& failure) {
    std::vector<uint32_t> decoded_bytes;
    for (const auto& step : steps) decoded_bytes.push_back(step.decoded_bytes);
    const auto spans = spans_of(wire, steps.size());
    for (size_t count = spans.size(); count > 0; --count) {
        auto layer = codec::mesh::decode_mesh_layer(std::span(spans).first(count),
                                                    std::span(decoded_bytes).first(count), chart_count);
        if (layer && count == spans.size()) {
            out = std::move(*layer);
            return true;
        }
        if (layer) break;
        failure = {static_cast<uint32_t>(count - 1), layer.error().text()};
    }
    return false;
}

bool decode_light(std::span<const std::vector<std::byte>> wire, std::span<const tiles::tileset::StepRecord> steps,
                  const codec::radiance::MatrixOptions& matrix, DecodedLight& out, DecodeFailure& failure) {
    const auto spans = spans_of(wire, steps.size());
    for (size_t count = spans.size(); count > 0; --count) {
        uint64_t decoded = 0;
        for (const auto& step : steps.first(count)) decoded += step.decoded_bytes;
        auto layer = codec::radiance::decode_radiance_layer(std::span(spans).first(count), decoded, matrix, &out.loss);
        if (layer && count == spans.size()) {
            out.words = std::move(*layer);
            return true;
        }
        if (layer) break;
        if (is_stopped(matrix.stop)) return false;
        failure = {static_cast<uint32_t>(count - 1), layer.error().text()};
    }
    return false;
}

Result<codec::mesh::MeshContent> decode_mesh_content(std::span<const std::vector<std::byte>> wire,
                                                     std::span<const tiles::tileset::StepRecord> steps) {
    uint64_t decoded = 0;
    for (const auto& step : steps) decoded += step.decoded_bytes;
    return codec::mesh::decode_mesh_content(spans_of(wire, steps.size()), decoded, kAnyChart);
}

Result<LayerFacts> check_layer(Layer layer, const DecodedPrefix& prefix, const NameLimits& limits) {
    switch (layer) {
        case Layer::kAtlas:
            return check_atlas(prefix, limits.shared_charts);
        case Layer::kFacade:
            return check_facade(prefix, limits.charts, limits.facade_maps);
        case Layer::kMesh:
        case Layer::kRadiance:
            break;
    }
    return Error{"not a layer of words"};
}

bool decode_layer(Layer layer, std::span<const std::vector<std::byte>> wire,
                  std::span<const tiles::tileset::StepRecord> steps, const NameLimits& limits, DecodedPrefix& out,
                  LayerFacts& facts, DecodeFailure& failure) {
    if (!decompress_prefix(wire, steps, out, failure)) return false;
    auto checked = check_layer(layer, out, limits);
    if (checked) {
        facts = std::move(*checked);
        return true;
    }
    failure = {0, checked.error().text()};
    // Which step is to blame: the one after the longest prefix that is good.
    DecodedPrefix shorter = out;
    while (shorter.step_words.size() > 1) {
        shorter.words.resize(shorter.words.size() - shorter.step_words.back());
        shorter.step_words.pop_back();
        if (check_layer(layer, shorter, limits)) {
            failure.step = static_cast<uint32_t>(shorter.step_words.size());
            break;
        }
    }
    return false;
}

}  // namespace citystream::client
