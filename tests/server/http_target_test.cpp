#include "server/http_target.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace citystream::server {
namespace {

HttpTarget parsed(std::string_view target) {
    auto result = parse_http_target(target);
    EXPECT_TRUE(result.ok()) << target << ": " << (result.ok() ? "" : result.error().text());
    return result.ok() ? *result : HttpTarget{};
}

TEST(HttpTarget, NamesTheServersOwnPages) {
    EXPECT_EQ(parsed("/").kind, TargetKind::kIndex);
    EXPECT_EQ(parsed("/healthz").kind, TargetKind::kHealth);
    EXPECT_EQ(parsed("/metrics?x=1").kind, TargetKind::kMetrics);
    EXPECT_EQ(parsed("/cities.json").kind, TargetKind::kCities);
}

TEST(HttpTarget, SplitsCityAndEntry) {
    EXPECT_EQ(parsed("/demo/tiles/3/1/2.mesh"), (HttpTarget{TargetKind::kEntry, "demo", "tiles/3/1/2.mesh"}));
    EXPECT_EQ(parsed("/demo"), (HttpTarget{TargetKind::kCityRedirect, "demo", ""}));
    EXPECT_EQ(parsed("/demo/"), (HttpTarget{TargetKind::kCityPage, "demo", ""}));
    EXPECT_EQ(parsed("/healthz/x"), (HttpTarget{TargetKind::kEntry, "healthz", "x"}));
}

TEST(HttpTarget, TakesAbsoluteFormAndIgnoresTheQuery) {
    EXPECT_EQ(parsed("http://host:80/demo/a?v=2/../x"), (HttpTarget{TargetKind::kEntry, "demo", "a"}));
    EXPECT_EQ(parsed("HTTP://host").kind, TargetKind::kIndex);
    EXPECT_EQ(parsed("http://host?x").kind, TargetKind::kIndex);
}

TEST(HttpTarget, DecodesPercentEscapesExactlyOnce) {
    EXPECT_EQ(parsed("/d%65mo/a%20b%2525").entry, "a b%25");
    EXPECT_EQ(parsed("/d%65mo/x").city, "demo");
    EXPECT_EQ(parsed("/demo/caf%C3%A9").entry, "caf\xC3\xA9");
}

TEST(HttpTarget, RefusesEveryWayOutOfTheArchive) {
    const std::vector<std::string> attempts = {"",
                                               "demo",
                                               "*",
                                               "../etc/passwd",
                                               "/..",
                                               "/../etc/passwd",
                                               "/demo/..",
                                               "/demo/../x",
                                               "/demo/./x",
                                               "/demo/%2e%2e/x",
                                               "/demo/%2E./x",
                                               "/demo/.%2e",
                                               "/demo/..%2fx",
                                               "/demo/a%2fb",
                                               "/demo/a%2Fb",
                                               "//etc/passwd",
                                               "/demo//x",
                                               "/demo///",
                                               "//",
                                               "/demo/a//",
                                               "/demo\\x",
                                               "/demo/..\\x",
                                               "/demo/%5c..%5cx",
                                               "/demo/a%00",
                                               "/demo/%00",
                                               "/demo/a%0d%0aX",
                                               "/demo/a%7f",
                                               "/demo/%",
                                               "/demo/%2",
                                               "/demo/%zz",
                                               "/demo/%u0041",
                                               "/demo/%c0%ae%c0%ae/x",
                                               "/demo/%c0%af",
                                               "/demo/%e0%80%ae",
                                               "/demo/%f0%80%80%ae",
                                               "/demo/%ed%a0%80",
                                               "/demo/%ff",
                                               "/demo/%c3",
                                               "/demo/a#b",
                                               "http:///..",
                                               "ftp://x/y"};
    for (const auto& attempt : attempts) {
        EXPECT_FALSE(parse_http_target(attempt).ok()) << attempt;
    }
}

TEST(HttpTarget, RefusesAnOverlongTarget) {
    const std::string longest = "/demo/" + std::string(kMaxTargetBytes - 6, 'a');
    EXPECT_TRUE(parse_http_target(longest).ok());
    EXPECT_FALSE(parse_http_target(longest + "a").ok());
}

TEST(HttpTarget, SaysWhereItIsWrong) {
    const auto result = parse_http_target("/demo/a%zz");
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().offset, 7u);
}

}  // namespace
}  // namespace citystream::server
