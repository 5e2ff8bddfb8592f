// A streamer that flies over the synthetic city.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

#include "client/cache/host_layer_store.h"
#include "client/stream/city_streamer.h"
#include "tests/client/stream/fake_fetcher.h"
#include "tests/client/stream/synthetic_city.h"

namespace citystream::client::test {

/// A streamer over the synthetic city with a fake network and a store in host memory.
struct Flight {
    explicit Flight(const SyntheticCity& where, StreamerOptions with = {}, uint64_t gpu_bytes = 64u << 20,
                    uint64_t slot_bytes = 4096)
        : city(where), fetcher(where.entries), store(gpu_bytes, slot_bytes, with.decode), options(std::move(with)) {
        options.relief.texel_share = 1;  // texels of the tolerance's size: thresholds lie within this small city
        fetcher.per_wait = 4;
        auto opened = CityStreamer::open(fetcher, store, options);
        EXPECT_TRUE(opened) << (opened ? "" : opened.error().text());
        if (opened) streamer = std::move(*opened);
        fetcher.take_bytes();
    }
    const std::vector<TileDraw>& update(const Camera& camera) { return streamer->update(camera, frame); }

    const SyntheticCity& city;
    FakeFetcher fetcher;
    HostLayerStore store;
    StreamerOptions options;
    std::unique_ptr<CityStreamer> streamer;
    StreamerFrame frame;
};

/// The draw of a tile; null when it is not among them.
inline const TileDraw* draw_of(const SyntheticCity& city, const std::vector<TileDraw>& draws, TileAddress address) {
    const GridPoint origin = city.manifest.tile_origin(city.tile(address));
    for (const TileDraw& draw : draws) {
        if (draw.origin[0] == to_metres(origin.x) && draw.origin[1] == to_metres(origin.y)) return &draw;
    }
    return nullptr;
}

/// Chooses a view at once, whatever hides what.
inline StreamerOptions whole_view() {
    StreamerOptions options;
    options.occlusion = false;
    return options;
}

inline StreamerOptions realtime() {
    StreamerOptions options;
    options.wait_for_selection = false;
    return options;
}

}  // namespace citystream::client::test
