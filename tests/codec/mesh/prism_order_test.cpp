#include "codec/mesh/prism_order.h"

#include <gtest/gtest.h>

#include "codec/mesh/footprint_frame.h"
#include "tests/codec/mesh/prism_meshes.h"

namespace citystream::codec::mesh {
namespace {

/// Every prism once, each after the one that it hangs on.
void expect_tree(const std::vector<PrismVisit>& visits, size_t prisms) {
    ASSERT_EQ(visits.size(), prisms);
    std::vector<uint32_t> seen(prisms), hung(prisms);
    for (uint32_t v = 0; v < visits.size(); ++v) {
        ++seen[visits[v].prism];
        for (const uint32_t child : visits[v].children) {
            EXPECT_GT(child, v);
            ++hung[child];
        }
    }
    EXPECT_EQ(seen, std::vector<uint32_t>(prisms, 1));
    for (size_t v = 0; v < prisms; ++v) EXPECT_EQ(hung[v], v == 0 ? 0u : 1u);
}

TEST(PrismOrder, EveryPrismIsToldOnceAfterTheOneItHangsOn) {
    expect_tree(order_prisms({}), 0);
    for (const uint32_t houses : {1u, 2u, 50u, 700u}) expect_tree(order_prisms(make_town(houses, houses)), houses);
}

TEST(PrismOrder, PrismsInOnePlaceAndAtTheEndsOfTheGridAreAllTold) {
    constexpr int32_t kEnd = (1 << 30) - 1;
    std::vector<Prism> prisms(30, make_prism({rectangle(5, 5, 10, 10)}, 0, 1));
    for (const int32_t x : {-kEnd, kEnd - 4})
        for (const int32_t y : {-kEnd, kEnd - 4}) prisms.push_back(make_prism({rectangle(x, y, 4, 4)}, 0, 1));
    expect_tree(order_prisms(prisms), prisms.size());
}

TEST(PrismOrder, ARowIsToldAlongTheRowFromCornerToCorner) {
    std::vector<Prism> row;
    for (const int32_t place : {3, 0, 4, 1, 2}) row.push_back(make_prism({rectangle(100 * place, 0, 90, 50)}, 0, 1));
    const auto visits = order_prisms(row);
    expect_tree(visits, row.size());
    for (const PrismVisit& parent : visits) {
        const auto& points = row[parent.prism].rings[0].points;
        for (const uint32_t v : parent.children) {
            const auto& child = visits[v];
            const auto& from = points[(parent.start + child.parent_point) % points.size()];
            const auto& to = row[child.prism].rings[0].points[child.start];
            EXPECT_EQ(std::abs(from[0] - to[0]), 10);
            EXPECT_EQ(from[1], to[1]);
        }
    }
}

TEST(FootprintFrame, QuotientsAreRoundedToTheNearestWithTheirPart) {
    for (int64_t b : {1, 2, 3, 7, 1000}) {
        for (int64_t a = -3000; a <= 3000; ++a) {
            const Rounded r(a, b);
            EXPECT_LE(2 * (a - r.whole * b), b);
            EXPECT_GE(2 * (a - r.whole * b), -b);
            EXPECT_LE(r.part, 7u);
            EXPECT_TRUE(a != r.whole * b || r.part == 4);
        }
    }
}

TEST(FootprintFrame, LearnsADirectionAndItsQuarters) {
    FootprintFrame frame;
    frame.start({1000, 300});
    frame.learn({2000, 600});
    for (uint32_t quarter = 0; quarter < 4; ++quarter) {
        EXPECT_EQ(frame.quarter_of(PlaneVector{500, 150}.turned(quarter)), quarter);
        EXPECT_EQ(frame.quarter_of(PlaneVector{500, 250}.turned(quarter)), quarter);
    }
    EXPECT_EQ(frame.across(100).whole, 30);
    EXPECT_EQ(frame.along({500, 150}).whole, 500);
    frame.learn({10, -300});  // far off: not learned
    EXPECT_EQ(frame.across(100).whole, 30);
}

}  // namespace
}  // namespace citystream::codec::mesh
