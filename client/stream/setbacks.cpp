#include "client/stream/setbacks.h"

#include <algorithm>
#include <cmath>

#include "codec/atlas/shared_chart.h"

namespace citystream::client {

using tiles::tileset::Layer;

namespace {

constexpr double kFirstPauseSeconds = 0.5, kLongestPauseSeconds = 30;

bool is_directory(RequestKind kind) {
    return kind == RequestKind::kSubtree || kind == RequestKind::kFacadeIndex || kind == RequestKind::kChartIndex;
}

}  // namespace

std::string about(const std::string& path, const std::string& why) {
    return why.find(path) != std::string::npos ? why : path + ": " + why;
}

uint32_t& Setbacks::piece_failures(const PlannedRequest& request) {
    if (request.kind == RequestKind::kFacadeIndex) return facade_index_failures_;
    if (request.kind == RequestKind::kChartIndex) return chart_index_failures_;
    return subtree_failures_[request.subtree];
}

void Setbacks::mark_directory(const PlannedRequest& request, const std::string& why) {
    if (request.kind == RequestKind::kSubtree) {
        directory_.mark_broken(request.subtree);
        warnings_.add(about(subtree_path(request.subtree), why) + "; what lies below is drawn from its parent");
    } else if (request.kind == RequestKind::kFacadeIndex) {
        knowledge_.facades_broken = true;
        warnings_.add(about(tiles::tileset::kFacadeIndexPath, why) + "; facades are drawn flat");
    } else {
        knowledge_.charts_broken = true;
        warnings_.add(about(tiles::tileset::kChartIndexPath, why) + "; textures that tiles share are drawn grey");
    }
}

uint32_t Setbacks::mark_layer(Setback& setback, const std::string& why) {
    const PlannedRequest& request = setback.request;
    CachedLayer& entry = cache_.at(layer_key(request.node, request.layer));
    uint8_t& usable = knowledge_.tiles[request.node].usable_steps[static_cast<size_t>(request.layer)];
    setback.usable_before = usable;
    usable = static_cast<uint8_t>(std::min<uint32_t>(usable, std::max(entry.store_steps, entry.wire_steps)));
    const bool light = request.layer == Layer::kRadiance;
    warnings_.add(
        about(layer_path(request.layer, directory_.node(request.node).record->address), why) +
        (light ? "; its light is coarser, or the sky's without shadows" : "; drawn coarser or from its parent"));
    return ++entry.failures;
}

uint32_t Setbacks::mark_maps(const PlannedRequest& request, const std::string& why) {
    uint32_t failures = 0;
    for (MapPiece piece = request.from; piece != request.to; piece = knowledge_.dictionary.next(piece)) {
        failures = std::max(failures, ++cache_.at(map_key(piece)).failures);
        knowledge_.dictionary.set_usable(piece, false);
    }
    warnings_.add(about(tiles::tileset::kFacadeMapsPath, why) + "; other levels stand in, or facades are drawn flat");
    return failures;
}

uint32_t Setbacks::mark_charts(const PlannedRequest& request, const std::string& why) {
    uint32_t failures = 0;
    for (ChartPiece piece = request.from; piece != request.to; piece = knowledge_.charts.next(piece)) {
        CachedLayer& entry = cache_.at(chart_key(chart_of(piece)));
        failures = std::max(failures, ++entry.failures);
        // What is in the store stays, though its bytes are gone: the level after it cannot be had.
        const uint32_t level = std::max(chart_level_of(piece), entry.store_steps);
        if (level < codec::atlas::kMostChartLevels) {
            knowledge_.charts.set_missing(chart_piece(chart_of(piece), level), true);
        }
    }
    warnings_.add(about(tiles::tileset::kChartLevelsPath, why) + "; textures are drawn coarser, or in one colour");
    return failures;
}

void Setbacks::fail(const PlannedRequest& request, const std::string& why) {
    Setback setback;
    setback.request = request;
    uint32_t failures = 1;
    if (is_directory(request.kind)) {
        failures = ++piece_failures(request);
        mark_directory(request, why);
    } else if (request.kind == RequestKind::kLayer) {
        failures = mark_layer(setback, why);
    } else {
        failures = request.kind == RequestKind::kMaps ? mark_maps(request, why) : mark_charts(request, why);
    }
    const double pause = std::min(kFirstPauseSeconds * std::exp2(std::min(failures, 16u) - 1.0), kLongestPauseSeconds);
    setback.until = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(pause));
    setbacks_.push_back(setback);
}

void Setbacks::reject(const PlannedRequest& request, const std::string& why) {
    if (++piece_failures(request) >= 2) mark_directory(request, why);
}

void Setbacks::retry_due() {
    const Clock::time_point now = Clock::now();
    std::erase_if(setbacks_, [&](const Setback& setback) {
        if (setback.until > now) return false;
        allow(setback);
        return true;
    });
}

void Setbacks::allow(const Setback& setback) {
    const PlannedRequest& request = setback.request;
    switch (request.kind) {
        case RequestKind::kSubtree:
            directory_.mend(request.subtree);
            break;
        case RequestKind::kFacadeIndex:
            knowledge_.facades_broken = false;
            break;
        case RequestKind::kChartIndex:
            knowledge_.charts_broken = false;
            break;
        case RequestKind::kLayer:
            knowledge_.tiles[request.node].usable_steps[static_cast<size_t>(request.layer)] = setback.usable_before;
            break;
        case RequestKind::kMaps:
            for (MapPiece piece = request.from; piece != request.to; piece = knowledge_.dictionary.next(piece)) {
                if (cache_.at(map_key(piece)).damages < 2) knowledge_.dictionary.set_usable(piece, true);
            }
            break;
        case RequestKind::kCharts:
            for (ChartPiece piece = request.from; piece != request.to; piece = knowledge_.charts.next(piece)) {
                for (uint32_t level = chart_level_of(piece); level < codec::atlas::kMostChartLevels; ++level) {
                    knowledge_.charts.set_missing(chart_piece(chart_of(piece), level), false);
                }
            }
            break;
    }
}

}  // namespace citystream::client
