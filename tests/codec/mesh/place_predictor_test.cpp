// The learnt place of an apex: the parallelogram to begin with, what the surface does after a while.
#include "codec/mesh/place_predictor.h"

#include <gtest/gtest.h>

#include <cmath>

namespace citystream::codec::mesh {
namespace {

GatePlaces gate_at(int32_t x, int32_t sag) {
    // A border along x on a surface that bends by `sag` a step in y.
    return {{x, 100, 0},
            {x + 100, 100, 0},
            {x + 50, 0, sag},
            {x - 100, 100, 0},
            {x + 200, 100, 0},
            {x - 50, 0, sag},
            {x + 150, 0, sag},
            {},
            {},
            {}};
}

double distance(const Vector& place, const GridPoint& point) {
    return std::hypot(place[0] - point[0], place[1] - point[1], place[2] - point[2]);
}

TEST(PlacePredictor, BeginsWithTheParallelogram) {
    PlacePredictor predictor;
    const Vector place =
        predictor.expect({{0, 0, 0}, {10, 0, 0}, {5, -9, 2}, {-10, 0, 0}, {20, 0, 0}, {}, {}, {}, {}, {}});
    EXPECT_EQ(place, (Vector{5, 9, -2}));
}

TEST(PlacePredictor, LearnsThatTrianglesBecomeFlatter) {
    PlacePredictor predictor;
    double first = 0, last = 0;
    for (int32_t i = 0; i < 200; ++i) {
        const GridPoint apex = {100 * i + 50, 180, -6};  // the parallelogram would be at y = 200, z = -7
        last = distance(predictor.expect(gate_at(100 * i, 7)), apex);
        if (i == 0) first = last;
        predictor.learn(apex);
    }
    EXPECT_GT(first, 19);
    EXPECT_LT(last, 1);
}

TEST(PlacePredictor, ExpectsTheErrorsThatItMakes) {
    PlacePredictor predictor;
    for (int32_t i = 0; i < 300; ++i) {
        predictor.expect(gate_at(100 * i, 0));
        predictor.learn({100 * i + 50 + (i % 2 == 0 ? 8 : -8), 200, 0});
    }
    predictor.expect(gate_at(0, 0));
    EXPECT_NEAR(predictor.expected_miss(), 8, 3);
}

TEST(PlacePredictor, StaysFiniteOnTrianglesWithoutArea) {
    PlacePredictor predictor;
    for (int32_t i = 0; i < 100; ++i) {
        const Vector place =
            predictor.expect({{5, 5, 5}, {5, 5, 5}, {5, 5, 5}, {5, 5, 5}, {5, 5, 5}, {}, {}, {}, {}, {}});
        for (const double c : place) EXPECT_TRUE(std::isfinite(c));
        predictor.learn({(1 << 30) - 1, i, 0});
    }
}

}  // namespace
}  // namespace citystream::codec::mesh
