#include "codec/facade/facade_wire.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "codec/facade/cut_wire.h"
#include "codec/facade/facade_form.h"
#include "codec/facade/patch_wire.h"
#include "codec/facade/quotient_wire.h"
#include "tests/codec/facade/relief_cases.h"
#include "tests/hexadecimal.h"

namespace citystream::codec::facade {
namespace {

constexpr FacadeForm kShipped[] = {FacadeForm::kPatch, FacadeForm::kTiled, FacadeForm::kQuotient};

std::vector<ReliefCase> reliefs() {
    std::vector<ReliefCase> cases = small_reliefs();
    for (ReliefCase& large : large_reliefs()) cases.push_back(std::move(large));
    cases.push_back({"noise", noise_relief(120, 90, -9, 9, 3)});
    return cases;
}

std::vector<std::byte> prefix_of(const std::vector<std::byte>& bytes, size_t size) {
    return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)};
}

TEST(FacadeWire, ExpandsToExactlyTheWordsOfEveryForm) {
    for (const ReliefCase& relief : reliefs()) {
        const RunGrid grid = make_run_grid(relief.relief).value();
        for (const FacadeForm form : kShipped) {
            const auto words = encode_form(form, grid);
            if (!words) continue;
            const std::string name = relief.name + " as " + std::string(form_name(form));
            const std::vector<std::byte> wire = encode_wire(*words);
            EXPECT_EQ(wire, encode_wire(*words)) << name;
            const auto back = expand_wire(wire, 4 * words->size());
            ASSERT_TRUE(back.ok()) << name << ": " << back.error().text();
            EXPECT_EQ(*back, *words) << name;
        }
    }
}

TEST(FacadeWire, ShipsTheFormOfLeastCost) {
    for (const ReliefCase& relief : reliefs()) {
        const RunGrid grid = make_run_grid(relief.relief).value();
        const ShippedMap shipped = encode_shipped_map(grid);
        EXPECT_EQ(decode_form(shipped.words).value(), grid) << relief.name;
        EXPECT_EQ(expand_wire(shipped.wire, 4 * shipped.words.size()).value(), shipped.words) << relief.name;
        for (const FacadeForm form : kShipped) {
            const auto words = encode_form(form, grid);
            if (!words) continue;
            EXPECT_LE(4 * shipped.words.size() + shipped.wire.size(), 4 * words->size() + encode_wire(*words).size())
                << relief.name << " as " << form_name(form);
        }
    }
}

TEST(FacadeWire, NoiseShipsAsAQuotientAtThePriceOfItsEntropy) {
    const ShippedMap shipped = encode_shipped_map(make_run_grid(noise_relief(256, 256, 0, 31, 1)).value());
    EXPECT_EQ(read_form_head(shipped.words)->form, FacadeForm::kQuotient);
    EXPECT_LE(shipped.wire.size(), 256 * 256 * 5 / 8 * 1.05);
}

TEST(FacadeWire, RegularFacadesTakeAFewHundredBytes) {
    const ShippedMap shipped = encode_shipped_map(make_run_grid(window_relief(400, 500, 5, false)).value());
    EXPECT_LT(shipped.wire.size(), 1200u);
    const ShippedMap flat = encode_shipped_map(make_run_grid(uniform_relief(700, 900, 0, 0)).value());
    EXPECT_LT(flat.wire.size(), 12u);
}

TEST(FacadeWire, RefusesEveryOtherSize) {
    const ShippedMap shipped = encode_shipped_map(make_run_grid(figure8_relief()).value());
    const size_t size = 4 * shipped.words.size();
    for (const size_t wrong : {size_t{0}, size - 4, size - 1, size + 1, size + 4, 2 * size})
        EXPECT_FALSE(expand_wire(shipped.wire, wrong).ok()) << wrong;
}

TEST(FacadeWire, NoTruncationExpandsToTheSameWords) {
    const RunGrid grid = make_run_grid(window_relief(80, 100, 3, true)).value();
    for (const FacadeForm form : kShipped) {
        const auto words = encode_form(form, grid).value();
        const std::vector<std::byte> wire = encode_wire(words);
        for (size_t size = 0; size < wire.size(); ++size) {
            const auto back = expand_wire(prefix_of(wire, size), 4 * words.size());
            EXPECT_FALSE(back.ok() && *back == words) << form_name(form) << " cut to " << size;
            EXPECT_FALSE(back.ok() && size + 8 < wire.size()) << form_name(form) << " cut to " << size;
        }
        std::vector<std::byte> longer = wire;
        longer.resize(wire.size() + 2);
        EXPECT_FALSE(expand_wire(longer, 4 * words.size()).ok());
    }
}

TEST(FacadeWire, DamagedBytesGiveAnErrorOrWordsThatPass) {
    const RunGrid grid = make_run_grid(window_relief(80, 100, 3, true)).value();
    std::mt19937 random(1);
    for (const FacadeForm form : kShipped) {
        const auto words = encode_form(form, grid).value();
        const std::vector<std::byte> wire = encode_wire(words);
        size_t refused = 0;
        for (size_t i = 0; i < 1500; ++i) {
            std::vector<std::byte> damaged = wire;
            damaged[random() % damaged.size()] ^= static_cast<std::byte>(1 + random() % 255);
            const auto back = expand_wire(damaged, 4 * words.size());
            refused += back.ok() ? 0 : 1;
            if (back.ok()) {
                ASSERT_TRUE(check_form(*back).ok());
            }
        }
        EXPECT_GT(refused, 750u) << form_name(form);
    }
}

TEST(FacadeWire, GoldenBytes) {
    FacadeMatrices relief = uniform_relief(3, 2, 0, 0);
    fill_rectangle(relief, 1, 3, 0, 1, -2, 1);
    fill_rectangle(relief, 0, 1, 1, 2, 5, 0);
    const RunGrid grid = make_run_grid(relief).value();
    EXPECT_EQ(test::hexadecimal(encode_wire(encode_form(FacadeForm::kQuotient, grid).value())), "000876e9241b29929888");
    EXPECT_EQ(test::hexadecimal(encode_wire(encode_form(FacadeForm::kTiled, grid).value())), "07ffeffb274f495bf57d");
    EXPECT_EQ(test::hexadecimal(encode_wire(encode_form(FacadeForm::kPatch, grid).value())), "1eb75ffeaf76d22bbc");
    const RunGrid windows = make_run_grid(window_relief(40, 60, 3, true)).value();
    EXPECT_EQ(
        test::hexadecimal(encode_wire(encode_form(FacadeForm::kQuotient, windows).value())),
        "0011ad63c868995efe17501205538023c535d2c8b5e91f02ecb8251bc3b403ce44eff02eb6d1030697c079c91dabacacefb86e955d");
}

TEST(CutWire, CutsOfAPatchMapGiveItsWordsAgain) {
    size_t cut = 0, patches = 0;
    for (const ReliefCase& relief : reliefs()) {
        const auto words = encode_form(FacadeForm::kPatch, make_run_grid(relief.relief).value());
        if (!words) continue;
        ++patches;
        const auto map = cut_map_of(*words);
        if (!map) continue;
        ++cut;
        bits::RangeEncoder encoder;
        put_cut_wire(*map, encoder);
        const std::vector<std::byte> bytes = encoder.finish();
        bits::RangeDecoder decoder(bytes);
        const auto back = get_cut_wire(decoder, 4 * words->size());
        ASSERT_TRUE(back.ok()) << relief.name << ": " << back.error().text();
        EXPECT_TRUE(decoder.finish().ok()) << relief.name;
        EXPECT_EQ(*back, *words) << relief.name;
    }
    EXPECT_GE(cut + 2, patches) << "nearly every patch map is its facade and its cuts";
}

TEST(CutWire, IsSmallerThanPoolsWhereFloorsRepeatAndPoolsAreStillRead) {
    const auto words =
        encode_form(FacadeForm::kPatch, make_run_grid(window_relief(400, 500, 5, false)).value()).value();
    bits::RangeEncoder pools, cuts;
    put_patch_wire(words, pools);
    put_cut_wire(cut_map_of(words).value(), cuts);
    const std::vector<std::byte> as_pools = pools.finish();
    EXPECT_LT(cuts.finish().size(), as_pools.size());
    bits::RangeDecoder decoder(as_pools);
    EXPECT_EQ(get_patch_wire(decoder, 4 * words.size()).value(), words);
}

TEST(QuotientWire, FailsAtItsLimits) {
    const QuotientParts parts = make_quotient(make_run_grid(window_relief(80, 100, 3, true)).value());
    bits::RangeEncoder encoder;
    put_quotient_wire(parts, encoder);
    const std::vector<std::byte> bytes = encoder.finish();
    const uint64_t cells = uint64_t{parts.columns} * parts.rows;
    const uint64_t runs = uint64_t{parts.x_classes.size()} * parts.y_classes.size();
    const auto read = [&](const QuotientLimits& limits) {
        bits::RangeDecoder decoder(bytes);
        auto back = get_quotient_wire(decoder, limits);
        return back.ok() && decoder.finish().ok() && *back == parts;
    };
    EXPECT_TRUE(read({cells, runs}));
    EXPECT_FALSE(read({cells - 1, runs}));
    EXPECT_FALSE(read({cells, runs - 1}));
    EXPECT_FALSE(read({cells, 0}));
}

}  // namespace
}  // namespace citystream::codec::facade
