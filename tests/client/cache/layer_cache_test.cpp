#include "client/cache/layer_cache.h"

#include <gtest/gtest.h>

#include "client/cache/host_layer_store.h"
#include "codec/mesh/adaptive_precision.h"

namespace citystream::client {
namespace {

std::vector<uint32_t> words(size_t count) {
    return std::vector<uint32_t>(count, 7);
}
std::vector<std::byte> bytes(size_t count) {
    return std::vector<std::byte>(count, std::byte{1});
}

TEST(HostLayerStore, CountsSlotsRoundedUpAndRefusesWhatDoesNotFit) {
    HostLayerStore store(4 * 64, 64, true);
    EXPECT_EQ(store.slot_count(), 4u);
    const LayerId a = store.create(), b = store.create();
    EXPECT_NE(a, b);
    EXPECT_TRUE(store.append(a, words(1)));
    EXPECT_EQ(store.slots_used(), 1u);
    EXPECT_TRUE(store.append(a, words(15)));
    EXPECT_EQ(store.slots_used(), 1u);
    EXPECT_TRUE(store.append(a, words(1)));
    EXPECT_EQ(store.slots_used(), 2u);
    EXPECT_FALSE(store.append(b, words(33)));
    EXPECT_EQ(store.slots_used(), 2u);
    EXPECT_EQ(store.refused_appends(), 1u);
    EXPECT_TRUE(store.append(b, words(32)));
    EXPECT_EQ(store.words_of(a).size(), 17u);
    store.destroy(a);
    EXPECT_EQ(store.slots_used(), 2u);
    EXPECT_FALSE(store.append(a, words(1)));
    EXPECT_EQ(store.most_slots_used(), 4u);
}

/// Words of a layer with a precision buffer at its end.
struct Refined {
    codec::mesh::PrecisionShape shape;
    std::vector<uint32_t> values;
    size_t before = 0;

    Refined(uint32_t vertices, size_t words_before) : before(words_before) {
        shape.vertices = vertices;
        shape.components = 1;
        shape.full_bits = 16;
        for (uint32_t i = 0; i < vertices; ++i) values.push_back(i * 40503 & 0xffff);
    }
    std::vector<uint32_t> at(uint32_t level) const {
        std::vector<uint32_t> all = words(before);
        const auto buffer = codec::mesh::pack_precision(shape, values, level);
        all.insert(all.end(), buffer.begin(), buffer.end());
        return all;
    }
    std::vector<uint32_t> planes(uint32_t from, uint32_t to) const {
        std::vector<uint32_t> all;
        for (uint32_t plane = from; plane < to; ++plane) {
            const auto bits = codec::mesh::precision_plane(shape, values, plane);
            all.insert(all.end(), bits.begin(), bits.end());
        }
        return all;
    }
};

TEST(HostLayerStore, RefinesThePrecisionBufferAtTheEndOfALayer) {
    HostLayerStore store(32 * 64, 64, true);
    const Refined refined(100, 21);
    const LayerId layer = store.create();
    ASSERT_TRUE(store.append(layer, refined.at(4)));
    for (const auto& [from, to] : {std::pair(4u, 7u), {7u, 7u}, {7u, 8u}, {8u, 16u}}) {
        const auto bytes = store.refine(layer, 21, refined.planes(from, to), to);
        ASSERT_TRUE(bytes.ok()) << bytes.error().text();
        EXPECT_EQ(*bytes, 4 * refined.at(to).size());
        const auto got = store.words_of(layer);
        ASSERT_EQ(std::vector<uint32_t>(got.begin(), got.end()), refined.at(to));
        EXPECT_EQ(store.slots_used(), store.slots_for(*bytes));
    }
    EXPECT_FALSE(store.refine(layer + 1, 21, {}, 16));
    EXPECT_FALSE(store.refine(layer, 20, {}, 16)) << "no buffer begins there";
    EXPECT_FALSE(store.refine(layer, ~uint64_t{0}, {}, 16));
    EXPECT_FALSE(store.refine(layer, 21, {}, 15)) << "a lower level";
    EXPECT_FALSE(store.refine(layer, 21, refined.planes(14, 16), 18)) << "no such level";
}

TEST(HostLayerStore, RefusesARefinementWhoseOldAndNewWordsDoNotFitTogether) {
    const Refined refined(100, 5);
    const uint64_t slots = (refined.at(4).size() + 15) / 16, more = (refined.at(8).size() + 15) / 16;
    HostLayerStore tight((slots + more - 1) * 64, 64, true), enough((slots + more) * 64, 64, true);
    for (HostLayerStore* store : {&tight, &enough}) {
        const LayerId layer = store->create();
        ASSERT_TRUE(store->append(layer, refined.at(4)));
        EXPECT_EQ(store->refine(layer, 5, refined.planes(4, 8), 8).ok(), store == &enough);
        EXPECT_EQ(store->words_of(layer).size(), refined.at(store == &enough ? 8 : 4).size());
        EXPECT_EQ(store->refused_appends(), store == &enough ? 0u : 1u);
        EXPECT_LE(store->most_slots_used(), store->slot_count());
    }
}

struct Caches {
    explicit Caches(uint64_t slots) : store(slots * 64, 64, true), cache(store, host) { host.budget = 1 << 20; }
    CachedLayer& fill(CacheKey key, size_t count) {
        CachedLayer& layer = cache.at(key);
        EXPECT_TRUE(cache.append(layer, words(count), 1));
        return layer;
    }
    HostMemory host;
    HostLayerStore store;
    LayerCache cache;
};

TEST(LayerCache, EvictsTheLeastRecentlyNeededFirst) {
    Caches c(3);
    for (CacheKey key = 1; key <= 3; ++key) c.cache.need(c.fill(key, 16));
    c.cache.begin_selection();
    c.cache.need(c.cache.at(1));  // 2 is now the oldest
    c.cache.begin_selection();
    EXPECT_TRUE(c.cache.free_slots(1));
    EXPECT_EQ(c.cache.at(2).store_steps, 0u);
    EXPECT_EQ(c.cache.at(1).store_steps, 1u);
    EXPECT_EQ(c.cache.at(3).store_steps, 1u);
    EXPECT_EQ(c.store.slots_used(), 2u);
}

TEST(LayerCache, NeverEvictsWhatTheSelectionNeeds) {
    Caches c(3);
    for (CacheKey key = 1; key <= 3; ++key) c.fill(key, 16);
    c.cache.begin_selection();
    c.cache.need(c.cache.at(1));
    c.cache.need(c.cache.at(2));
    EXPECT_FALSE(c.cache.free_slots(2));
    EXPECT_EQ(c.cache.at(1).store_steps, 1u);
    EXPECT_EQ(c.cache.at(2).store_steps, 1u);
}

TEST(LayerCache, SparesWhatWasJustDrawnWhileAnythingElseIsLeft) {
    Caches c(3);
    for (CacheKey key = 1; key <= 3; ++key) c.fill(key, 16);
    c.cache.mark_drawn(c.cache.at(1));
    c.cache.begin_update();
    c.cache.begin_selection();
    EXPECT_TRUE(c.cache.free_slots(2));
    EXPECT_EQ(c.cache.at(1).store_steps, 1u);
    EXPECT_TRUE(c.cache.free_slots(3));
    EXPECT_EQ(c.cache.at(1).store_steps, 0u);
}

TEST(LayerCache, ARefinedLayerCountsItsNewSlotsBytesAndSteps) {
    Caches c(30);
    const Refined refined(100, 30);
    CachedLayer& layer = c.cache.at(1);
    ASSERT_TRUE(c.cache.append(layer, refined.at(4), 1));
    CachedLayer& old = c.fill(2, 16 * 20);
    uint32_t steps = 1;
    for (uint32_t level = 4; level < 16; level += 3) {
        const uint64_t total = 4 * refined.at(level + 3).size();
        c.cache.begin_selection();
        c.cache.need(layer);
        ASSERT_TRUE(c.cache.free_slots(c.cache.slots_for(total)));
        const Status status = c.cache.refine(layer, 30, refined.planes(level, level + 3), level + 3, total, ++steps);
        ASSERT_TRUE(status.ok()) << status.error().text();
        EXPECT_EQ(layer.store_bytes, total);
        EXPECT_EQ(layer.store_steps, steps);
        EXPECT_EQ(c.cache.slots_used(), c.store.slots_used());
    }
    EXPECT_EQ(old.store_steps, 0u) << "its slots were needed";
    EXPECT_EQ(c.store.refused_appends(), 0u);
    c.cache.drop_store(layer);
    EXPECT_EQ(c.cache.slots_used(), 0u);
    EXPECT_EQ(c.store.slots_used(), 0u);
}

TEST(LayerCache, AFailedRefinementChangesNothingAndOneOfAnotherSizeDropsTheLayer) {
    Caches c(40);
    const Refined refined(100, 30);
    CachedLayer& layer = c.cache.at(1);
    EXPECT_FALSE(c.cache.refine(layer, 30, refined.planes(4, 7), 7, 400, 2)) << "not in the store";
    ASSERT_TRUE(c.cache.append(layer, refined.at(4), 1));
    const uint64_t total = 4 * refined.at(7).size();
    EXPECT_FALSE(c.cache.refine(layer, 30, refined.planes(4, 6), 7, total, 2));
    EXPECT_EQ(layer.store_steps, 1u);
    EXPECT_EQ(layer.store_bytes, 4 * refined.at(4).size());
    EXPECT_EQ(c.cache.slots_used(), c.store.slots_used());
    EXPECT_FALSE(c.cache.refine(layer, 30, refined.planes(4, 7), 7, total + 4, 2));
    EXPECT_EQ(layer.id, kNoLayer);
    EXPECT_EQ(c.cache.slots_used(), 0u);
    EXPECT_EQ(c.store.slots_used(), 0u);
}

TEST(LayerCache, CountsWireBytesAndCutsThemByStep) {
    Caches c(1);
    CachedLayer& layer = c.cache.at(9);
    c.cache.add_wire(layer, bytes(100), true);
    c.cache.add_wire(layer, bytes(50), true);
    EXPECT_EQ(c.host.wire, 150u);
    c.cache.drop_wire_from(layer, 1);
    EXPECT_EQ(c.host.wire, 100u);
    EXPECT_EQ(layer.wire_steps, 1u);
    c.cache.drop_wire_from(layer, 0);
    EXPECT_EQ(c.host.wire, 0u);
}

TEST(LayerCache, StepsMayComeInAnyOrderAndCountWhenThoseBeforeThemAreHere) {
    Caches c(1);
    CachedLayer& layer = c.cache.at(9);
    c.cache.put_wire(layer, 2, bytes(30), true);
    EXPECT_EQ(layer.wire_steps, 0u);
    c.cache.put_wire(layer, 0, bytes(10), true);
    EXPECT_EQ(layer.wire_steps, 1u);
    c.cache.put_wire(layer, 1, bytes(20), true);
    EXPECT_EQ(layer.wire_steps, 3u);
    for (size_t step = 0; step < 3; ++step) EXPECT_EQ(layer.wire[step].size(), 10 * (step + 1));
    EXPECT_EQ(c.host.wire, 60u);
    c.cache.drop_wire_step(layer, 1);
    c.cache.drop_wire_step(layer, 1);
    EXPECT_EQ(layer.wire_steps, 1u);
    EXPECT_EQ(layer.wire_bytes, 40u);
    // What came early is held, and goes, like the rest.
    c.cache.drop_wire_step(layer, 0);
    EXPECT_EQ(layer.wire_steps, 0u);
    EXPECT_EQ(c.host.wire, 30u);
    c.cache.begin_selection();
    c.host.budget = c.host.fixed;
    EXPECT_TRUE(c.cache.free_host(0));
    c.host.budget = c.host.fixed + 1;
    EXPECT_TRUE(c.cache.free_host(1));
    EXPECT_EQ(c.host.wire, 0u);
}

TEST(LayerCache, CountsChartsInTheStoreApartFromMaps) {
    Caches c(8);
    c.fill(chart_key(3), 4);
    c.fill(map_key(map_piece(3, 1)), 4);
    c.fill(layer_key(3, tiles::tileset::Layer::kMesh), 4);
    EXPECT_EQ(c.cache.charts_in_store(), 1u);
    EXPECT_EQ(c.cache.maps_in_store()[1], 1u);
    c.cache.drop_store(c.cache.at(chart_key(3)));
    EXPECT_EQ(c.cache.charts_in_store(), 0u);
    EXPECT_EQ(c.cache.maps_in_store()[1], 1u);
}

TEST(LayerCache, DropsOldWireBytesToKeepTheHostBudget) {
    Caches c(1);
    c.host.budget = 4000;
    for (CacheKey key = 1; key <= 3; ++key) c.cache.add_wire(c.cache.at(key), bytes(500), false);
    c.cache.begin_selection();
    c.cache.need(c.cache.at(1));
    const uint64_t fixed = c.host.fixed;
    EXPECT_TRUE(c.cache.free_host(4000 - fixed - 1000));
    EXPECT_EQ(c.cache.at(2).wire_steps, 0u) << "the older of the two that are not needed";
    EXPECT_EQ(c.cache.at(3).wire_steps, 1u);
    EXPECT_FALSE(c.cache.free_host(4000 - fixed - 100)) << "needed bytes stay";
    EXPECT_EQ(c.cache.at(1).wire_steps, 1u);
}

TEST(LayerCache, AFailedAppendLeavesNothingBehind) {
    Caches c(2);
    CachedLayer& layer = c.fill(1, 16);
    EXPECT_FALSE(c.cache.append(layer, words(100), 2));
    EXPECT_EQ(layer.store_steps, 0u);
    EXPECT_EQ(c.store.slots_used(), 0u);
    EXPECT_EQ(c.cache.slots_used(), 0u);
}

}  // namespace
}  // namespace citystream::client
