// The matrix in GPU memory gives the light that the matrix gives, and words that lie are refused.
#include "codec/radiance/radiance_resident.h"

#include <gtest/gtest.h>

#include "codec/radiance/bicluster.h"
#include "tests/codec/damage.h"
#include "tests/codec/radiance/transfer_cases.h"

namespace citystream::codec::radiance {
namespace {

std::vector<uint32_t> resident_of(const TransferCase& c) {
    const DistinctRows distinct = distinct_rows(c.transfer);
    return make_resident_radiance(find_biclusters(distinct.rows, {}), distinct.row_of, c.local_count);
}

std::vector<Channels<uint32_t>> some_light(uint32_t columns) {
    std::mt19937 random(columns);
    std::vector<Channels<uint32_t>> light(columns);
    for (auto& value : light) {
        for (uint32_t& v : value) v = static_cast<uint32_t>(random());
    }
    return light;
}

TEST(ResidentRadiance, GivesTheLightOfTheMatrixExactly) {
    for (const TransferCase& c : transfer_cases()) {
        const std::vector<uint32_t> words = exact_copy(resident_of(c));
        const auto view = ResidentRadianceView::create(words);
        ASSERT_TRUE(view.ok()) << c.name << ": " << view.error().text();
        const auto light = some_light(c.transfer.columns);
        const std::span<const Channels<uint32_t>> seen(light);
        const auto expected = product_by_entries(c.transfer, seen), rows = view->product(seen);
        ASSERT_EQ(view->receivers() * view->locals(), c.transfer.rows());
        for (uint32_t r = 0; r < view->receivers(); ++r) {
            for (uint32_t j = 0; j < view->locals(); ++j)
                EXPECT_EQ(rows[view->row_of(r, j)], expected[r * view->locals() + j]) << c.name;
        }
    }
}

TEST(ResidentRadiance, AddsFloatsInTheOrderOfTheClusters) {
    const Transfer t = make_transfer(open_sphere(20, 8), LocalDirections(4));
    const DistinctRows distinct = distinct_rows(t);
    const Biclusters clusters = find_biclusters(distinct.rows, {});
    const auto words = make_resident_radiance(clusters, distinct.row_of, 16);
    std::vector<Channels<float>> light(t.columns);
    for (uint32_t k = 0; k < t.columns; ++k) light[k].fill(1.0F / static_cast<float>(k + 3));
    const std::span<const Channels<float>> seen(light);
    EXPECT_EQ(ResidentRadianceView::create(words)->product(seen), product_by_clusters(clusters, seen));
}

TEST(ResidentRadiance, TakesLessThanThePapersFourBytesANumber) {
    const Transfer t = make_transfer(first_receivers(TowerCity().visibility(16, 16), 700), LocalDirections(8));
    const DistinctRows distinct = distinct_rows(t);
    const Biclusters clusters = find_biclusters(distinct.rows, {}), whole = find_biclusters(t, {});
    const size_t bytes = 4 * make_resident_radiance(clusters, distinct.row_of, 64).size();
    EXPECT_LT(bytes, 4 * (whole.row.size() + 2 * whole.column.size()));
}

TEST(ResidentRadiance, IsRefusedWhereWordsAreMissingOrTooMany) {
    for (const TransferCase& c : transfer_cases()) {
        std::vector<uint32_t> words = resident_of(c);
        if (words.size() > 1000) continue;
        for (size_t size = 0; size < words.size(); ++size)
            EXPECT_FALSE(ResidentRadianceView::create(exact_copy(std::span(words).first(size))).ok()) << c.name << size;
        words.push_back(0);
        EXPECT_FALSE(ResidentRadianceView::create(words).ok());
    }
}

TEST(ResidentRadiance, NeverReadsOutsideDamagedWords) {
    uint32_t accepted = 0, refused = 0;
    for (const TransferCase& c : transfer_cases()) {
        const std::vector<uint32_t> words = resident_of(c);
        if (words.size() > 120) continue;
        const auto light = some_light(1 << 16);
        for_each_mutation(words, [&](std::span<const uint32_t> damaged) {
            const auto view = ResidentRadianceView::create(damaged);
            (view.ok() ? accepted : refused)++;
            if (view.ok() && view->columns() <= light.size()) view->product(std::span<const Channels<uint32_t>>(light));
        });
    }
    EXPECT_GT(accepted, 100u);
    EXPECT_GT(refused, 1000u);
}

TEST(ResidentRadiance, KeepsTheWordsOfItsFormatPage) {
    // Two receivers of one direction: both see texels 1 and 2 wholly, the second one a quarter of texel 5.
    const Biclusters clusters{2, 6, {0, 2, 3}, {0, 2, 3}, {0, 1, 1}, {1, 2, 5}, {4, 4, 1}};
    const std::vector<uint32_t> row_of = {0, 1};
    EXPECT_EQ(make_resident_radiance(clusters, row_of, 1),
              (std::vector<uint32_t>{0x31525343, 2,    1,  6,    2,      2,          3,          3,
                                     16,         18,   20, 21,   22,     0x01010203, 0x00810202, 0,  //
                                     0,          0x38, 0,  0x34, 0x1759, 0x4,        0x2}));
}

}  // namespace
}  // namespace citystream::codec::radiance
