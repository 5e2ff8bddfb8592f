// The radiance layer by every transport: the same words in GPU memory as from visibility bits, and nothing that bytes
// can do to the reader.
#include "codec/radiance/radiance_transport.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>

#include "codec/bits/range_coder.h"
#include "codec/radiance/bicluster.h"
#include "codec/radiance/distinct_row_set.h"
#include "codec/radiance/radiance_layer.h"
#include "codec/radiance/row_number_code.h"
#include "tests/codec/radiance/lattice_scene.h"
#include "tests/codec/radiance/transfer_cases.h"
#include "tests/hexadecimal.h"

namespace citystream::codec::radiance {
namespace {

using Bytes = std::vector<std::byte>;
using enum RadianceTransport;

constexpr uint64_t kHash = 0x0123456789abcdefu, kManyWords = 1 << 24;
constexpr uint32_t kLocalSide = 4;
constexpr std::array<RadianceTransport, 3> kMatrices = {kBiclusters, kDistinctRows, kRows};

std::vector<RadianceTile> tiles() {
    RadianceTile none;
    none.spacing_log2 = 12;
    none.visibility.side = 8;
    const RadianceTile city = LatticeScene::towers(24, 2, 7).tile(24, 12, 8);
    RadianceTile shut_in = city;
    std::fill(shut_in.visibility.words.begin(), shut_in.visibility.words.end(), 0);
    RadianceTile below_planes = city;
    std::fill(below_planes.visibility.words.begin(), below_planes.visibility.words.end(), ~0u);
    RadianceTile one = LatticeScene({}).tile(8, 12, 3);
    one.places.resize(1);
    one.visibility.frames.resize(1);
    one.visibility = first_receivers(one.visibility, 1);
    return {none, shut_in, below_planes, one, LatticeScene({}).tile(8, 12, 1), city};
}

std::vector<RadianceLayerStep> encoded(const RadianceTile& tile, RadianceTransport transport,
                                       uint32_t local_side = kLocalSide, double bits_error = 0) {
    auto steps = encode_radiance_layer(tile, local_side, kHash, bits_error, transport);
    EXPECT_TRUE(steps.ok()) << steps.error().text();
    return steps ? std::move(*steps) : std::vector<RadianceLayerStep>(1);
}

std::vector<uint32_t> words_of(const std::vector<RadianceLayerStep>& steps, const MatrixOptions& options,
                               MatrixLoss* loss = nullptr) {
    const LayerPrefix whole(steps, steps.size());
    auto words = decode_radiance_layer(whole.steps, whole.decoded_bytes, options, loss);
    EXPECT_TRUE(words.ok()) << words.error().text();
    return words ? std::move(*words) : std::vector<uint32_t>();
}

TEST(RadianceTransport, WordsAreTheSameWhicheverWayTheyTravelled) {
    for (const RadianceTile& tile : tiles()) {
        const auto visibility = encoded(tile, kVisibility);
        EXPECT_EQ(*read_radiance_transport(visibility[0].wire), kVisibility);
        for (const RadianceTransport transport : kMatrices) {
            const auto layer = encoded(tile, transport);
            ASSERT_EQ(layer.size(), 1u);
            EXPECT_EQ(*read_radiance_transport(layer[0].wire), transport);
            EXPECT_EQ(*read_bake_hash(layer[0].wire), kHash);
            EXPECT_EQ(*read_receiver_count(layer[0].wire, layer[0].decoded_bytes), tile.places.size());
            EXPECT_EQ(layer[0].error, 0);
            for (const MatrixOptions& options :
                 {MatrixOptions(MatrixForm::kRows), MatrixOptions(MatrixForm::kBiclusters),
                  MatrixOptions(MatrixForm::kRows, 0.02), MatrixOptions(MatrixForm::kBiclusters, 0.02)}) {
                MatrixLoss loss{1, 1}, wanted_loss;
                const auto words = words_of(layer, options, &loss);
                EXPECT_EQ(words, words_of(visibility, options, &wanted_loss)) << name_of(transport);
                EXPECT_LE(4 * words.size(), layer[0].decoded_bytes);
                EXPECT_EQ(loss.row_error, wanted_loss.row_error);
                EXPECT_EQ(loss.quarters, wanted_loss.quarters);
            }
            EXPECT_EQ(layer[0].decoded_bytes, 4 * words_of(layer, MatrixForm::kRows).size());
        }
    }
}

TEST(RadianceTransport, TellsTheErrorOfTheBitsItIsMadeOf) {
    for (const RadianceTransport transport : kMatrices)
        EXPECT_EQ(encoded(tiles().back(), transport, kLocalSide, 0.125)[0].error, 0.125F);
}

TEST(RadianceTransport, WritesTheSameBytesEachTime) {
    for (const RadianceTransport transport : kMatrices)
        EXPECT_EQ(encoded(tiles().back(), transport)[0].wire, encoded(tiles().back(), transport)[0].wire);
}

TEST(RadianceTransport, AMatrixHasNoBits) {
    for (const RadianceTransport transport : kMatrices) {
        const auto layer = encoded(tiles().back(), transport);
        const LayerPrefix whole(layer, 1);
        const auto tile = decode_radiance_tile(whole.steps, whole.decoded_bytes);
        ASSERT_FALSE(tile.ok());
        EXPECT_NE(tile.error().text().find(name_of(transport)), std::string::npos) << tile.error().text();
    }
}

TEST(RadianceTransport, KeepsTheBytesOfItsFormatPage) {
    RadianceTile tile;
    tile.spacing_log2 = 12;
    tile.places = {{4, {0, 0}, 0, {}}, {4, {1, 0}, 0, {}}};
    tile.visibility = cast_rays({{{0, 0, 0}, {0, 0, 1}}, {{1, 0, 0}, {0, 0, 1}}}, 4, 0,
                                [](const Receiver& r, const Point& d) { return d[0] < (r.position[0] + 1) * d[2]; });
    const std::string places = "0103000000ab6455";
    EXPECT_EQ(
        test::hexadecimal(encoded(tile, kBiclusters, 1)[0].wire),
        "efcdab89674523012c" + places + "8aafa9a761236d6e031d8c31c43109a1681517013ed7a6b96a94a399312e9e700017e2f744");
    EXPECT_EQ(test::hexadecimal(encoded(tile, kDistinctRows, 1)[0].wire),
              "efcdab89674523014c" + places + "8aafa3cb6d94b67fa29339ff7ac99205b574a6152c169a71abe0470d5466503c25");
    EXPECT_EQ(test::hexadecimal(encoded(tile, kRows, 1)[0].wire),
              "efcdab89674523016c" + places + "8aafa3ffe6296cff467263feef55247bde13cf7f2527a527387b3cbda01c1133");
    for (const RadianceTransport transport : kMatrices) EXPECT_EQ(encoded(tile, transport, 1)[0].decoded_bytes, 340u);
}

/// Whether a layer can be read; of words that come out, that a view takes them.
bool reads(const std::vector<std::span<const std::byte>>& steps, uint64_t decoded_bytes, const MatrixOptions& options) {
    const auto words = decode_radiance_layer(steps, decoded_bytes, options);
    if (!words) return false;
    EXPECT_LE(4 * words->size(), decoded_bytes);
    EXPECT_TRUE(RadianceLayerView::create(*words).ok());
    return true;
}

TEST(RadianceTransport, RefusesTruncationsAndWhatFollows) {
    const RadianceTile tile = LatticeScene::towers(16, 1, 3).tile(16, 12, 2);
    for (const RadianceTransport transport : kMatrices) {
        const auto layer = encoded(tile, transport, 2);
        const Bytes& whole = layer[0].wire;
        const auto is_read = [&](const std::vector<std::span<const std::byte>>& steps) {
            return reads(steps, layer[0].decoded_bytes, MatrixForm::kRows) ||
                   (transport == kBiclusters && reads(steps, layer[0].decoded_bytes, MatrixForm::kBiclusters));
        };
        EXPECT_TRUE(is_read({whole}));
        // Where a message's end takes hardly any bytes, its beginning may by chance be another one.
        size_t refused = 0;
        for (size_t size = 0; size < whole.size(); ++size) refused += is_read({std::span(whole).first(size)}) ? 0 : 1;
        EXPECT_GE(refused, whole.size() * 97 / 100) << name_of(transport);
        Bytes longer = whole;
        longer.insert(longer.end(), 8, std::byte{0x55});
        EXPECT_FALSE(is_read({longer}));
        EXPECT_FALSE(is_read({whole, whole}));
        Bytes later = whole;
        later[8] |= std::byte{0x80};
        EXPECT_FALSE(is_read({later})) << "a transport that is none";
    }
}

TEST(RadianceTransport, TakesNoMoreThanItsDecodedBytes) {
    const RadianceTile tile = tiles().back();
    for (const RadianceTransport transport : kMatrices) {
        const auto layer = encoded(tile, transport);
        const std::vector<std::span<const std::byte>> steps = {layer[0].wire};
        for (const MatrixForm form : {MatrixForm::kRows, MatrixForm::kBiclusters}) {
            const uint64_t bytes = 4 * words_of(layer, form).size();
            EXPECT_TRUE(decode_radiance_layer(steps, bytes, form).ok());
            for (const uint64_t less : {bytes - 4, bytes / 2, uint64_t{200}, uint64_t{0}})
                EXPECT_FALSE(decode_radiance_layer(steps, less, form).ok()) << name_of(transport) << ' ' << less;
        }
    }
}

TEST(RadianceTransport, SurvivesEveryMutation) {
    const RadianceTile tile = LatticeScene::towers(16, 1, 3).tile(16, 12, 2);
    std::mt19937_64 random(5);
    for (const RadianceTransport transport : kMatrices) {
        const auto layer = encoded(tile, transport, 2);
        size_t refused = 0;
        for (int i = 0; i < 500; ++i) {
            Bytes bytes = layer[0].wire;
            const size_t changes = 1 + random() % 4;
            for (size_t change = 0; change < changes; ++change)
                bytes[random() % bytes.size()] = static_cast<std::byte>(random());
            // Other transports than these are searched for clusters.
            const bool clusters = transport == kBiclusters ? i % 2 == 0 : i % 64 == 0;
            const MatrixOptions options(clusters ? MatrixForm::kBiclusters : MatrixForm::kRows, i % 32 == 1 ? 0.1 : 0);
            refused += reads({bytes}, layer[0].decoded_bytes, options) ? 0 : 1;
        }
        EXPECT_GT(refused, 150u) << name_of(transport);
    }
}

/// A small matrix that receivers can have.
DistinctRows some_rows() {
    return distinct_rows(make_transfer(first_receivers(TowerCity().visibility(64, 4), 12), LocalDirections(3)));
}

MatrixBounds bounds_of(const DistinctRows& distinct, uint32_t local_count) {
    return {static_cast<uint32_t>(distinct.row_of.size()) / local_count, local_count, kManyWords};
}

TEST(MatrixRows, ComeBackFromEveryTransport) {
    const DistinctRows rows = some_rows();
    const auto check = [&](RadianceTransport transport, const Bytes& bytes) {
        const auto back = decode_matrix_rows(transport, bytes, bounds_of(rows, 9));
        ASSERT_TRUE(back.ok()) << back.error().text();
        EXPECT_EQ(back->rows, rows.rows);
        EXPECT_EQ(back->row_of, rows.row_of);
    };
    for (const RadianceTransport transport : {kDistinctRows, kRows})
        check(transport, encode_matrix(transport, rows, 9));
    const ClusteredRows clustered{find_biclusters(rows.rows, {}), rows.row_of};
    const Bytes bytes = encode_clustered_rows(clustered, 9);
    check(kBiclusters, bytes);
    const auto back = decode_matrix_clusters(bytes, bounds_of(rows, 9));
    ASSERT_TRUE(back.ok());
    EXPECT_EQ(back->clusters, clustered.clusters);
    EXPECT_EQ(back->row_of, clustered.row_of);
}

TEST(MatrixRows, AreRefusedWhereTheyAreNotThoseOfTheirPlaces) {
    const DistinctRows rows = some_rows();
    const MatrixBounds good = bounds_of(rows, 9);
    const Bytes clusters = encode_clustered_rows({find_biclusters(rows.rows, {}), rows.row_of}, 9);
    for (const RadianceTransport transport : kMatrices) {
        const Bytes bytes = transport == kBiclusters ? clusters : encode_matrix(transport, rows, 9);
        EXPECT_TRUE(decode_matrix_rows(transport, bytes, good).ok());
        for (const MatrixBounds& wrong :
             {MatrixBounds{good.receivers - 1, 9, kManyWords}, MatrixBounds{good.receivers + 1, 9, kManyWords},
              MatrixBounds{9 * good.receivers, 1, kManyWords}, MatrixBounds{good.receivers, 9, 20}})
            EXPECT_FALSE(decode_matrix_rows(transport, bytes, wrong).ok()) << name_of(transport);
    }
    EXPECT_FALSE(decode_matrix_clusters(clusters, {good.receivers, 9, 20}).ok());
}

TEST(MatrixRows, AreRefusedWhereNoReceiverHasThem) {
    const auto refused = [](const Transfer& transfer, uint32_t local_count) {
        const DistinctRows rows = distinct_rows(transfer);
        const MatrixBounds bounds = bounds_of(rows, local_count);
        const Bytes clusters = encode_clustered_rows({find_biclusters(rows.rows, {}), rows.row_of}, local_count);
        return !decode_matrix_rows(kRows, encode_matrix(kRows, rows, local_count), bounds).ok() &&
               !decode_matrix_rows(kDistinctRows, encode_matrix(kDistinctRows, rows, local_count), bounds).ok() &&
               !decode_matrix_rows(kBiclusters, clusters, bounds).ok();
    };
    EXPECT_FALSE(refused(from_dense(6, {{4, 0, 1, 0, 2, 3}}), 1));
    EXPECT_TRUE(refused(from_dense(6, {{4, 0, 5, 0, 2, 3}}), 1)) << "more quarters than a texel has";
    EXPECT_TRUE(refused(from_dense(6, {{4, 0, -1, 0, 2, 3}}), 1));
    EXPECT_TRUE(refused(from_dense(7, {{4, 0, 1, 0, 2, 3, 0}}), 1)) << "columns that are no cube's";
    // Five local directions that see all of six texels are one row, but more entries than there are samples.
    const DistinctRows rows = distinct_rows(from_dense(6, std::vector<std::vector<int>>(5, {1, 1, 1, 1, 1, 1})));
    EXPECT_FALSE(decode_matrix_rows(kRows, encode_matrix(kRows, rows, 5), bounds_of(rows, 5)).ok());
}

/// Many clusters of which each takes back what the one before has given.
TEST(MatrixClusters, ThatOverlapTooMuchAreNotAddedUp) {
    constexpr uint32_t kTexels = 96, kRowCount = 64, kClusters = 21;
    ClusteredRows clustered;
    clustered.clusters.rows = kRowCount;
    clustered.clusters.columns = kTexels;
    std::vector<uint16_t> columns(kTexels);
    for (uint16_t k = 0; k < kTexels; ++k) columns[k] = k;
    for (uint32_t j = 0; j < kRowCount; ++j) clustered.row_of.push_back(j);
    for (uint32_t i = 0; i < kClusters; ++i)
        clustered.clusters.add(clustered.row_of, columns, std::vector<int8_t>(kTexels, i % 2 == 0 ? 1 : -1));
    const Bytes bytes = encode_clustered_rows(clustered, kRowCount);
    EXPECT_TRUE(decode_matrix_rows(kBiclusters, bytes, {1, kRowCount, kManyWords}).ok());
    // Bits of clusters and of columns: so many words have room for the clusters alone.
    const uint64_t words = kClusters * (5 * kRowCount + 7 * kTexels) / 32;
    EXPECT_TRUE(decode_matrix_clusters(bytes, {1, kRowCount, words}).ok());
    EXPECT_FALSE(decode_matrix_clusters(bytes, {1, kRowCount, words - 1}).ok());
    const auto sum = decode_matrix_rows(kBiclusters, bytes, {1, kRowCount, words});
    ASSERT_FALSE(sum.ok());
    EXPECT_NE(sum.error().text().find("too long"), std::string::npos) << sum.error().text();
}

/// Two equal rows of one direction, and a cluster of one entry that names a row of the whole.
Bytes cluster_of_row(uint32_t row) {
    bits::RangeEncoder encoder;
    uint32_t local_count = 1, receivers = 2, columns = 6;
    EXPECT_TRUE(code_matrix_size(encoder, {}, local_count, receivers, columns));
    RowNumberCode numbers(local_count);
    numbers.code(encoder, 0, 0, 0);
    numbers.code(encoder, 0, 1, 0);
    bits::NumberModel clusters, row_count, first;
    clusters.code(encoder, 1);
    row_count.code(encoder, 0);
    first.code(encoder, row);
    SparseRow entries{{1}, {4}};
    SparseRowCode(columns, local_count).code(encoder, 0, ~uint64_t{0}, entries);
    return encoder.finish();
}

TEST(MatrixClusters, AreRefusedWithRowsThatAreNoFirstUse) {
    ClusteredRows clustered{{}, {0, 0}};
    clustered.clusters.rows = 1;
    clustered.clusters.columns = 6;
    clustered.clusters.add(std::vector<uint32_t>{0}, std::vector<uint16_t>{1}, std::vector<int8_t>{4});
    EXPECT_EQ(cluster_of_row(0), encode_clustered_rows(clustered, 1));
    const auto good = decode_matrix_clusters(cluster_of_row(0), {2, 1, kManyWords});
    ASSERT_TRUE(good.ok());
    EXPECT_EQ(good->clusters, clustered.clusters);
    const auto wrong = decode_matrix_clusters(cluster_of_row(1), {2, 1, kManyWords});
    ASSERT_FALSE(wrong.ok());
    EXPECT_NE(wrong.error().text().find("told elsewhere"), std::string::npos) << wrong.error().text();
}

TEST(DistinctRowSet, MakesWhatTheWholeGives) {
    for (const TransferCase& c : transfer_cases()) {
        DistinctRowSet set(c.transfer.columns);
        for (uint32_t j = 0; j < c.transfer.rows(); ++j) {
            const SparseRow row = row_of(c.transfer, j);
            set.add(row.columns, row.values);
        }
        const DistinctRows wanted = distinct_rows(c.transfer);
        EXPECT_EQ(set.nonzeros(), wanted.rows.nonzeros()) << c.name;
        const DistinctRows made = set.take();
        EXPECT_EQ(made.rows, wanted.rows) << c.name;
        EXPECT_EQ(made.row_of, wanted.row_of) << c.name;
    }
}

}  // namespace
}  // namespace citystream::codec::radiance
