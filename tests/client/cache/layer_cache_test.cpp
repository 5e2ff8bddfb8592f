#include "client/cache/layer_cache.h"

#include <gtest/gtest.h>

#include "client/cache/host_layer_store.h"

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
