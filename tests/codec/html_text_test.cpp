#include "codec/html_text.h"

#include <gtest/gtest.h>

namespace citystream {
namespace {

TEST(HtmlText, NothingThatEndsTextOrAnAttributeIsLeft) {
    EXPECT_EQ(escape_html("<a href='x' title=\"y\">&</a>"),
              "&lt;a href=&#39;x&#39; title=&quot;y&quot;&gt;&amp;&lt;/a&gt;");
    std::string every_byte;
    for (int c = 0; c < 256; ++c) every_byte += static_cast<char>(c);
    EXPECT_EQ(escape_html(every_byte).find_first_of("<>\"'"), std::string::npos);
}

TEST(HtmlText, AllOtherTextIsLeftAsItIs) {
    const std::string plain = "Tōkyō 23 wards; 1/2 = 0.5\n";
    EXPECT_EQ(escape_html(plain), plain);
    EXPECT_EQ(escape_html(""), "");
    EXPECT_EQ(escape_html("&amp;"), "&amp;amp;") << "what looks like an entity is text too";
}

}  // namespace
}  // namespace citystream
