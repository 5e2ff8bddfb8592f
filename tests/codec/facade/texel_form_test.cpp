// What must hold for every form that is looked up by texel: exact on every input, and no reader leaves damaged words.
#include <gtest/gtest.h>

#include <chrono>

#include "codec/facade/facade_form_layout.h"
#include "tests/codec/damage.h"
#include "tests/codec/facade/relief_cases.h"
#include "tests/codec/facade/texel_forms.h"

namespace citystream::codec::facade {
namespace {

uint32_t label_at(const FacadeMatrices& relief, uint32_t x, uint32_t y) {
    const size_t at = size_t{y} * relief.width + x;
    return make_label(relief.displacement_mm[at], relief.material[at]);
}

/// Lookups of all texels give the relief and boxes around the texel in which nothing is higher.
void expect_lookups(const TexelForm& form, Words words, const FacadeMatrices& relief, const std::string& name) {
    for (uint32_t y = 0; y < relief.height; ++y) {
        for (uint32_t x = 0; x < relief.width; ++x)
            ASSERT_EQ(form.label(words, x, y), label_at(relief, x, y)) << form.name << ", " << name << x << ", " << y;
    }
    if (!form.box) return;
    const RunGrid grid = make_run_grid(relief).value();
    const FreeBoxes free = grow_free_boxes(grid);
    for (uint32_t row = 0; row < grid.rows(); ++row) {
        for (uint32_t column = 0; column < grid.columns(); ++column) {
            const FreeBox expected = free.boxes[free.box_index[size_t{row} * grid.columns() + column]];
            ASSERT_EQ(form.box(words, grid.x_breaks[column], grid.y_breaks[row]), expected)
                << form.name << ", " << name;
            ASSERT_EQ(form.box(words, grid.x_breaks[column + 1] - 1, grid.y_breaks[row + 1] - 1), expected)
                << form.name << ", " << name;
        }
    }
}

void expect_exact_or_refused(const TexelForm& form, const ReliefCase& c, bool may_refuse) {
    const RunGrid grid = make_run_grid(c.relief).value();
    const auto words = form.encode(grid);
    if (!words.ok()) {
        EXPECT_TRUE(may_refuse) << form.name << " refuses " << c.name << ": " << words.error().text();
        EXPECT_FALSE(words.error().message.empty());
        return;
    }
    const Status status = form.check(*words);
    ASSERT_TRUE(status.ok()) << form.name << ", " << c.name << ": " << status.error().text();
    const auto decoded = form.decode(*words);
    ASSERT_TRUE(decoded.ok()) << form.name << ", " << c.name << ": " << decoded.error().text();
    EXPECT_EQ(*decoded, grid) << form.name << ", " << c.name;
    if (form.refuses) {
        EXPECT_LT(words->size(), encode_raw_map(grid)->size()) << form.name << ", " << c.name;
    }
    expect_lookups(form, *words, c.relief, c.name);
}

TEST(TexelForms, AreExactOnSmallReliefsOrRefuseThem) {
    for (const TexelForm& form : texel_forms()) {
        for (const ReliefCase& c : small_reliefs()) expect_exact_or_refused(form, c, form.refuses);
    }
}

TEST(TexelForms, OfFactorsAreExactOnEveryReliefWhenSizeDoesNotMatter) {
    constexpr uint32_t kTimesRaw = 100;
    for (TexelForm form : texel_forms()) {
        if (!form.refuses) continue;
        form.refuses = false;
        const bool is_shared = form.name == "shared binary factors";
        const BinaryVariant variant = is_shared ? BinaryVariant::kShared : BinaryVariant::kPaper;
        form.encode = [&](const RunGrid& grid) {
            return form.name == "singular values" ? encode_singular_value_map(grid, kTimesRaw)
                                                  : encode_binary_map(grid, variant, kTimesRaw);
        };
        for (const ReliefCase& c : small_reliefs()) expect_exact_or_refused(form, c, false);
        for (const uint32_t side : {20u, 70u})
            expect_exact_or_refused(form, {"noise", noise_relief(side, side, -32768, 32767, 65536)}, false);
        expect_exact_or_refused(form, {"facade", window_relief(300, 420, 6, true)}, false);
    }
}

TEST(TexelForms, AreExactOnLargeReliefsOfEveryKind) {
    for (const TexelForm& form : texel_forms()) {
        for (const ReliefCase& c : large_reliefs()) {
            // The boxes of irregular facades have too many singular values.
            expect_exact_or_refused(form, c, form.name == "singular values" && c.name.starts_with("facade"));
        }
    }
}

TEST(TexelForms, AreExactOnRandomRectangles) {
    TestNumbers numbers(23);
    for (int round = 0; round < 30; ++round) {
        FacadeMatrices relief = uniform_relief(60 + numbers.below(90), 60 + numbers.below(90), 0, 0);
        for (uint32_t i = numbers.below(25); i > 0; --i) {
            const uint32_t x = numbers.below(relief.width), y = numbers.below(relief.height);
            fill_rectangle(relief, x, x + 1 + numbers.below(40), y, y + 1 + numbers.below(40),
                           static_cast<int32_t>(numbers.below(9)) * 40 - 160, numbers.below(5));
        }
        for (const TexelForm& form : texel_forms())
            expect_exact_or_refused(form, {"round " + std::to_string(round), relief}, form.refuses);
    }
}

TEST(TexelForms, OfTheLargestUniformFacadeAreExact) {
    const RunGrid grid{{0, kMaxFacadeSide}, {0, kMaxFacadeSide}, {make_label(-120, 7)}};
    for (const TexelForm& form : texel_forms()) {
        if (form.name == "raw without boxes") continue;  // as with boxes
        const auto words = form.encode(grid);
        ASSERT_TRUE(words.ok()) << form.name << words.error().text();
        const auto decoded = form.decode(*words);
        ASSERT_TRUE(decoded.ok()) << form.name << decoded.error().text();
        EXPECT_EQ(*decoded, grid) << form.name;
        EXPECT_EQ(form.label(*words, kMaxFacadeSide - 1, kMaxFacadeSide - 1), make_label(-120, 7)) << form.name;
        if (form.refuses) {
            EXPECT_LT(words->size(), 64u) << form.name;
        }
    }
}

TEST(TexelForms, OfFactorsRefuseNoiseSoon) {
    for (const uint32_t side : {64u, 256u, 700u}) {
        const RunGrid grid = make_run_grid(noise_relief(side, side, -1000, 1000, 200)).value();
        for (const TexelForm& form : texel_forms()) {
            if (!form.refuses) continue;
            const auto begin = std::chrono::steady_clock::now();
            EXPECT_FALSE(form.encode(grid).ok()) << form.name;
            EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10)) << form.name;
        }
    }
}

TEST(TexelForms, OfFactorsRefuseManyDifferentEntries) {
    FacadeMatrices relief = uniform_relief(100, 90, 0, 0);
    TestNumbers numbers(4);
    for (uint32_t i = 0; i < 9000; ++i) {
        relief.displacement_mm[i] = static_cast<int16_t>(i);
        std::swap(relief.displacement_mm[i], relief.displacement_mm[numbers.below(i + 1)]);
    }
    const RunGrid grid = make_run_grid(relief).value();
    for (const TexelForm& form : texel_forms()) EXPECT_EQ(form.encode(grid).ok(), !form.refuses) << form.name;
}

/// A relief for which the form has few words.
FacadeMatrices tiny_relief(const TexelForm& form) {
    if (form.name == "singular values") return figure8_relief(2, 1);  // pays from some size on only
    FacadeMatrices relief = uniform_relief(18, 20, -3, 0);
    fill_rectangle(relief, 4, 9, 5, 12, 20, 1);
    fill_rectangle(relief, 0, 18, 18, 20, kOpenDisplacement, 0);
    return relief;
}

TEST(TexelForms, RefuseEveryTruncationAndWordsTooMany) {
    for (const TexelForm& form : texel_forms()) {
        const auto words = form.encode(make_run_grid(tiny_relief(form)).value());
        ASSERT_TRUE(words.ok()) << form.name << words.error().text();
        for (size_t kept = 0; kept < words->size(); ++kept) {
            const std::vector<uint32_t> cut = exact_copy(Words(*words).first(kept));
            EXPECT_FALSE(form.check(cut).ok()) << form.name << " cut to " << kept;
            EXPECT_FALSE(form.decode(cut).ok()) << form.name << " cut to " << kept;
        }
        std::vector<uint32_t> longer = *words;
        longer.push_back(0);
        EXPECT_FALSE(form.check(longer).ok()) << form.name;
    }
}

/// What a renderer may do with checked words.
void read_everything(const TexelForm& form, Words words) {
    if (!form.check(words).ok()) {
        EXPECT_FALSE(form.decode(words).ok()) << form.name;
        return;
    }
    const uint32_t size = words[FACADE_FORM_WORD_SIZE], width = size & 0xffffu, height = size >> 16;
    const bool has_box = form.box && (form.name != "raw" || raw_box_count(words) > 0);
    for (uint32_t y = 0; y < height; y += 1 + height / 24) {
        for (uint32_t x = 0; x < width; x += 1 + width / 24) {
            (void)form.label(words, x, y);
            if (!has_box) continue;
            const FreeBox box = form.box(words, x, y);
            EXPECT_LE(box.x1, width);
            EXPECT_LE(box.y1, height);
        }
    }
    (void)form.decode(words);
}

TEST(TexelForms, StayWithinCheckedWordsHoweverDamaged) {
    for (const TexelForm& form : texel_forms()) {
        const auto words = form.encode(make_run_grid(tiny_relief(form)).value());
        ASSERT_TRUE(words.ok()) << form.name;
        for_each_mutation(*words, [&](Words damaged) { read_everything(form, damaged); });
    }
}

TEST(TexelForms, StayWithinCheckedWordsAfterRandomChanges) {
    TestNumbers numbers(99);
    const RunGrid grid = make_run_grid(enlarged(window_relief(40, 50, 8, true), 3)).value();
    for (const TexelForm& form : texel_forms()) {
        const auto words = form.encode(grid);
        if (!words.ok()) continue;
        for (int round = 0; round < 200; ++round) {
            std::vector<uint32_t> damaged = exact_copy(*words);
            for (uint32_t changes = 1 + numbers.below(3); changes > 0; --changes) {
                // Half of the changes in the header, where they matter most.
                const uint32_t range = numbers.below(2) == 0 ? 36 : static_cast<uint32_t>(damaged.size());
                uint32_t& word = damaged[numbers.below(std::min(range, static_cast<uint32_t>(damaged.size())))];
                word = numbers.below(2) == 0 ? word + numbers.below(9) - 4 : word ^ 1u << numbers.below(32);
            }
            read_everything(form, damaged);
        }
    }
}

TEST(TexelForms, TellTheFormOfWordsOfAnother) {
    const RunGrid grid = make_run_grid(figure8_relief()).value();
    const std::vector<uint32_t> mips = encode_max_mip_map(grid).value();
    for (const TexelForm& form : texel_forms()) {
        if (form.name == "maximum mips") continue;
        const Status status = form.check(mips);
        ASSERT_FALSE(status.ok());
        EXPECT_NE(status.error().message.find("max-mip"), std::string::npos) << status.error().text();
    }
}

}  // namespace
}  // namespace citystream::codec::facade
