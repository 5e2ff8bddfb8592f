#include "codec/facade/facade_form.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/codec/facade/relief_cases.h"

namespace citystream::codec::facade {
namespace {

TEST(FacadeForm, EveryFormHasOneName) {
    const char* names[] = {"patch", "quotient", "tiled", "raw", "max-mip", "svd", "binary"};
    for (size_t i = 0; i < kFacadeForms.size(); ++i) {
        EXPECT_EQ(form_name(kFacadeForms[i]), names[i]);
        EXPECT_EQ(form_named(names[i]), kFacadeForms[i]);
    }
    EXPECT_FALSE(form_named("").has_value());
    EXPECT_FALSE(form_named("Patch").has_value());
}

TEST(FacadeForm, EveryFormSaysInItsHeadWhatItHoldsAndDecodesToTheSameGrid) {
    std::vector<size_t> encoded(kFacadeForms.size(), 0);
    for (const ReliefCase& relief : large_reliefs()) {
        const RunGrid grid = make_run_grid(relief.relief).value();
        for (size_t i = 0; i < kFacadeForms.size(); ++i) {
            const auto words = encode_form(kFacadeForms[i], grid);
            if (!words) continue;  // only where it does not pay
            ++encoded[i];
            const std::string name = relief.name + " as " + std::string(form_name(kFacadeForms[i]));
            const auto head = read_form_head(*words);
            ASSERT_TRUE(head.ok()) << name << ": " << head.error().text();
            EXPECT_EQ(head->form, kFacadeForms[i]) << name;
            EXPECT_EQ(head->width, grid.width()) << name;
            EXPECT_EQ(head->height, grid.height()) << name;
            EXPECT_EQ(head->depths, grid.depths()) << name;
            const Status checked = check_form(*words);
            ASSERT_TRUE(checked.ok()) << name << ": " << checked.error().text();
            EXPECT_EQ(decode_form(*words).value(), grid) << name;
        }
    }
    for (size_t i = 0; i < kFacadeForms.size(); ++i) EXPECT_GE(encoded[i], 3u) << form_name(kFacadeForms[i]);
}

TEST(FacadeForm, RefusesHeadsThatNoMapHas) {
    const auto words = encode_form(FacadeForm::kQuotient, make_run_grid(figure8_relief()).value()).value();
    for (size_t size = 0; size < 3; ++size) {
        EXPECT_FALSE(read_form_head(std::span(words).first(size)).ok());
        EXPECT_FALSE(check_form(std::span(words).first(size)).ok());
        EXPECT_FALSE(decode_form(std::span(words).first(size)).ok());
    }
    const auto refused_at = [&](size_t word, uint32_t value) {
        auto wrong = words;
        wrong[word] = value;
        const auto head = read_form_head(wrong);
        return head.ok() ? ~uint64_t{0} : head.error().offset;
    };
    EXPECT_EQ(refused_at(0, 0x00024644u), 0u) << "magic";
    EXPECT_EQ(refused_at(0, 0x00004643u), 2u) << "form 0";
    EXPECT_EQ(refused_at(0, 0x00084643u), 2u) << "form 8";
    EXPECT_EQ(refused_at(1, 0), 4u);
    EXPECT_EQ(refused_at(1, 8193 | 5u << 16), 4u);
    EXPECT_EQ(refused_at(1, 5 | 8193u << 16), 4u);
    EXPECT_EQ(refused_at(2, 10 | 9u << 16), 8u) << "least above greatest";
    EXPECT_EQ(refused_at(2, 0x8000u), 8u) << "open is no displacement";
}

TEST(FacadeForm, AWordsFormDecidesWhoReadsThem) {
    const RunGrid grid = make_run_grid(figure8_relief()).value();
    for (const FacadeForm form : kFacadeForms) {
        auto words = encode_form(form, grid);
        if (!words) continue;
        for (const FacadeForm other : kFacadeForms) {
            if (other == form) continue;
            (*words)[0] = FACADE_FORM_MAGIC | static_cast<uint32_t>(other) << 16;
            EXPECT_FALSE(check_form(*words).ok()) << form_name(form) << " as " << form_name(other);
        }
    }
}

}  // namespace
}  // namespace citystream::codec::facade
