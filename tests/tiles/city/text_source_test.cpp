#include "tiles/city/text_source.h"

#include <gtest/gtest.h>

#include "tests/tiles/city/city_probe.h"

namespace citystream::tiles::city {
namespace {

using namespace std::string_view_literals;

/// "{\"hello\":1}\n" as gzip and xz wrote it.
constexpr std::string_view kGzip =
    "\x1F\x8B\x08\x00\x00\x00\x00\x00\x02\x03\xAB\x56\xCA\x48\xCD\xC9\xC9\x57"
    "\xB2\x32\xAC\xE5\x02\x00\xA5"
    "\x7E\xB3\x6D\x0C\x00\x00\x00"sv;
constexpr std::string_view kXz =
    "\xFD\x37\x7A\x58\x5A\x00\x00\x04\xE6\xD6\xB4\x46\x02\x00\x21\x01\x0C\x00"
    "\x00\x00\x8F\x98\x41\x9C\x01"
    "\x00\x0B\x7B\x22\x68\x65\x6C\x6C\x6F\x22\x3A\x31\x7D\x0A\x00\x96\xDB\xF5"
    "\x18\xB9\x38\xC1\x46\x00\x01"
    "\x24\x0C\xA6\x18\xD8\xD8\x1F\xB6\xF3\x7D\x01\x00\x00\x00\x00\x04\x59\x5A"sv;
constexpr std::string_view kText = "{\"hello\":1}\n";

Result<std::string> all_of(std::string_view bytes) {
    auto source = TextSource::from_memory("input", bytes);
    if (!source) return source.error();
    std::string text;
    std::array<char, 5> part{};
    while (true) {
        const auto count = source->read(part);
        if (!count) return count.error();
        if (*count == 0) return text;
        text.append(part.data(), *count);
    }
}

TEST(TextSource, GzipXzAndPlainGiveTheSameText) {
    for (const std::string_view bytes : {kText, kGzip, kXz}) {
        const auto text = all_of(bytes);
        ASSERT_TRUE(text.ok()) << text.error().text();
        EXPECT_EQ(*text, kText);
    }
}

TEST(TextSource, MembersOneAfterAnotherAreJoined) {
    for (const std::string_view packed : {kGzip, kXz}) {
        const auto text = all_of(std::string(packed) + std::string(packed));
        ASSERT_TRUE(text.ok()) << text.error().text();
        EXPECT_EQ(*text, std::string(kText) + std::string(kText));
    }
}

TEST(TextSource, EveryTruncationIsAnErrorThatNamesTheInput) {
    for (const std::string_view packed : {kGzip, kXz}) {
        for (size_t length = 6; length < packed.size(); ++length) {
            const auto text = all_of(packed.substr(0, length));
            ASSERT_FALSE(text.ok()) << length;
            EXPECT_NE(text.error().message.find("input"), std::string::npos);
        }
    }
}

TEST(TextSource, DamagedBytesAreAnError) {
    for (const std::string_view packed : {kGzip, kXz}) {
        std::string damaged(packed);
        damaged[damaged.size() - 5] = static_cast<char>(damaged[damaged.size() - 5] ^ 0x55);
        EXPECT_FALSE(all_of(damaged).ok());
    }
}

TEST(TextSource, RewindStartsOver) {
    auto source = TextSource::from_memory("input", kXz);
    ASSERT_TRUE(source.ok());
    std::array<char, 64> first{}, second{};
    ASSERT_EQ(*source->read(first), kText.size());
    ASSERT_TRUE(source->rewind().ok());
    ASSERT_EQ(*source->read(second), kText.size());
    EXPECT_EQ(first, second);
}

TEST(TextSource, AbsentFilesAndFoldersAreErrors) {
    const TestFolder folder;
    EXPECT_FALSE(TextSource::open(folder / "none").ok());
    EXPECT_FALSE(TextSource::open(folder / "").ok());
}

TEST(LineReader, SplitsAtLineEndsOfBothKindsAndCountsThem) {
    auto source = TextSource::from_memory("input", "one\r\ntwo\n\nlast");
    ASSERT_TRUE(source.ok());
    LineReader lines(*source);
    std::string line;
    const std::array<std::pair<std::string, uint64_t>, 4> expected = {{{"one", 0}, {"two", 5}, {"", 9}, {"last", 10}}};
    for (size_t i = 0; i < expected.size(); ++i) {
        ASSERT_TRUE(*lines.next(line));
        EXPECT_EQ(line, expected[i].first);
        EXPECT_EQ(lines.line_offset(), expected[i].second);
        EXPECT_EQ(lines.line_number(), i + 1);
    }
    EXPECT_FALSE(*lines.next(line));
}

}  // namespace
}  // namespace citystream::tiles::city
