// BTFs of facades: what they hold beside rays cast one by one, and how they are looked up.
#include "codec/radiance/btf.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "codec/facade/facade_ray.h"
#include "codec/radiance/local_directions.h"
#include "codec/radiance/series_angle.h"
#include "tests/codec/radiance/relief_facades.h"

namespace citystream::codec::radiance {
namespace {

using facade::RunGrid;
using Vector = std::array<float, 3>;

constexpr float kStep = 1.0F / 255;

std::vector<uint32_t> btf_of(const RunGrid& grid, const BtfOptions& options) {
    const std::vector<uint32_t> mask = make_relief_mask(grid);
    const auto words = make_btf(grid, *ReliefMaskView::create(mask), options);
    EXPECT_TRUE(words.ok());
    return words.ok() ? *words : std::vector<uint32_t>();
}

/// A BTF of one mip 0 without rays: all bytes of its records 0.
std::vector<uint32_t> empty_btf(const BtfOptions& options) {
    const auto shape = btf_shape(options, false);
    std::vector<uint32_t> words = btf_head(*shape, 1);
    words.resize(shape->words(), 0);
    return words;
}

std::span<const uint32_t> view_table(const std::vector<uint32_t>& words) {
    return std::span(words).subspan(BTF_VIEW_TABLE);
}

Vector table_direction(std::span<const uint32_t> table, uint32_t i) {
    Vector d{};
    for (size_t k = 0; k < 3; ++k) d[k] = std::bit_cast<float>(table[size_t{i} * BTF_DIRECTION_WORDS + k]);
    return d;
}

Vector random_direction(std::mt19937& random, float least_z = 0) {
    std::uniform_real_distribution<float> unit(0, 1);
    const float z = least_z + (1 - least_z) * unit(random), turn = 6.2831853F * unit(random), r = std::sqrt(1 - z * z);
    return {r * std::cos(turn), r * std::sin(turn), z};
}

double cosine(const Vector& a, const Vector& b) {
    return double{a[0]} * b[0] + double{a[1]} * b[1] + double{a[2]} * b[2];
}

/// All grid directions' shares, 0 for those that do not count.
std::vector<float> all_shares(std::span<const uint32_t> table, uint32_t across, const Vector& direction) {
    std::vector<float> all(size_t{across} * across, 0);
    const SphereShares shares = sphere_shares(table, across, direction);
    for (size_t k = 0; k < 4; ++k) all[shares.cell[k]] += shares.share[k];
    return all;
}

class SphereSharesTest : public testing::TestWithParam<uint32_t> {
  protected:
    uint32_t across() const { return GetParam(); }
    std::vector<uint32_t> words_ = btf_head(*btf_shape({4, GetParam()}, false), 1);
    std::span<const uint32_t> table_ = view_table(words_);
};

TEST_P(SphereSharesTest, AddUpToOneAndAreNotNegative) {
    std::mt19937 random(1);
    for (int i = 0; i < 20000; ++i) {
        const SphereShares shares = sphere_shares(table_, across(), random_direction(random, -0.2F));
        float sum = 0;
        for (size_t k = 0; k < 4; ++k) {
            ASSERT_GE(shares.share[k], 0);
            ASSERT_LT(shares.cell[k], across() * across());
            sum += shares.share[k];
        }
        ASSERT_NEAR(sum, 1, 1e-5);
    }
}

TEST_P(SphereSharesTest, GiveADirectionOfTheGridAll) {
    for (uint32_t i = 0; i < across() * across(); ++i)
        EXPECT_NEAR(all_shares(table_, across(), table_direction(table_, i))[i], 1, 2e-3) << i;
}

// What they average to is the direction itself, wherever directions of the grid are all around it.
TEST_P(SphereSharesTest, BringTheMeanToTheDirection) {
    float lowest = 1;
    for (uint32_t i = 0; i < across() * across(); ++i) lowest = std::min(lowest, table_direction(table_, i)[2]);
    std::mt19937 random(2);
    for (int i = 0; i < 20000; ++i) {
        // Great circles between the lowest directions rise above them.
        const Vector d = random_direction(random, lowest + 0.02F);
        const std::vector<float> shares = all_shares(table_, across(), d);
        Vector mean{};
        for (uint32_t j = 0; j < shares.size(); ++j) {
            for (size_t k = 0; k < 3; ++k) mean[k] += shares[j] * table_direction(table_, j)[k];
        }
        ASSERT_GT(cosine(mean, d) / std::sqrt(cosine(mean, mean)), 1 - 1e-6);
    }
}

// Along circles at one height, at the horizon and below it, and along circles up to the pole and down again. In the
// corners of the grid, where three directions of the ring lie nearly on a great circle, shares change fast: there the
// steps are smaller.
TEST_P(SphereSharesTest, AreContinuous) {
    std::mt19937 random(3);
    constexpr double kAngle = 1e-4, kMost = 0.02;
    for (int i = 0; i < 40; ++i) {
        const Vector from = random_direction(random, 0);
        const float height = i % 4 == 0 ? 0 : i % 4 == 1 ? -0.2F : from[2], level = std::sqrt(1 - height * height);
        const float flat = std::sqrt(from[0] * from[0] + from[1] * from[1]);
        const auto shares_at = [&](size_t k, double turn) {
            const auto s = static_cast<float>(std::sin(turn)), c = static_cast<float>(std::cos(turn));
            return all_shares(
                table_, across(),
                k == 0 ? Vector{c * level, s * level, height} : Vector{c * from[0] / flat, c * from[1] / flat, s});
        };
        const auto jump = [](const std::vector<float>& a, const std::vector<float>& b) {
            double most = 0;
            for (size_t j = 0; j < a.size(); ++j) most = std::max(most, std::abs(double{a[j]} - double{b[j]}));
            return most;
        };
        for (size_t k = 0; k < 2; ++k) {
            std::vector<float> last = shares_at(k, 0);
            for (int step = 1; step * kAngle < kPi; ++step) {
                std::vector<float> shares = shares_at(k, step * kAngle);
                for (int part = 0; part < 32 && jump(shares, last) > kMost; ++part) {
                    const double from_turn = (step - 1 + part / 32.0) * kAngle;
                    ASSERT_LE(jump(shares_at(k, from_turn), shares_at(k, from_turn + kAngle / 32)), kMost) << step;
                }
                last = std::move(shares);
            }
        }
    }
}

TEST_P(SphereSharesTest, TakeWhatIsNoDirectionUpwards) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinite = std::numeric_limits<float>::infinity();
    for (const Vector& d : {Vector{0, 0, 0}, Vector{kNan, 0, 1}, Vector{kInfinite, 1, 1}, Vector{0, 0, -1}})
        EXPECT_EQ(all_shares(table_, across(), d), all_shares(table_, across(), {0, 0, 1}));
}

INSTANTIATE_TEST_SUITE_P(Grids, SphereSharesTest, testing::Values(4, 5, 8, 12, 16));

TEST(Btf, OfAFlatMapIsTheCosine) {
    const std::vector<uint32_t> words = btf_of(relief_facade(200, 150, {{0, 0, 200, 150, 0, 5}}), {8, 8});
    const auto btf = BtfView::create(words);
    ASSERT_TRUE(btf.ok()) << btf.error().text();
    EXPECT_EQ(btf->slots(), 1u << 5);
    std::mt19937 random(1);
    std::array<double, BTF_DIRECTIONS> light{};
    std::iota(light.begin(), light.end(), 1.0);
    double irradiance = 0;
    for (uint32_t j = 0; j < BTF_DIRECTIONS; ++j)
        irradiance += light[j] * relief_weights()[RELIEF_FACE_FRONT][j] / 65536;
    for (int i = 0; i < 200; ++i) {
        const Vector e = random_direction(random), sun = random_direction(random);
        const BtfPlace place = btf->place({e[0] + 0.5F, e[1] + 0.5F}, e, static_cast<uint32_t>(i % 5));
        for (uint32_t j = 0; j < BTF_DIRECTIONS; ++j) {
            const float weight = static_cast<float>(relief_weights()[RELIEF_FACE_FRONT][j]) / 65536;
            ASSERT_NEAR(btf->value(place, j), weight, kStep) << j;
        }
        EXPECT_NEAR(btf->slot_shares(place)[5], 1, 1e-5);
        EXPECT_EQ(btf->coverage(place), 1);
        EXPECT_NEAR(btf->openness(place), 1, 0.004);
        EXPECT_NEAR(btf->sun_cosine(place, sun), sun[2], 0.005);
        std::array<double, BTF_SLOTS> albedo{};
        albedo[5] = 0.4;
        EXPECT_NEAR(shade_btf(*btf, place, light, albedo), 0.4 * irradiance, 0.002 * irradiance);
    }
}

/// What rays say, without masks: a ray from the viewer to a random place of the texel's area, and one from what it hits
/// to the light. Mean over `rays` of the weight of direction j.
double brute_force(const RunGrid& grid, const std::array<float, 2>& low, float size, const Vector& to_viewer,
                   uint32_t j, std::mt19937& random, int rays) {
    static const LocalDirections directions(BTF_DIRECTIONS_ACROSS);
    const GridDirection& d = directions.direction(j);
    const double to_light[3] = {d[0] * 100.0, d[1] * 100.0, d[2] * 1000.0};
    std::uniform_real_distribution<double> unit(0, 1);
    double sum = 0;
    int hits = 0;
    for (int i = 0; i < rays; ++i) {
        const double u = (low[0] + size * unit(random)) * grid.width();
        const double v = (low[1] + size * unit(random)) * grid.height();
        const double direction[3] = {-to_viewer[0] * 100.0, -to_viewer[1] * 100.0, -to_viewer[2] * 1000.0};
        const double t = -1000 / (1000.0 * to_viewer[2]);
        const double origin[3] = {u + t * direction[0], v + t * direction[1], t * direction[2]};
        const auto hit = facade::cast_facade_ray(grid, origin, direction);
        if (!hit.hit) continue;
        ++hits;
        double at[3] = {0, 0, 0};
        for (size_t k = 0; k < 3; ++k) at[k] = origin[k] + hit.t * direction[k];
        at[hit.normal_axis] += hit.normal_sign * (hit.normal_axis == 2 ? 0.5 : 0.05);
        const uint32_t face = relief_face(hit.normal_axis, hit.normal_sign);
        if (relief_weights()[face][j] != 0 && !facade::cast_facade_ray(grid, at, to_light).hit)
            sum += relief_weights()[face][j] / 65536.0;
    }
    return hits > 0 ? sum / hits : 0;
}

TEST(Btf, OfAWindowIsWhatRaysSay) {
    const RunGrid grid = window_relief(false);
    const std::vector<uint32_t> words = btf_of(grid, {8, 8});
    const auto btf = BtfView::create(words);
    ASSERT_TRUE(btf.ok());
    std::mt19937 random(4);
    double squares = 0, difference = 0, mean = 0, plain_squares = 0;
    constexpr int kPlaces = 6000;
    for (int i = 0; i < kPlaces; ++i) {
        // Inside: beyond the edges rays and the BTF see different things by definition.
        const auto below = [&](uint32_t count) { return static_cast<uint32_t>(random() % count); };
        const uint32_t x = 2 + below(4), y = 2 + below(4), view = below(64), j = below(64);
        const Vector e = table_direction(view_table(words), view);
        const float got = static_cast<float>(btf->byte(view, y * 8 + x, j)) * kStep;
        const double wanted =
            brute_force(grid, {static_cast<float>(x) / 8, static_cast<float>(y) / 8}, 0.125F, e, j, random, 100);
        const double plain = relief_weights()[RELIEF_FACE_FRONT][j] / 65536.0;
        squares += (got - wanted) * (got - wanted);
        plain_squares += (plain - wanted) * (plain - wanted);
        difference += got - wanted;
        mean += wanted;
    }
    std::printf("{\"rms\":%.4f,\"plain_rms\":%.4f,\"bias\":%.4f,\"mean\":%.4f}\n", std::sqrt(squares / kPlaces),
                std::sqrt(plain_squares / kPlaces), difference / kPlaces, mean / kPlaces);
    EXPECT_LT(std::sqrt(squares / kPlaces), 0.1);
    EXPECT_LT(std::sqrt(squares), 0.5 * std::sqrt(plain_squares));
    EXPECT_NEAR(difference / mean, 0, 0.02);
}

// The sum over slots by shares is what each slot's own rays give, where light comes alike from everywhere.
TEST(Btf, SlotsHaveTheirSharesOfTheLight) {
    const RunGrid grid = relief_facade(160, 80, {{0, 0, 40, 80, 0, 1}, {40, 0, 160, 80, 0, 2}});
    const std::vector<uint32_t> words = btf_of(grid, {4, 4});
    const auto btf = BtfView::create(words);
    ASSERT_TRUE(btf.ok());
    EXPECT_EQ(btf->slots(), 6U);
    for (uint32_t view = 0; view < 16; ++view) {
        EXPECT_EQ(btf->slot_byte(view, 0, 1), 255U);
        EXPECT_EQ(btf->slot_byte(view, 1, 2), 255U);
        // Of the whole patch.
        EXPECT_NEAR(btf->slot_byte(view, btf->shape().first_texel(2), 1), 64, 1);
        EXPECT_NEAR(btf->slot_byte(view, btf->shape().first_texel(2), 2), 191, 1);
    }
}

TEST(Btf, MipsKeepTheMean) {
    const RunGrid grid = window_relief(false);
    const std::vector<uint32_t> words = btf_of(grid, {16, 4});
    const auto btf = BtfView::create(words);
    ASSERT_TRUE(btf.ok());
    const BtfShape& shape = btf->shape();
    double drift = 0;
    for (uint32_t view = 0; view < shape.views(); ++view) {
        for (uint32_t j = 0; j < BTF_DIRECTIONS; ++j) {
            double sum = 0;
            for (uint32_t texel = 0; texel < 256; ++texel) sum += btf->byte(view, texel, j);
            const double coarsest = btf->byte(view, shape.first_texel(4), j);
            EXPECT_NEAR(coarsest, sum / 256, 2);
            drift += (coarsest - sum / 256) / (BTF_DIRECTIONS * shape.views());
        }
    }
    EXPECT_NEAR(drift, 0, 0.1);
}

TEST(Btf, OpenTexelsAreNotCoveredAndDoNotDarken) {
    const RunGrid grid = relief_facade(160, 80, {{80, 0, 160, 80, facade::kOpenDisplacement, 0}, {0, 0, 80, 80, 0, 3}});
    const std::vector<uint32_t> words = btf_of(grid, {8, 4});
    const auto btf = BtfView::create(words);
    ASSERT_TRUE(btf.ok());
    const BtfPlace wall = btf->place({0.2F, 0.5F}, {0, 0, 1}), open = btf->place({0.9F, 0.5F}, {0, 0, 1});
    EXPECT_NEAR(btf->coverage(wall), 1, 1e-5);
    EXPECT_NEAR(btf->coverage(open), 0, 0.01);
    // Half of the whole patch, which is as bright as the wall.
    const BtfPlace all = btf->place({0.5F, 0.5F}, {0, 0, 1}, 3);
    EXPECT_NEAR(btf->coverage(all), 0.5, 0.1);
    EXPECT_NEAR(btf->openness(all), btf->openness(wall), 0.03);
}

TEST(Btf, OfAnOpenMapShowsNothing) {
    const std::vector<uint32_t> words =
        btf_of(relief_facade(20, 30, {{0, 0, 20, 30, facade::kOpenDisplacement, 0}}), {4, 4});
    const auto btf = BtfView::create(words);
    ASSERT_TRUE(btf.ok());
    EXPECT_EQ(btf->slots(), 0U);
    const BtfPlace place = btf->place({0.5F, 0.5F}, {0.3F, 0.2F, 0.9F}, 1);
    EXPECT_EQ(btf->coverage(place), 0);
    EXPECT_EQ(btf->openness(place), 0);
    for (const float share : btf->slot_shares(place)) EXPECT_EQ(share, 0);
}

// No texel of another direction, view or mip is read, at the borders of blocks neither.
TEST(Btf, BlocksDoNotBleed) {
    const BtfOptions options{8, 4};
    for (const uint32_t direction : {0u, 27u, 63u}) {
        std::vector<uint32_t> words = empty_btf(options);
        const BtfShape shape = BtfView::create(words)->shape();
        for (uint32_t view = 0; view < shape.views(); ++view) {
            for (uint32_t texel = 0; texel < shape.first_texel(1); ++texel)
                words[shape.record_word(view, texel) + direction / 4] |= 255u << 8 * (direction % 4);
        }
        const auto btf = BtfView::create(words);
        ASSERT_TRUE(btf.ok());
        std::mt19937 random(6);
        for (int i = 0; i < 500; ++i) {
            const float u = -0.5F + static_cast<float>(i % 21) / 10, v = -0.5F + static_cast<float>(i % 20) / 10;
            const Vector e = random_direction(random);
            const BtfPlace place = btf->place({u, v}, e), coarser = btf->place({u, v}, e, 1);
            for (uint32_t j = 0; j < BTF_DIRECTIONS; ++j) {
                ASSERT_NEAR(btf->value(place, j), j == direction ? 1 : 0, 1e-5) << u << " " << v;
                ASSERT_EQ(btf->value(coarser, j), 0);
            }
        }
    }
}

TEST(Btf, IsInterpolatedBetweenTexelsAndEndsAtItsBorder) {
    std::vector<uint32_t> words = empty_btf({4, 4});
    const BtfShape shape = BtfView::create(words)->shape();
    for (uint32_t view = 0; view < shape.views(); ++view) {
        for (uint32_t texel = 0; texel < 16; ++texel) words[shape.record_word(view, texel)] = 60 * (texel % 4);
    }
    const auto btf = BtfView::create(words);
    ASSERT_TRUE(btf.ok());
    const auto at = [&](float u) { return 255 * btf->value(btf->place({u, 0.6F}, {0.2F, 0.1F, 0.9F}), 0); };
    EXPECT_NEAR(at(0.125F), 0, 1e-3);
    EXPECT_NEAR(at(0.375F), 60, 1e-3);
    EXPECT_NEAR(at(0.25F), 30, 1e-3);
    EXPECT_NEAR(at(0.7F), 138, 1e-2);
    EXPECT_NEAR(at(0.01F), 0, 1e-3);
    EXPECT_NEAR(at(0.99F), 180, 1e-3);
    EXPECT_NEAR(at(7), 180, 1e-3);
    EXPECT_NEAR(at(std::numeric_limits<float>::quiet_NaN()), at(7), 180.1);
    EXPECT_TRUE(std::isfinite(at(std::numeric_limits<float>::infinity())));
}

TEST(BtfShape, NumbersOfItsWordsDoNotMeet) {
    for (const uint32_t patch : {4u, 8u, 16u, 32u, 64u}) {
        for (const uint32_t views : {4u, 5u, 8u, 12u, 16u}) {
            for (const bool open : {false, true}) {
                const auto shape = btf_shape({patch, views}, open);
                ASSERT_TRUE(shape.ok());
                EXPECT_EQ(shape->first_texel(0), 0U);
                uint32_t texels = 0;
                for (uint32_t mip = 0; mip < shape->mips(); ++mip) {
                    EXPECT_EQ(shape->first_texel(mip), texels);
                    texels += (patch >> mip) * (patch >> mip);
                }
                EXPECT_LE(texels, shape->texels_per_view());
                EXPECT_EQ(shape->texels_per_view() % 4, 0U);
                EXPECT_EQ(shape->record_word(0, 0), shape->records_word());
                EXPECT_EQ(shape->record_word(1, 0), shape->record_word(0, shape->texels_per_view()));
                const uint64_t end =
                    shape->record_word(views * views - 1, shape->texels_per_view() - 1) + BTF_RECORD_WORDS;
                EXPECT_EQ(end, open ? shape->coverage_word() : shape->words());
                EXPECT_EQ(shape->words() - end, open ? shape->records() / 4 : 0);
                EXPECT_LT(shape->words(), uint64_t{1} << 31);
            }
        }
    }
    // 64 directions x 144 views x 64 x 64 texels: more than 2^25 bytes, exactly where they should be.
    const auto shape = btf_shape({64, 12}, false);
    EXPECT_EQ(shape->record_word(143, 4095) - shape->records_word(), (uint64_t{143} * 5464 + 4095) * BTF_RECORD_WORDS);
}

TEST(BtfShape, RefusesOptionsOutOfRange) {
    for (const uint32_t patch : {0u, 1u, 2u, 3u, 12u, 128u, ~0u}) EXPECT_FALSE(btf_shape({patch, 8}, false).ok());
    for (const uint32_t views : {0u, 3u, 17u, ~0u}) EXPECT_FALSE(btf_shape({16, views}, false).ok());
    const std::vector<uint32_t> mask = make_relief_mask(relief_facade(20, 20, {}));
    EXPECT_FALSE(make_btf(relief_facade(20, 21, {}), *ReliefMaskView::create(mask)).ok());
}

TEST(BtfView, RefusesWhatIsNoBtf) {
    const std::vector<uint32_t> words = btf_of(window_relief(true), {4, 4});
    ASSERT_TRUE(BtfView::create(words).ok());
    for (size_t count = 0; count < words.size(); ++count)
        ASSERT_FALSE(BtfView::create(std::span(words).first(count)).ok()) << count;
    std::vector<uint32_t> longer = words;
    longer.push_back(0);
    EXPECT_FALSE(BtfView::create(longer).ok());
    for (const uint32_t word : {BTF_WORD_MAGIC, BTF_WORD_SHAPE, BTF_WORD_RECORDS, BTF_WORD_COVERAGE,
                                BTF_DIRECTION_TABLE, BTF_VIEW_TABLE + 2}) {
        for (const uint32_t value : {~0u, 0x7fc00000u, 0xbf800000u}) {
            std::vector<uint32_t> other = words;
            other[word] = value;
            EXPECT_FALSE(BtfView::create(other).ok()) << word << " " << value;
        }
    }
}

TEST(BtfView, SurvivesMutatedWords) {
    const std::vector<uint32_t> words = btf_of(window_relief(true), {4, 4});
    std::mt19937 random(7);
    uint32_t accepted = 0;
    for (int i = 0; i < 2000; ++i) {
        std::vector<uint32_t> other = words;
        const size_t from = i % 2 == 0 ? 0 : BTF_VIEW_TABLE;
        const size_t count = i % 2 == 0 ? BTF_VIEW_TABLE : other.size() - BTF_VIEW_TABLE;
        other[from + random() % count] ^= 1u << random() % 32;
        const auto btf = BtfView::create(other);
        if (!btf.ok()) continue;
        ++accepted;
        const BtfPlace place = btf->place({0.3F, 0.8F}, random_direction(random), static_cast<uint32_t>(random()));
        EXPECT_TRUE(std::isfinite(btf->openness(place)) && std::isfinite(btf->coverage(place)));
    }
    EXPECT_GT(accepted, 100U);
}

TEST(Btf, IsTheSameEachTime) {
    EXPECT_EQ(btf_of(window_relief(true), {8, 5}), btf_of(window_relief(true), {8, 5}));
}

}  // namespace
}  // namespace citystream::codec::radiance
