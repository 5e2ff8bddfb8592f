#include "codec/mesh/hidden_lattice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace citystream::codec::mesh {
namespace {

using Point = HiddenLattice::Point;
using Rings = std::vector<std::vector<Point>>;

/// Rings of houses on a lattice, in rows, as `place` puts lattice numbers on the grid.
template <typename Place>
Rings houses(int count, Place place) {
    std::mt19937 random(1);
    Rings rings;
    for (int i = 0; i < count; ++i) {
        const int row = i / 30, column = row % 2 == 0 ? i % 30 : 29 - i % 30;
        const int x = 150 * column + static_cast<int>(random() % 40), y = 150 * row + static_cast<int>(random() % 40);
        const int w = 30 + static_cast<int>(random() % 70), d = 30 + static_cast<int>(random() % 70);
        rings.push_back({place(x, y), place(x + w, y + 3), place(x + w - 3, y + d), place(x - 3, y + d - 3)});
    }
    return rings;
}
int32_t rounded(double v) {
    return static_cast<int32_t>(std::floor(v + 0.5));
}
/// The share of coordinates that are exactly where the lattice says.
double exact_share(const HiddenLattice& lattice, const Rings& rings) {
    double exact = 0, all = 0;
    for (const auto& ring : rings) {
        for (const Point& p : ring) {
            const auto place = lattice.place_of(lattice.nearest(p));
            for (size_t a = 0; a < 2; ++a) exact += p[a] == (place[a] + (1 << 15)) >> 16 ? 1 : 0;
            all += 2;
        }
    }
    return exact / all;
}
double spacing_of(const HiddenLattice& lattice, size_t axis) {
    return static_cast<double>(lattice.axes[axis].terms[1 + axis]) / 4294967296.0;
}

TEST(HiddenLattice, CentimetresAreFoundInOurGrid) {
    const Rings rings = houses(200, [](int x, int y) { return Point{rounded(x * 10.24), rounded(y * 10.24 + 7e6)}; });
    const auto lattice = find_hidden_lattice(rings);
    ASSERT_TRUE(lattice.has_value());
    EXPECT_NEAR(spacing_of(*lattice, 0), 10.24, 1e-4);
    EXPECT_NEAR(spacing_of(*lattice, 1), 10.24, 1e-4);
    EXPECT_GT(exact_share(*lattice, rings), 0.99);
}

TEST(HiddenLattice, ATurnedDriftingLatticeIsFollowedOverTheWholeArea) {
    const Rings rings = houses(1500, [](int i, int j) {
        const double x = 6.7 * i + 0.004 * j - 6e-8 * i * j, y = 6.66 * j - 0.004 * i + 5e-8 * i * i - 5e-8 * j * j;
        return Point{rounded(x + 1000.3), rounded(y - 500.7)};
    });
    const auto lattice = find_hidden_lattice(rings);
    ASSERT_TRUE(lattice.has_value());
    EXPECT_NEAR(spacing_of(*lattice, 0), 6.7, 0.01);
    EXPECT_GT(exact_share(*lattice, rings), 0.95);
}

TEST(HiddenLattice, ALatticeLittleWiderThanTheGridIsFound) {
    const Rings rings = houses(1500, [](int i, int j) { return Point{rounded(1.6746 * i), rounded(1.6672 * j)}; });
    const auto lattice = find_hidden_lattice(rings);
    ASSERT_TRUE(lattice.has_value());
    EXPECT_NEAR(spacing_of(*lattice, 0), 1.6746, 1e-3);
    EXPECT_GT(exact_share(*lattice, rings), 0.95);
}

TEST(HiddenLattice, NoneIsFoundInFreePointsOrFewOrNone) {
    std::mt19937 random(2);
    const Rings free = houses(1500, [&](int i, int j) {
        return Point{16 * i + static_cast<int32_t>(random() % 16), 16 * j + static_cast<int32_t>(random() % 16)};
    });
    EXPECT_FALSE(find_hidden_lattice(free).has_value());
    EXPECT_FALSE(find_hidden_lattice({}).has_value());
    EXPECT_FALSE(find_hidden_lattice(Rings{{{5, 5}, {5, 5}, {5, 5}}}).has_value());
    EXPECT_FALSE(find_hidden_lattice(Rings{{{0, 0}, {100, 0}, {100, 200}}}).has_value());
}

TEST(HiddenLattice, PlacesAreCutOffAndNotOverflown) {
    HiddenLattice lattice;
    for (auto& axis : lattice.axes) axis.terms.fill((int64_t{1} << 62) - 1);
    constexpr int32_t kEnd = (1 << 30) - 1;
    for (const Point number : {Point{kEnd, kEnd}, Point{-kEnd, kEnd}, Point{-kEnd, -kEnd}, Point{0, 0}}) {
        for (const int64_t at : lattice.place_of(number)) EXPECT_LE(std::abs(at), int64_t{1} << 46);
    }
}

}  // namespace
}  // namespace citystream::codec::mesh
