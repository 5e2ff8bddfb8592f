#include "client/stream/request_cost.h"

#include <gtest/gtest.h>

#include "client/cache/directory_pool.h"
#include "client/stream/tile_residency.h"
#include "tests/client/stream/streamer_flight.h"
#include "tests/client/stream/synthetic_city.h"

namespace citystream::client {
namespace {

using test::Flight;
using test::SyntheticCity;
using test::SyntheticOptions;
using tiles::tileset::Manifest;

constexpr uint64_t kGiB = 1ull << 30;
constexpr uint64_t kBytesPerTile = 100;

PlannedRequest request_of(RequestKind kind, uint64_t length = 0) {
    PlannedRequest request;
    request.kind = kind;
    request.length = length;
    return request;
}

TEST(RequestCost, ASubtreeIsAsLongAsTheManifestSaysButNeverMoreThanAShareOfTheBudget) {
    Manifest manifest;
    manifest.greatest_subtree_bytes = 10'000;
    EXPECT_EQ(subtree_limit(manifest, kGiB), 10'000u);
    manifest.greatest_subtree_bytes = UINT64_MAX;
    EXPECT_EQ(subtree_limit(manifest, kGiB), 16u << 20);
    EXPECT_EQ(subtree_limit(manifest, 32u << 20), 2u << 20);
    manifest.greatest_subtree_bytes = 0;
    EXPECT_EQ(subtree_limit(manifest, 32u << 20), 2u << 20);
    EXPECT_EQ(subtree_limit(manifest, 0), 64u << 10);
}

TEST(RequestCost, RangesCostTheirLengthAndTheIndexItsRecordsToo) {
    Manifest manifest;
    manifest.facade_map_count = 3;
    manifest.facade_index_decoded_bytes = 500;
    for (const RequestKind kind : {RequestKind::kLayer, RequestKind::kMaps}) {
        EXPECT_EQ(most_host_bytes(request_of(kind, 1234), manifest, kGiB, kBytesPerTile), 1234u);
    }
    EXPECT_EQ(most_host_bytes(request_of(RequestKind::kFacadeIndex, 200), manifest, kGiB, kBytesPerTile),
              200 + 500 + 3 * sizeof(tiles::tileset::FacadeMapRecord));
}

TEST(RequestCost, RoomForASubtreeHoldsItAndWhatIsMadeOfIt) {
    for (const uint32_t subtree_levels : {1u, 2u, 3u, 4u}) {
        SyntheticOptions options;
        options.levels = 5;
        options.subtree_levels = subtree_levels;
        const SyntheticCity city(options);
        size_t seen = 0;
        for (const auto& [path, bytes] : city.entries) {
            if (!path.starts_with("subtrees/")) continue;
            tiles::tileset::TileAddress root;
            ASSERT_EQ(std::sscanf(path.c_str(), "subtrees/%u/%u/%u", &root.level, &root.x, &root.y), 3);
            const auto subtree = tiles::tileset::parse_subtree(bytes, root, city.manifest);
            ASSERT_TRUE(subtree.ok());
            const uint64_t made =
                host_bytes_of(*subtree) + subtree->tiles.size() * (sizeof(DirectoryNode) + kBytesPerTile);
            Manifest manifest = city.manifest;
            manifest.greatest_subtree_bytes = bytes.size();
            EXPECT_GE(most_host_bytes(request_of(RequestKind::kSubtree), manifest, kGiB, kBytesPerTile),
                      bytes.size() + made)
                << path;
            ++seen;
        }
        EXPECT_GT(seen, 0u);
    }
}

TEST(RequestCost, AFlightReservesForSubtreesWhatTheyCanBringAndNoShareOfTheBudget) {
    for (const bool known : {true, false}) {
        SyntheticOptions city_options;
        city_options.subtree_bytes_known = known;
        const SyntheticCity city(city_options);
        StreamerOptions options;
        options.host_budget_bytes = kGiB;
        Flight flight(city, options);
        uint64_t held = 0, reserved = 0;
        for (const double x : {100.0, 500.0, 900.0}) {
            flight.update(city.camera(x, 100, 30, 20, -20));
            const StreamerFrame& frame = flight.frame;
            held = std::max(held, frame.host_bytes_held);
            reserved = std::max(reserved, frame.host_bytes_reserved);
            EXPECT_LE(std::max(frame.host_bytes_held, frame.host_bytes_reserved), frame.host_bytes_used);
            EXPECT_LE(frame.host_bytes_used, frame.host_bytes_held + frame.host_bytes_reserved);
        }
        uint64_t entries = 0;
        for (const auto& [path, bytes] : city.entries) entries += bytes.size();
        EXPECT_GT(held, 0u);
        if (known) {
            EXPECT_LT(reserved, entries) << "more is set aside than the whole city could bring";
        } else {
            EXPECT_GE(reserved, 16u << 20) << "nothing says how long they are: the share is the bound";
        }
        for (const FetchRequest& request : flight.fetcher.log) {
            if (!request.path.starts_with("subtrees/")) continue;
            EXPECT_LE(request.limit, known ? city.manifest.greatest_subtree_bytes : 16u << 20) << request.path;
        }
    }
}

TEST(RequestCost, ASubtreeLongerThanTheManifestSaysIsRefusedAndItsParentDrawn) {
    SyntheticCity city;
    Manifest lying = city.manifest;
    lying.greatest_subtree_bytes = city.entries.at("subtrees/0/0/0.subtree").size();
    ASSERT_LT(lying.greatest_subtree_bytes, city.manifest.greatest_subtree_bytes);
    const std::string json = write_tileset_json(lying);
    const auto bytes = std::as_bytes(std::span(json));
    city.entries["tileset.json"].assign(bytes.begin(), bytes.end());
    Flight flight(city);
    const auto& draws = flight.update(city.camera(100, 100, 30, 20, -20));
    EXPECT_FALSE(draws.empty());
    ASSERT_FALSE(flight.frame.warnings.empty());
    EXPECT_NE(flight.frame.warnings.front().find("more bytes than allowed"), std::string::npos)
        << flight.frame.warnings.front();
}

}  // namespace
}  // namespace citystream::client
