#include "client/path/csv_table.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace citystream::client {
namespace {

constexpr std::array<std::string_view, 3> kColumns = {"name", "length", "note"};
constexpr CsvForm kForm = {"list of things", kColumns, 2};

Result<CsvReader> open(const std::string& text) {
    return CsvReader::open(std::span(text.data(), text.size()), kForm);
}

TEST(CsvTable, ReadsCellsByColumnWhateverTheirOrder) {
    const std::string text = "\xef\xbb\xbf\r\nlength , name\r\n\r\n+1.5,  a thing \r\n-2,b";
    auto rows = open(text);
    ASSERT_TRUE(rows) << rows.error().text();
    EXPECT_FALSE(rows->has(2));
    ASSERT_TRUE(rows->next().value());
    EXPECT_EQ(rows->cell(0), "a thing");
    EXPECT_EQ(*rows->number(1), 1.5);
    EXPECT_EQ(rows->cell(2), "");
    ASSERT_TRUE(rows->next().value());
    EXPECT_EQ(*rows->number(1), -2);
    EXPECT_FALSE(rows->next().value());
    EXPECT_FALSE(rows->next().value());
}

TEST(CsvTable, NamesLineAndColumnOfAFault) {
    const std::string text = "name,length\n\na,long\nb,inf\nc\nd,1,2\n";
    auto rows = open(text);
    ASSERT_TRUE(rows);
    ASSERT_TRUE(rows->next().value());
    EXPECT_EQ(rows->number(1).error().text(), "list of things, line 3: column length: \"long\" is not a number");
    ASSERT_TRUE(rows->next().value());
    EXPECT_EQ(rows->number(1).error().text(), "list of things, line 4: column length: \"inf\" is not finite");
    EXPECT_EQ(rows->next().error().text(), "list of things, line 5: only 1 values, expected 2");
    EXPECT_EQ(rows->next().error().text(), "list of things, line 6: more than 2 values, expected 2");
}

TEST(CsvTable, RefusesHeadersThatItCannotMean) {
    for (const std::string text : {"", "\n\r\n", "name\n", "length,note\n", "name,length,colour\n",
                                   "name,name,length\n", "name,length,note,note\n", "name;length\n"}) {
        const auto rows = open(text);
        ASSERT_FALSE(rows) << text;
        EXPECT_EQ(rows.error().text().rfind("list of things", 0), 0u) << rows.error().text();
    }
}

TEST(CsvTable, MessagesQuoteForeignTextShortAndPrintable) {
    EXPECT_EQ(printable("\x01ok\xff"), "?ok?");
    EXPECT_EQ(printable(std::string(100, 'x')), std::string(24, 'x') + "...");
}

TEST(CsvTable, AFileThatCannotBeReadIsNamed) {
    const auto text = read_csv_file("/nowhere/list.csv", kForm.what);
    ASSERT_FALSE(text);
    EXPECT_EQ(text.error().text(), "/nowhere/list.csv: cannot open the list of things");
}

}  // namespace
}  // namespace citystream::client
