// Biclusters add up to their matrix, never cost more than its entries, and keep to the error they may have.
#include "codec/radiance/bicluster.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "codec/radiance/bicluster_search.h"
#include "codec/radiance/bicluster_wire.h"
#include "tests/codec/radiance/transfer_cases.h"

namespace citystream::codec::radiance {
namespace {

using Dense = std::vector<std::vector<int>>;

constexpr Seeding kSeedings[] = {Seeding::kEntry, Seeding::kRow};

Dense dense_of(const ShrinkingMatrix& matrix) {
    Dense dense(matrix.rows(), std::vector<int>(matrix.columns(), 0));
    for (uint32_t j = 0; j < matrix.rows(); ++j) {
        for (const uint32_t e : matrix.row(j)) dense[j][ShrinkingMatrix::line_of(e)] = +ShrinkingMatrix::value_of(e);
    }
    return dense;
}

struct DenseCluster {
    std::vector<uint32_t> rows, columns;
    std::vector<int> values;  ///< of the columns
};

DenseCluster cluster_of(const BiclusterSearch& search) {
    DenseCluster c{
        {search.rows().begin(), search.rows().end()}, {search.columns().begin(), search.columns().end()}, {}};
    for (const uint32_t k : c.columns) c.values.push_back(search.value(k));
    return c;
}

/// Equation 9, from the matrix.
int64_t saved_by(const Dense& matrix, const DenseCluster& c) {
    int64_t nonzeros = 0, residual = 0;
    for (const uint32_t j : c.rows) {
        for (size_t m = 0; m < c.columns.size(); ++m) {
            nonzeros += matrix[j][c.columns[m]] != 0 ? 1 : 0;
            residual += matrix[j][c.columns[m]] != c.values[m] ? 1 : 0;
        }
    }
    return 2 * nonzeros - static_cast<int64_t>(c.rows.size() + 2 * c.columns.size() - 1) - 2 * residual;
}

DenseCluster with_row(DenseCluster c, uint32_t row) {
    const auto place = std::find(c.rows.begin(), c.rows.end(), row);
    if (place == c.rows.end())
        c.rows.push_back(row);
    else
        c.rows.erase(place);
    return c;
}

/// The column inserted with its most frequent nonzero value, or deleted.
DenseCluster with_column(const Dense& matrix, DenseCluster c, uint32_t column) {
    const auto place = std::find(c.columns.begin(), c.columns.end(), column);
    if (place != c.columns.end()) {
        c.values.erase(c.values.begin() + (place - c.columns.begin()));
        c.columns.erase(place);
        return c;
    }
    int best = 0, most = 0;
    for (int v = -128; v < 128; ++v) {
        const auto count = static_cast<int>(
            std::count_if(c.rows.begin(), c.rows.end(), [&](uint32_t j) { return matrix[j][column] == v; }));
        if (v != 0 && count > most) {
            most = count;
            best = v;
        }
    }
    c.columns.push_back(column);
    c.values.push_back(best);
    return c;
}

/// The gain of the best of all operations, and that all keys say the same of theirs.
int64_t best_gain(const Dense& matrix, const BiclusterSearch& search) {
    const DenseCluster c = cluster_of(search);
    const int64_t now = saved_by(matrix, c), r = static_cast<int64_t>(c.rows.size()),
                  l = static_cast<int64_t>(c.columns.size());
    int64_t best = 0;
    for (uint32_t j = 0; j < matrix.size(); ++j) {
        const bool inside = std::find(c.rows.begin(), c.rows.end(), j) != c.rows.end();
        const int64_t gain = saved_by(matrix, with_row(c, j)) - now, key = search.row_key(j);
        EXPECT_EQ(gain, inside ? 2 * l + 1 - 2 * key : 2 * key - 2 * l - 1);
        if (!inside || r > 1) best = std::max(best, gain);
    }
    for (uint32_t k = 0; k < matrix[0].size(); ++k) {
        const bool inside = std::find(c.columns.begin(), c.columns.end(), k) != c.columns.end();
        const DenseCluster other = with_column(matrix, c, k);
        const int64_t key = search.column_key(k);
        if (!inside && other.values.back() == 0) {
            EXPECT_EQ(key, 0);  // no nonzero value to take
            continue;
        }
        const int64_t gain = saved_by(matrix, other) - now;
        EXPECT_EQ(gain, inside ? 2 * r + 2 - 2 * key : 2 * key - 2 * r - 2);
        if (!inside || l > 1) best = std::max(best, gain);
    }
    return best;
}

TEST(BiclusterSearch, KeepsKeysThatSayWhatEveryOperationGains) {
    uint32_t deletions = 0, operations = 0;
    for (uint64_t seed = 1; seed <= 200; ++seed) {
        const auto size = [&](uint64_t salt) { return static_cast<uint32_t>(2 + (seed * salt) % 39); };
        const Transfer t =
            random_transfer(size(7), size(11), static_cast<uint32_t>(20 + seed % 75), seed % 5 == 0 ? 1 : 4, seed);
        if (t.nonzeros() == 0) continue;
        ShrinkingMatrix matrix(t);
        BiclusterSearch search(matrix);
        for (uint32_t round = 0; round < 4 && matrix.nonzeros() > 0; ++round) {
            const Dense dense = dense_of(matrix);
            const uint32_t row = matrix.filled_rows()[round % matrix.filled_rows().size()];
            if (round % 2 == 0)
                search.begin(row, ShrinkingMatrix::line_of(matrix.row(row)[0]));
            else
                search.begin_row(row);
            for (;;) {
                ASSERT_EQ(search.saved(), saved_by(dense, cluster_of(search)));
                const int64_t expected = best_gain(dense, search);
                const auto operation = search.best();
                ASSERT_EQ(operation.gain, expected);
                if (operation.gain <= 0) break;
                const auto kind = operation.kind;
                using Kind = BiclusterSearch::Kind;
                deletions += kind == Kind::kDeleteRow || kind == Kind::kDeleteColumn ? 1 : 0;
                ++operations;
                search.apply(operation);
            }
            DenseCluster c = cluster_of(search);
            std::sort(c.rows.begin(), c.rows.end());
            std::vector<uint16_t> columns(c.columns.begin(), c.columns.end());
            std::sort(columns.begin(), columns.end());
            std::vector<int8_t> values;
            for (const uint16_t k : columns) values.push_back(search.value(k));
            RowBudgets exact;
            matrix.subtract(c.rows, columns, values, exact);
        }
    }
    EXPECT_GT(operations, 1000u);
    EXPECT_GT(deletions, 20u);
}

TEST(BiclusterSearch, SavesWhatThePapersExampleSaves) {
    const Transfer t = from_dense(4, {{4, 2, 3, 4}, {4, 3, 3, 4}, {4, 2, 3, 0}});
    const Dense dense = dense_of(ShrinkingMatrix(t));
    EXPECT_EQ(saved_by(dense, {{0, 1, 2}, {0, 1, 2, 3}, {4, 2, 3, 4}}), 22 - 10 - 4);
    // One cluster and two entries: less than the 22 of the matrix.
    EXPECT_LE(best_biclusters(t, BiclusterGoal::kFlops, 1).flops(), 14u);
    // What is left when the cluster is taken away.
    ShrinkingMatrix matrix(t);
    const std::vector<uint32_t> rows = {0, 1, 2};
    const std::vector<uint16_t> columns = {0, 1, 2, 3};
    const std::vector<int8_t> values = {4, 2, 3, 4};
    RowBudgets exact;
    matrix.subtract(rows, columns, values, exact);
    EXPECT_EQ(matrix.nonzeros(), 2u);
    EXPECT_EQ(dense_of(matrix), (Dense{{0, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 0, -4}}));
}

void expect_sound(const Biclusters& clusters) {
    for (uint32_t i = 0; i < clusters.count(); ++i) {
        const auto rows = clusters.rows_of(i);
        const auto columns = clusters.columns_of(i);
        ASSERT_FALSE(rows.empty() || columns.empty());
        EXPECT_TRUE(std::adjacent_find(rows.begin(), rows.end(), std::greater_equal<>()) == rows.end());
        EXPECT_TRUE(std::adjacent_find(columns.begin(), columns.end(), std::greater_equal<>()) == columns.end());
        EXPECT_LT(rows.back(), clusters.rows);
        EXPECT_LT(columns.back(), clusters.columns);
        for (const int8_t v : clusters.values_of(i)) EXPECT_NE(v, 0);
        EXPECT_LE(clusters.rows_of(i == 0 ? 0 : i - 1)[0], rows[0]);
    }
}

TEST(Biclusters, AddUpToEveryMatrixAtNoMoreThanItsCost) {
    for (const TransferCase& c : transfer_cases()) {
        for (const Seeding seeding : kSeedings) {
            for (const uint64_t seed : {1, 2, 3}) {
                const Biclusters clusters = find_biclusters(c.transfer, {seeding, seed, 0});
                expect_sound(clusters);
                EXPECT_EQ(sum_of(clusters), c.transfer) << c.name;
                EXPECT_LE(clusters.flops(), c.transfer.flops()) << c.name;
                for (const uint32_t error : row_errors(c.transfer, clusters)) EXPECT_EQ(error, 0u);
            }
        }
    }
}

TEST(Biclusters, OfEqualRowsAreOneAndOfDifferentEntriesMany) {
    for (const Seeding seeding : kSeedings) {
        const Biclusters equal = find_biclusters(from_dense(4, Dense(9, {4, 4, 4, 4})), {seeding, 1, 0});
        EXPECT_EQ(equal.count(), 1u);
        EXPECT_EQ(equal.flops(), 9u + 2 * 4 - 1);
        Dense identity(8, std::vector<int>(8, 0));
        for (size_t j = 0; j < 8; ++j) identity[j][j] = 1;
        EXPECT_EQ(find_biclusters(from_dense(8, identity), {seeding, 1, 0}).flops(), 16u);
    }
    Dense checks(16, std::vector<int>(16, 0));
    for (size_t j = 0; j < 16; ++j) {
        for (size_t k = 0; k < 16; ++k) checks[j][k] = (j + k) % 2 == 0 ? 1 : 0;
    }
    EXPECT_EQ(find_biclusters(from_dense(16, checks), {Seeding::kEntry, 1, 0}).count(), 2u);
}

TEST(Biclusters, AreTheSameForTheSameSeedAndAboutAsGoodForAnother) {
    const Transfer t = make_transfer(TowerCity().visibility(32, 8), LocalDirections(4));
    uint64_t least = ~uint64_t{0}, most = 0;
    for (const uint64_t seed : {1, 2, 3, 4, 5}) {
        const Biclusters clusters = find_biclusters(t, {Seeding::kEntry, seed, 0});
        EXPECT_EQ(find_biclusters(t, {Seeding::kEntry, seed, 0}), clusters);
        least = std::min(least, clusters.flops());
        most = std::max(most, clusters.flops());
    }
    EXPECT_LT(100 * most, 105 * least);
    EXPECT_GT(most, least);
}

TEST(Biclusters, TakeASmallPartOfTheWorkOfACityWhicheverWayItIsTurned) {
    // Half the directions and few receivers: the notes' tile of 4 m needs 6 %, as fewer rows share a cluster here.
    const LocalDirections local(8);
    const TowerCity city;
    for (const double yaw : {0.0, 0.3}) {
        const Transfer t = make_transfer(city.visibility(32, 16, yaw), local);
        const Biclusters clusters = find_biclusters(t, {Seeding::kEntry, 1, 0});
        EXPECT_LT(100 * clusters.flops(), 18 * t.flops());
    }
}

/// FLOPs of a sphere's clusters and of its entries, and the bytes of 4 for each number that the paper's sizes imply.
struct SphereCost {
    double ratio, bytes;
};

SphereCost sphere_cost(uint32_t receivers, uint32_t side, uint32_t local_side) {
    const Transfer t = make_transfer(open_sphere(receivers, side), LocalDirections(local_side));
    const Biclusters clusters = find_biclusters(t, {Seeding::kEntry, 1, 0});
    const auto numbers = static_cast<double>(clusters.row.size() + 2 * clusters.column.size());
    return {static_cast<double>(clusters.flops()) / static_cast<double>(t.flops()), 4 * numbers};
}

TEST(Biclusters, OfASphereGrowSlowlyWithDirectionsAndEvenlyWithReceivers) {
    const SphereCost coarse = sphere_cost(150, 16, 8), fine = sphere_cost(150, 16, 16), many = sphere_cost(450, 16, 8);
    EXPECT_LT(fine.bytes, 1.7 * coarse.bytes);
    EXPECT_LT(many.ratio, coarse.ratio);
    EXPECT_GT(many.ratio, 0.85 * coarse.ratio);
    EXPECT_LT(many.bytes, 3 * coarse.bytes);
    EXPECT_GT(many.bytes, 0.85 * 3 * coarse.bytes);
}

TEST(Biclusters, OfASphereTakeAThirdOfTheWork) {
    EXPECT_LT(sphere_cost(500, 32, 8).ratio, 0.32);
}

TEST(Biclusters, StayWithinTheErrorThatARowMayHave) {
    for (const TransferCase& c : transfer_cases()) {
        uint64_t bytes_before = ~uint64_t{0}, flops_before = ~uint64_t{0};
        for (const uint32_t budget : {0u, 1u, 4u, 16u}) {
            for (const Seeding seeding : kSeedings) {
                const Biclusters clusters = find_biclusters(c.transfer, {seeding, 1, budget});
                expect_sound(clusters);
                for (const uint32_t error : row_errors(c.transfer, clusters)) EXPECT_LE(error, budget) << c.name;
            }
            const Biclusters small = best_biclusters(c.transfer, BiclusterGoal::kBytes, c.local_count, 1, budget);
            const uint64_t bytes = encode_biclusters(small, c.local_count).size();
            const uint64_t flops = best_biclusters(c.transfer, BiclusterGoal::kFlops, c.local_count, 1, budget).flops();
            EXPECT_LE(bytes, bytes_before) << c.name << budget;
            EXPECT_LE(flops, flops_before) << c.name << budget;
            bytes_before = bytes;
            flops_before = flops;
        }
        if (c.name != "city" && c.name != "sphere") continue;
        EXPECT_LT(flops_before, best_biclusters(c.transfer, BiclusterGoal::kFlops, 1).flops());
    }
}

TEST(Biclusters, WithTheSameRowsBecomeOne) {
    Biclusters clusters;
    clusters.rows = 5;
    clusters.columns = 9;
    const auto add = [&](std::vector<uint32_t> rows, std::vector<uint16_t> columns, std::vector<int8_t> values) {
        clusters.add(rows, columns, values);
    };
    add({1, 3}, {2, 4}, {4, 1});
    add({1}, {7}, {100});
    add({1, 3}, {0, 4}, {3, -1});
    add({1}, {7}, {100});  // 200 is no int8
    add({0}, {1}, {2});
    add({0}, {1}, {-2});  // nothing is left
    merge_equal_rows(clusters);
    sort_by_first_row(clusters);
    ASSERT_EQ(clusters.count(), 3u);
    EXPECT_EQ(clusters.row, (std::vector<uint32_t>{1, 3, 1, 1}));
    EXPECT_EQ(clusters.column, (std::vector<uint16_t>{0, 2, 7, 7}));
    EXPECT_EQ(clusters.value, (std::vector<int8_t>{3, 4, 100, 100}));
}

TEST(KeyQueue, GivesTheLeastAndTheMost) {
    KeyQueue queue(5);
    EXPECT_TRUE(queue.empty());
    for (uint32_t i = 0; i < 5; ++i) queue.add(i, 3 * i % 5);  // 0 3 1 4 2
    EXPECT_EQ(queue.most(), 3u);
    EXPECT_EQ(queue.least(), 0u);
    queue.change(3, 0);
    EXPECT_EQ(queue.most(), 1u);
    EXPECT_EQ(queue.least(), 3u);  // the last that came to 0
    queue.remove(3);
    queue.remove(0);
    EXPECT_EQ(queue.least(), 2u);
    queue.change(2, 100);
    EXPECT_EQ(queue.most(), 2u);
    EXPECT_EQ(queue.key(2), 100u);
    EXPECT_FALSE(queue.has(0));
}

}  // namespace
}  // namespace citystream::codec::radiance
