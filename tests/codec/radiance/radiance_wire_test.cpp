// The wires of a radiance layer: what goes in comes out, small, the same bytes each time, and nothing that bytes can do
// to the reader.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "codec/radiance/bicluster.h"
#include "codec/radiance/bicluster_wire.h"
#include "codec/radiance/csr_wire.h"
#include "codec/radiance/row_wire.h"
#include "codec/radiance/visibility_wire.h"
#include "tests/codec/radiance/transfer_cases.h"
#include "tests/hexadecimal.h"

namespace citystream::codec::radiance {
namespace {

using Bytes = std::vector<std::byte>;
using Spans = std::vector<std::span<const std::byte>>;

constexpr RadianceLimits kLimits{4096, 1 << 22};

std::vector<VisibilityTile> tiles() {
    VisibilityTile blind{4, {}, {}, {}};
    blind.add_receiver(pack_frame({0, 0, 1}));
    VisibilityTile shuffled = noise(9, 4, 8);  // frames not in the order of their use, and one that is not used
    shuffled.frame_of[4] = 5;
    std::reverse(shuffled.frame_of.begin(), shuffled.frame_of.end());
    clear_below_planes(shuffled);
    return {VisibilityTile{8, {}, {}, {}},
            blind,
            open_ground(1),
            open_ground(3),
            open_sphere(30, 8),
            noise(7, 5, 1),
            fence(20, 8),
            shuffled,
            first_receivers(TowerCity().visibility(32, 8), 300),
            first_receivers(TowerCity().visibility(64, 32, 0.3), 30)};
}

Spans first_steps(const std::vector<VisibilityStep>& steps, size_t count) {
    Spans spans;
    for (size_t i = 0; i < count; ++i) spans.push_back(steps[i].bytes);
    return spans;
}

/// What a reader knows before: frames.
VisibilityTile frames_of(VisibilityTile tile) {
    tile.words.clear();
    return tile;
}

/// Without what is not told.
VisibilityTile as_told(VisibilityTile tile) {
    clear_below_planes(tile);
    return tile;
}

/// In hemispheres.
double worst_angle(const VisibilityTile& a, const VisibilityTile& b) {
    double worst = 0;
    for (uint32_t r = 0; r < a.receivers(); ++r) {
        double sum = 0;
        for (uint32_t s = 0; s < sample_count(a.side); ++s)
            sum += a.sees(r, s) != b.sees(r, s) ? cell_solid_angle(2 * a.side, s) : 0;
        worst = std::max(worst, sum / (2 * kPi));
    }
    return worst;
}

TEST(VisibilityWire, BringsEveryBitBackAndLessWithEveryStepLess) {
    for (const VisibilityTile& tile : tiles()) {
        const auto steps = encode_visibility(tile);
        ASSERT_EQ(steps.size(), kVisibilitySteps);
        const auto whole = decode_visibility(frames_of(tile), first_steps(steps, kVisibilitySteps), kLimits);
        ASSERT_TRUE(whole.ok()) << whole.error().text();
        EXPECT_EQ(*whole, as_told(tile));
        EXPECT_EQ(steps.back().error, 0);
        for (size_t count = 1; count < kVisibilitySteps; ++count) {
            const auto part = decode_visibility(frames_of(tile), first_steps(steps, count), kLimits);
            ASSERT_TRUE(part.ok());
            EXPECT_EQ(part->frames, tile.frames);
            EXPECT_EQ(part->frame_of, tile.frame_of);
            EXPECT_NEAR(worst_angle(*part, as_told(tile)), steps[count - 1].error, 1e-4);
            EXPECT_GE(steps[count - 1].error, steps[count].error);
        }
    }
}

TEST(VisibilityWire, TakesAFractionOfTheBits) {
    // 192 bytes of bits a receiver for 8 texels on a side, half of them above its plane.
    const VisibilityTile city = TowerCity().visibility(16, 8);
    size_t bytes = 0;
    for (const auto& step : encode_visibility(city)) bytes += step.bytes.size();
    EXPECT_LT(bytes, 13 * city.receivers());
    const VisibilityTile sphere = open_sphere(200, 8);
    bytes = 0;
    for (const auto& step : encode_visibility(sphere)) bytes += step.bytes.size();
    EXPECT_LT(bytes, 2 * sphere.receivers());
}

TEST(VisibilityWire, WritesTheSameBytesWhateverIsBelowThePlanes) {
    VisibilityTile tile = open_sphere(9, 8);
    const auto steps = encode_visibility(tile);
    std::fill(tile.words.begin(), tile.words.end(), ~0u);
    const auto again = encode_visibility(tile);
    for (uint32_t i = 0; i < kVisibilitySteps; ++i) EXPECT_EQ(steps[i].bytes, again[i].bytes);
}

TEST(VisibilityWire, SaysThatBytesAreOfAnotherVersion) {
    const VisibilityTile tile = open_ground(2);
    auto steps = encode_visibility(tile);
    for (const uint32_t version : {0u, 1u, 3u}) {
        for (const uint32_t side : {1u, 8u, 64u}) {
            steps[0].bytes[0] = static_cast<std::byte>(version << 6 | (side - 1));
            const auto read = decode_visibility(frames_of(tile), first_steps(steps, kVisibilitySteps), kLimits);
            ASSERT_FALSE(read.ok());
            EXPECT_NE(read.error().text().find("another version"), std::string::npos) << read.error().text();
        }
    }
}

/// Each codec as a function of bytes that says whether they are good.
struct Wire {
    std::string name;
    Bytes bytes;
    std::function<bool(std::span<const std::byte>)> reads;
};

std::vector<Wire> some_wires() {
    const Transfer t = make_transfer(first_receivers(TowerCity().visibility(64, 4), 12), LocalDirections(3));
    std::vector<Wire> wires;
    wires.push_back({"biclusters", encode_biclusters(find_biclusters(t, {}), 9),
                     [](auto bytes) { return decode_biclusters(bytes, kLimits).ok(); }});
    wires.push_back({"rows", encode_rows(t, 9), [](auto bytes) { return decode_rows(bytes, kLimits).ok(); }});
    wires.push_back({"distinct rows", encode_distinct_rows(distinct_rows(t), 9),
                     [](auto bytes) { return decode_distinct_rows(bytes, kLimits).ok(); }});
    static const VisibilityTile tile = first_receivers(TowerCity().visibility(64, 4), 12);
    static const auto steps = encode_visibility(tile);
    for (uint32_t i = 0; i < kVisibilitySteps; ++i) {
        wires.push_back({"visibility", steps[i].bytes, [i](std::span<const std::byte> bytes) {
                             Spans spans = first_steps(steps, kVisibilitySteps);
                             spans[i] = bytes;
                             return decode_visibility(frames_of(tile), spans, kLimits).ok();
                         }});
    }
    return wires;
}

TEST(RadianceWires, RefuseEveryTruncationAndWhatFollows) {
    for (const Wire& wire : some_wires()) {
        EXPECT_TRUE(wire.reads(wire.bytes)) << wire.name;
        // A message may end in bytes that are not needed to tell it from its beginning, at most the padding.
        for (size_t size = 0; size + bits::RangeDecoder::kPaddingBytes < wire.bytes.size(); ++size) {
            const Bytes part(wire.bytes.begin(), wire.bytes.begin() + static_cast<std::ptrdiff_t>(size));
            EXPECT_FALSE(wire.reads(part)) << wire.name << ' ' << size;
        }
        Bytes longer = wire.bytes;
        longer.insert(longer.end(), 8, std::byte{0x55});
        EXPECT_FALSE(wire.reads(longer)) << wire.name;
    }
}

TEST(RadianceWires, SurviveEveryFlippedBit) {
    for (const Wire& wire : some_wires()) {
        Bytes bytes = wire.bytes;
        for (size_t i = 0; i < 8 * std::min<size_t>(bytes.size(), 200); ++i) {
            const auto bit = static_cast<std::byte>(1u << i % 8);
            bytes[i / 8] ^= bit;
            wire.reads(bytes);
            bytes[i / 8] ^= bit;
        }
    }
}

TEST(RadianceWires, MakeNoMoreThanTheirLimitsAllow) {
    const Transfer t = make_transfer(first_receivers(TowerCity().visibility(64, 4), 12), LocalDirections(3));
    const Biclusters clusters = find_biclusters(t, {});
    const Bytes bytes = encode_biclusters(clusters, 9);
    EXPECT_FALSE(decode_biclusters(bytes, {11, 1 << 20}).ok());
    EXPECT_FALSE(decode_biclusters(bytes, {12, clusters.row.size() + clusters.column.size() - 1}).ok());
    EXPECT_TRUE(decode_biclusters(bytes, {12, clusters.row.size() + clusters.column.size()}).ok());
    const Bytes rows = encode_rows(t, 9);
    EXPECT_FALSE(decode_rows(rows, {11, 1 << 20}).ok());
    EXPECT_FALSE(decode_rows(rows, {12, t.nonzeros() - 1}).ok());
    EXPECT_TRUE(decode_rows(rows, {12, t.nonzeros()}).ok());
    const DistinctRows distinct = distinct_rows(t);
    const Bytes distinct_bytes = encode_distinct_rows(distinct, 9);
    EXPECT_FALSE(decode_distinct_rows(distinct_bytes, {12, distinct.rows.nonzeros() - 1}).ok());
    EXPECT_TRUE(decode_distinct_rows(distinct_bytes, {12, distinct.rows.nonzeros()}).ok());
    const VisibilityTile tile = noise(3, 4, 1);
    const auto steps = encode_visibility(tile);
    EXPECT_FALSE(decode_visibility(frames_of(tile), first_steps(steps, 3), {2, 1 << 20}).ok());
    EXPECT_FALSE(decode_visibility(frames_of(tile), first_steps(steps, 3), {3, tile.words.size() - 1}).ok());
    EXPECT_TRUE(decode_visibility(frames_of(tile), first_steps(steps, 3), {3, tile.words.size()}).ok());
    EXPECT_FALSE(decode_visibility({}, {}, kLimits).ok());
}

TEST(RadianceWires, KeepTheBytesOfTheirFormatPage) {
    const VisibilityTile tile =
        cast_rays({{{0, 0, 0}, {0, 0, 1}}, {{1, 0, 0}, {0, 0, 1}}}, 4, 0,
                  [](const Receiver& r, const Point& d) { return d[0] < (r.position[0] + 1) * d[2]; });
    const auto steps = encode_visibility(tile);
    EXPECT_EQ(test::hexadecimal(steps[0].bytes), "83ffffca0875fe56");
    EXPECT_EQ(test::hexadecimal(steps[1].bytes), "77078dacd26a");
    EXPECT_EQ(test::hexadecimal(steps[2].bytes), "cad35913");
    EXPECT_NEAR(steps[0].error, 0.1667, 5e-5);
    EXPECT_NEAR(steps[1].error, 0.0512, 5e-5);
    const Transfer t = make_transfer(tile, LocalDirections(1));
    EXPECT_EQ(test::hexadecimal(encode_biclusters(find_biclusters(t, {}), 1)),
              "8aafa6e7e2a8f74ae7f5643fa538c926b88ec13479972b671929bc2f4a142431066c90d74a");
    EXPECT_EQ(test::hexadecimal(encode_rows(t, 1)), "8aafa3ffe6296cff467263feef55247bde13cf7f2527a527387b3cbda01c1133");
    EXPECT_EQ(test::hexadecimal(encode_distinct_rows(distinct_rows(t), 1)),
              "8aafa3cb6d94b67fa29339ff7ac99205b574a6152c169a71abe0470d5466503c25");
}

TEST(RadianceWires, BringEveryMatrixBack) {
    for (const TransferCase& c : transfer_cases()) {
        const auto rows = decode_rows(encode_rows(c.transfer, c.local_count), kLimits);
        ASSERT_TRUE(rows.ok()) << c.name;
        EXPECT_EQ(*rows, c.transfer) << c.name;
        const DistinctRows distinct = distinct_rows(c.transfer);
        const auto again = decode_distinct_rows(encode_distinct_rows(distinct, c.local_count), kLimits);
        ASSERT_TRUE(again.ok()) << c.name;
        EXPECT_EQ(again->rows, distinct.rows) << c.name;
        EXPECT_EQ(again->row_of, distinct.row_of) << c.name;
        for (const Seeding seeding : {Seeding::kEntry, Seeding::kRow}) {
            const Biclusters clusters = find_biclusters(c.transfer, {seeding, 1, 0});
            const auto decoded = decode_biclusters(encode_biclusters(clusters, c.local_count), kLimits);
            ASSERT_TRUE(decoded.ok()) << c.name << decoded.error().text();
            EXPECT_EQ(decoded->clusters, clusters) << c.name;
            EXPECT_EQ(decoded->local_count, c.local_count);
        }
    }
}

}  // namespace
}  // namespace citystream::codec::radiance
