#include "server/responses.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/server/synthetic_city.h"

namespace citystream::server {
namespace {

using test::text_of;

constexpr std::string_view kDate = "Sun, 06 Nov 1994 08:49:37 GMT";
constexpr std::string_view kMesh = "/demo/tiles/0/0/0.mesh";

class Responses : public testing::Test {
  protected:
    void SetUp() override {
        test::write_city(folder_ / "demo.3tz");
        auto catalog = ArchiveCatalog::open({folder_ / "demo.3tz"});
        ASSERT_TRUE(catalog.ok()) << catalog.error().text();
        metrics_ = std::make_unique<Metrics>(std::vector<Metrics::CityLabel>{{"demo", 1}});
        site_ = std::make_unique<Site>(std::move(*catalog), *metrics_);
    }
    Response get(std::string_view target) { return ask({.target = target}); }
    Response ask(const RequestFields& request) { return respond(request, *site_, kDate, false); }
    std::string etag(std::string_view target) { return get(target).source.etag; }
    static bool has(const Response& response, std::string_view line) {
        return response.head.find("\r\n" + std::string(line) + "\r\n") != std::string::npos;
    }

    test::TemporaryFolder folder_;
    std::unique_ptr<Metrics> metrics_;
    std::unique_ptr<Site> site_;
};

TEST_F(Responses, SendTileBytesStraightFromTheMapping) {
    const Response response = get(kMesh);
    EXPECT_EQ(response.status, 200u);
    EXPECT_EQ(text_of(response.body()), test::mesh_bytes());
    EXPECT_EQ(response.body().data(), site_->catalog().cities()[0].archive->find("tiles/0/0/0.mesh").data());
    EXPECT_TRUE(has(response, "Content-Length: 1000"));
    EXPECT_TRUE(has(response, "Content-Type: application/octet-stream"));
    EXPECT_TRUE(has(response, "Accept-Ranges: bytes"));
    EXPECT_TRUE(has(response, "Access-Control-Allow-Origin: *"));
    EXPECT_TRUE(has(response, "Date: " + std::string(kDate)));
    EXPECT_TRUE(response.head.starts_with("HTTP/1.1 200 OK\r\n"));
    EXPECT_TRUE(response.head.ends_with("\r\n\r\n"));
}

TEST_F(Responses, KeepTilesForeverAndAskAgainForTheDirectory) {
    EXPECT_TRUE(has(get(kMesh), "Cache-Control: public, max-age=31536000, immutable"));
    EXPECT_TRUE(has(get("/demo/tileset.json"), "Cache-Control: public, max-age=0, must-revalidate"));
    EXPECT_TRUE(has(get("/demo/subtrees/0/0/0.subtree"), "Cache-Control: public, max-age=0, must-revalidate"));
    EXPECT_TRUE(has(get("/healthz"), "Cache-Control: no-store"));
    EXPECT_TRUE(has(get("/demo/nothing"), "Cache-Control: no-store"));
}

TEST_F(Responses, NameTheKindOfContent) {
    EXPECT_TRUE(has(get("/demo/tileset.json"), "Content-Type: application/json"));
    EXPECT_TRUE(has(get("/demo/preview.png"), "Content-Type: image/png"));
    EXPECT_TRUE(has(get("/"), "Content-Type: text/html; charset=utf-8"));
    EXPECT_TRUE(has(get("/cities.json"), "Content-Type: application/json"));
    EXPECT_EQ(content_type_of("a/b.html"), "application/octet-stream");
    EXPECT_EQ(content_type_of("model.glb"), "model/gltf-binary");
}

TEST_F(Responses, HeadTellsTheSameHeadWithoutTheBody) {
    const Response get_answer = get(kMesh);
    const Response head_answer = ask({.method = Method::kHead, .target = kMesh});
    EXPECT_EQ(head_answer.head, get_answer.head);
    EXPECT_EQ(head_answer.body_size, 0u);
    const Response missing = ask({.method = Method::kHead, .target = "/demo/nothing"});
    EXPECT_EQ(missing.status, 404u);
    EXPECT_EQ(missing.body_size, 0u);
    EXPECT_FALSE(has(missing, "Content-Length: 0"));
}

TEST_F(Responses, SingleRangesAreAnsweredWithTheirPart) {
    const std::string whole = test::mesh_bytes();
    struct Case {
        const char* range;
        size_t first, length;
    };
    for (const Case& c : {Case{"bytes=0-0", 0, 1}, Case{"bytes=10-19", 10, 10}, Case{"bytes=990-", 990, 10},
                          Case{"bytes=-7", 993, 7}, Case{"bytes=-5000", 0, 1000},
                          Case{"bytes=998-99999999999999999999999", 998, 2}, Case{" Bytes = 3-4 ", 3, 2}}) {
        const Response response = ask({.target = kMesh, .range = c.range});
        EXPECT_EQ(response.status, 206u) << c.range;
        EXPECT_EQ(text_of(response.body()), whole.substr(c.first, c.length)) << c.range;
        EXPECT_TRUE(has(response, "Content-Range: bytes " + std::to_string(c.first) + "-" +
                                      std::to_string(c.first + c.length - 1) + "/1000"))
            << c.range;
        EXPECT_TRUE(has(response, "Content-Length: " + std::to_string(c.length))) << c.range;
    }
}

TEST_F(Responses, RangesBeyondTheEndAreUnsatisfiable) {
    for (const char* range : {"bytes=1000-", "bytes=1000-1001", "bytes=-0", "bytes=99999999999999999999999-"}) {
        const Response response = ask({.target = kMesh, .range = range});
        EXPECT_EQ(response.status, 416u) << range;
        EXPECT_TRUE(has(response, "Content-Range: bytes */1000")) << range;
    }
    EXPECT_EQ(choose_range("bytes=0-", 0).kind, RangeKind::kUnsatisfiable);
    EXPECT_EQ(choose_range("bytes=-1", 0).kind, RangeKind::kUnsatisfiable);
}

TEST_F(Responses, OtherRangeFieldsMeanTheWholeEntity) {
    for (const char* range : {"", "bytes", "bytes=", "bytes=-", "bytes=a-b", "bytes=5-4", "bytes=1-2,5-6", "bytes=1-2x",
                              "bytes=+1-2", "lines=1-2", "bytes=1 - 2", "bytes=--1", "bytes=0x1-2"}) {
        const Response response = ask({.target = kMesh, .range = range});
        EXPECT_EQ(response.status, 200u) << range;
        EXPECT_EQ(response.body_size, 1000u) << range;
    }
    EXPECT_EQ(ask({.method = Method::kHead, .target = kMesh, .range = "bytes=0-0"}).status, 200u);
    EXPECT_EQ(ask({.target = "/", .range = "bytes=0-0"}).status, 200u);
}

TEST_F(Responses, IfRangeKeepsTheRangeOnlyForTheSameEntity) {
    const std::string tag = etag(kMesh);
    EXPECT_EQ(ask({.target = kMesh, .range = "bytes=0-0", .if_range = tag}).status, 206u);
    EXPECT_EQ(ask({.target = kMesh, .range = "bytes=0-0", .if_range = "\"other\""}).status, 200u);
    EXPECT_EQ(ask({.target = kMesh, .range = "bytes=0-0", .if_range = "W/" + tag}).status, 200u);
    EXPECT_EQ(ask({.target = kMesh, .range = "bytes=0-0", .if_range = kDate}).status, 200u);
}

TEST_F(Responses, IfNoneMatchOfTheSameEntityIsNotModified) {
    const std::string tag = etag(kMesh);
    EXPECT_TRUE(tag.starts_with('"') && tag.ends_with('"')) << tag;
    for (const std::string& list : {tag, "W/" + tag, "\"x\" , " + tag, std::string("*")}) {
        const Response response = ask({.target = kMesh, .range = "bytes=0-0", .if_none_match = list});
        EXPECT_EQ(response.status, 304u) << list;
        EXPECT_EQ(response.body_size, 0u);
        EXPECT_TRUE(has(response, "ETag: " + tag));
        EXPECT_TRUE(has(response, "Cache-Control: public, max-age=31536000, immutable"));
    }
    EXPECT_EQ(ask({.target = kMesh, .if_none_match = "\"x\""}).status, 200u);
    EXPECT_EQ(ask({.target = "/", .if_none_match = etag("/")}).status, 304u);
}

TEST_F(Responses, IfMatchOfAnotherEntityFails) {
    EXPECT_EQ(ask({.target = kMesh, .if_match = "\"other\""}).status, 412u);
    EXPECT_EQ(ask({.target = kMesh, .if_match = "W/" + etag(kMesh)}).status, 412u);
    EXPECT_EQ(ask({.target = kMesh, .if_match = etag(kMesh)}).status, 200u);
    EXPECT_EQ(ask({.target = kMesh, .if_match = "*"}).status, 200u);
}

TEST_F(Responses, TagsDifferBetweenEntries) {
    EXPECT_NE(etag(kMesh), etag("/demo/tileset.json"));
    EXPECT_NE(etag("/"), etag("/cities.json"));
}

TEST_F(Responses, OtherMethodsAreNotAllowed) {
    const Response response = ask({.method = Method::kOther, .target = kMesh, .has_body = true});
    EXPECT_EQ(response.status, 405u);
    EXPECT_TRUE(has(response, "Allow: GET, HEAD, OPTIONS"));
    EXPECT_TRUE(response.close) << "the unread body must not be taken for the next request";
    EXPECT_FALSE(ask({.method = Method::kOther, .target = kMesh}).close);
}

TEST_F(Responses, PreflightAllowsRangeRequestsFromAnywhere) {
    const Response response = ask({.method = Method::kOptions, .target = kMesh});
    EXPECT_EQ(response.status, 204u);
    EXPECT_TRUE(has(response, "Access-Control-Allow-Methods: GET, HEAD, OPTIONS"));
    EXPECT_TRUE(has(response, "Access-Control-Allow-Headers: Range, If-Range, If-Match, If-None-Match"));
    EXPECT_EQ(ask({.method = Method::kOptions, .target = "*"}).status, 204u);
}

TEST_F(Responses, BadRequestsGetOneClearLine) {
    EXPECT_EQ(get("/demo/../x").status, 400u);
    EXPECT_EQ(ask({.target = kMesh, .has_host = false}).status, 400u);
    EXPECT_EQ(ask({.target = kMesh, .http_1_0 = true, .has_host = false}).status, 200u);
    EXPECT_EQ(ask({.target = kMesh, .has_body = true}).status, 413u);
    EXPECT_EQ(get("/" + std::string(kMaxTargetBytes, 'a')).status, 414u);
    for (const std::string target : {"/demo/../x", "/demo/nothing", "/unknown/tileset.json"}) {
        const std::string body = text_of(get(target).body());
        EXPECT_EQ(body.find('\n'), body.size() - 1) << body;
    }
    EXPECT_EQ(text_of(get("/demo/nothing").body()), "the city demo has no entry nothing\n");
}

TEST_F(Responses, ACityWithoutSlashIsRedirectedRelatively) {
    const Response response = get("/demo");
    EXPECT_EQ(response.status, 308u);
    EXPECT_TRUE(has(response, "Location: demo/"));
    EXPECT_EQ(get("/unknown").status, 404u);
    EXPECT_EQ(get("/demo/").status, 200u);
}

TEST_F(Responses, FindEntriesWithEncodedNames) {
    EXPECT_EQ(text_of(get("/d%65mo/tiles/0/0/%30%2Emesh").body()), test::mesh_bytes());
}

TEST_F(Responses, ConnectionsStayOpenUnlessOneSideIsDone) {
    EXPECT_FALSE(get(kMesh).close);
    EXPECT_TRUE(ask({.target = kMesh, .keep_alive = false}).close);
    EXPECT_TRUE(has(ask({.target = kMesh, .keep_alive = false}), "Connection: close"));
    EXPECT_TRUE(has(ask({.target = kMesh, .http_1_0 = true}), "Connection: keep-alive"));
    EXPECT_TRUE(respond({.target = kMesh}, *site_, kDate, true).close);
}

TEST(HttpDate, IsImfFixdate) {
    EXPECT_EQ(http_date(784111777), "Sun, 06 Nov 1994 08:49:37 GMT");
    EXPECT_EQ(http_date(0), "Thu, 01 Jan 1970 00:00:00 GMT");
}

TEST(Refuse, EndsTheConnectionAndSaysWhenToComeBack) {
    const Response response = refuse(503, "full", kDate);
    EXPECT_TRUE(response.close);
    EXPECT_NE(response.head.find("HTTP/1.1 503 Service Unavailable\r\n"), std::string::npos);
    EXPECT_NE(response.head.find("Retry-After: 2\r\n"), std::string::npos);
    EXPECT_EQ(text_of(response.body()), "full\n");
}

}  // namespace
}  // namespace citystream::server
