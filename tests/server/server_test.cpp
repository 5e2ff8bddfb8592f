// The real server on a port of its own, asked over raw sockets.
#include "server/server.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/server/raw_client.h"
#include "tests/server/synthetic_city.h"

namespace citystream::server {
namespace {

using namespace std::chrono_literals;
using namespace std::string_literals;
using test::RawAnswer;
using test::RawClient;

constexpr const char* kMesh = "/demo/tiles/0/0/0.mesh";

class ServerTest : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder_ = std::make_unique<test::TemporaryFolder>();
        test::write_city(*folder_ / "demo.3tz", "Demo", true);
        test::write_city(*folder_ / "other.3tz", "Other");
    }
    static void TearDownTestSuite() { folder_.reset(); }

    void start(ServerOptions options = {}) {
        auto catalog = ArchiveCatalog::open({*folder_ / "demo.3tz", *folder_ / "other.3tz"});
        ASSERT_TRUE(catalog.ok()) << catalog.error().text();
        options.listen.port = 0;
        options.threads = 2;
        auto server = Server::start(std::move(*catalog), options);
        ASSERT_TRUE(server.ok()) << server.error().text();
        server_ = std::move(*server);
    }
    uint16_t port() const { return server_->port(); }

    static std::unique_ptr<test::TemporaryFolder> folder_;
    std::unique_ptr<Server> server_;
};

std::unique_ptr<test::TemporaryFolder> ServerTest::folder_;

TEST_F(ServerTest, AnswersManyRequestsOnOneConnection) {
    start();
    RawClient client(port());
    for (int i = 0; i < 50; ++i) {
        const RawAnswer answer = client.ask(kMesh);
        ASSERT_EQ(answer.status, 200);
        ASSERT_EQ(answer.body, test::mesh_bytes());
    }
    server_->request_stop();
    server_->wait();
    EXPECT_EQ(server_->summary().requests, 50u);
}

TEST_F(ServerTest, AnswersPipelinedRequestsInOrder) {
    start();
    RawClient client(port());
    const std::string whole = test::mesh_bytes();
    std::string requests;
    for (int i = 0; i < 200; ++i) {
        requests += "GET " + std::string(kMesh) + " HTTP/1.1\r\nHost: t\r\nRange: bytes=" + std::to_string(i) + "-" +
                    std::to_string(i + 2) + "\r\n\r\n";
    }
    client.send(requests);
    for (size_t i = 0; i < 200; ++i) {
        const RawAnswer answer = client.answer();
        ASSERT_EQ(answer.status, 206) << i;
        ASSERT_EQ(answer.body, whole.substr(i, 3)) << i;
    }
}

TEST_F(ServerTest, TakesAHeadInSmallPieces) {
    start();
    RawClient client(port());
    for (const char c : std::string("GET /healthz HTTP/1.1\r\nHost: t\r\n\r\n")) client.send(std::string_view(&c, 1));
    EXPECT_EQ(client.answer().body, "ok\n");
}

TEST_F(ServerTest, SendsALargeEntryWhole) {
    start();
    RawClient client(port());
    const RawAnswer answer = client.ask("/demo/tiles/large");
    EXPECT_EQ(answer.status, 200);
    EXPECT_TRUE(answer.body == test::large_bytes());
}

TEST_F(ServerTest, HeadIsFollowedByNoBody) {
    start();
    RawClient client(port());
    const RawAnswer head = client.ask(kMesh, "", "HEAD");
    EXPECT_EQ(head.field("content-length"), "1000");
    EXPECT_EQ(client.ask("/healthz").body, "ok\n") << "the next answer must follow at once";
}

TEST_F(ServerTest, ConditionalRequestIsNotModified) {
    start();
    RawClient client(port());
    const auto tag = client.ask(kMesh).field("etag");
    ASSERT_TRUE(tag);
    EXPECT_EQ(client.ask(kMesh, "If-None-Match: \"x\"\r\nIf-None-Match: " + *tag + "\r\n").status, 304);
    EXPECT_EQ(client.ask(kMesh, "Range: bytes=0-1\r\nIf-Range: " + *tag + "\r\n").body.size(), 2u);
    EXPECT_EQ(client.ask(kMesh, "Range: bytes=0-1\r\nRange: bytes=2-3\r\n").status, 200)
        << "two Range lines are several ranges";
}

TEST_F(ServerTest, ServesSeveralCities) {
    start();
    RawClient client(port());
    EXPECT_EQ(client.ask("/demo/tileset.json").status, 200);
    EXPECT_EQ(client.ask("/other/tileset.json").status, 200);
    EXPECT_EQ(client.ask("/other/tiles/large").status, 404);
    EXPECT_EQ(client.ask("/third/tileset.json").status, 404);
    EXPECT_NE(client.ask("/").body.find("other/"), std::string::npos);
}

TEST_F(ServerTest, NothingOutsideTheArchivesIsReached) {
    start();
    std::ifstream list(CITYSTREAM_SOURCE_DIR "/tests/data/server/path_attacks.txt");
    ASSERT_TRUE(list) << "the list of attacks is missing";
    size_t attacks = 0;
    for (std::string target; std::getline(list, target);) {
        if (target.empty() || target.front() == ';') continue;
        ++attacks;
        RawClient client(port());
        const RawAnswer answer = client.ask(target);
        EXPECT_TRUE(answer.status == 400 || answer.status == 404) << target << " got " << answer.status;
        EXPECT_EQ(answer.body.find("root:"), std::string::npos) << target;
    }
    EXPECT_GT(attacks, 40u);
}

TEST_F(ServerTest, RefusesWhatIsNoRequest) {
    start();
    const std::vector<std::pair<std::string, int>> cases = {
        {"hello\r\n\r\n", 400},
        {"GET / HTTP/1.1\r\nHost t\r\n\r\n", 400},
        {"GET / HTTP/1.1\r\n\r\n", 400},
        {"GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n", 400},
        {"GET / HTTP/1.1\r\nHost: a\r\nContent-Length: x\r\n\r\n", 400},
        {"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", 505},
        {"GET / HTTP/1.1\r\nHost: a\r\nContent-Length: 4\r\n\r\nbody", 413},
        {"GET / HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n", 413},
        {"DELETE /demo/tileset.json HTTP/1.1\r\nHost: a\r\n\r\n", 405},
        {"POST /demo/tileset.json HTTP/1.1\r\nHost: a\r\nContent-Length: 3\r\n\r\nabc", 405},
        {"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03 a TLS hello\r\n\r\n"s, 400},
    };
    for (const auto& [request, status] : cases) {
        RawClient client(port());
        client.send(request);
        EXPECT_EQ(client.answer().status, status) << request;
    }
}

TEST_F(ServerTest, KeepsHttp10ConnectionsOnlyWhenAsked) {
    start();
    RawClient brief(port());
    brief.send("GET /healthz HTTP/1.0\r\n\r\n");
    EXPECT_EQ(brief.answer().body, "ok\n");
    EXPECT_TRUE(brief.ended_within(2s));
    RawClient lasting(port());
    lasting.send("GET /healthz HTTP/1.0\r\nConnection: keep-alive\r\n\r\n");
    EXPECT_EQ(lasting.answer().field("connection"), "keep-alive");
    EXPECT_EQ(lasting.ask("/healthz").status, 200);
}

TEST_F(ServerTest, RefusesAnOversizeHead) {
    start();
    RawClient client(port());
    client.send("GET / HTTP/1.1\r\nHost: t\r\nX: " + std::string(64 * 1024, 'x') + "\r\n\r\n");
    EXPECT_EQ(client.answer().status, 431);
    EXPECT_TRUE(client.ended_within(3s));
    RawClient long_target(port());
    EXPECT_EQ(long_target.ask("/" + std::string(8000, 'a')).status, 414);
}

TEST_F(ServerTest, EndsASlowHeadAndAnIdleConnection) {
    start({.idle_timeout = 300ms});
    RawClient idle(port()), slow(port());
    slow.send("GET / HTTP/1.1\r\nHost: t\r\n");
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < 60 && slow.send("X: y\r\n") && !slow.ended_within(20ms); ++i) {
    }
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 1100ms)
        << "trickling fields must not extend the time for a head";
    EXPECT_EQ(slow.answer().status, 408);
    EXPECT_TRUE(idle.ended_within(2s));
    EXPECT_NE(RawClient(port()).ask("/metrics").body.find("citystream_timeouts_total 1\n"), std::string::npos);
}

TEST_F(ServerTest, EndsAnAnswerThatNobodyTakes) {
    start({.idle_timeout = 300ms});
    RawClient client(port(), 4096);
    client.get("/demo/tiles/large");
    std::this_thread::sleep_for(900ms);
    EXPECT_EQ(client.answer().status, 0) << "the answer must have been broken off";
    EXPECT_NE(RawClient(port()).ask("/metrics").body.find("citystream_answers_broken_off_total 1\n"),
              std::string::npos);
}

TEST_F(ServerTest, TurnsAwayConnectionsBeyondTheLimit) {
    start({.max_connections = 3});
    std::vector<std::unique_ptr<RawClient>> guests;
    for (int i = 0; i < 3; ++i) {
        guests.push_back(std::make_unique<RawClient>(port()));
        ASSERT_EQ(guests.back()->ask("/healthz").status, 200);
    }
    RawClient late(port());
    const RawAnswer answer = late.answer();
    EXPECT_EQ(answer.status, 503);
    EXPECT_EQ(answer.field("connection"), "close");
    EXPECT_TRUE(late.ended_within(3s));
    guests.pop_back();
    int status = 0;
    for (int i = 0; i < 100 && status != 200; ++i) {
        std::this_thread::sleep_for(20ms);
        status = RawClient(port()).ask("/healthz").status;
    }
    EXPECT_EQ(status, 200) << "a free place must be given to the next";
}

TEST_F(ServerTest, FinishesAnAnswerUnderWayWhenStopping) {
    start();
    RawClient client(port(), 4096), idle(port());
    ASSERT_EQ(idle.ask("/healthz").status, 200);
    client.get("/demo/tiles/large");
    std::this_thread::sleep_for(50ms);
    server_->request_stop();
    EXPECT_TRUE(idle.ended_within(2s));
    const RawAnswer answer = client.answer();
    EXPECT_EQ(answer.status, 200);
    EXPECT_TRUE(answer.body == test::large_bytes());
    EXPECT_TRUE(client.ended_within(2s));
    server_->wait();
    EXPECT_FALSE(RawClient(port()).connected());
}

TEST_F(ServerTest, StopsInTimeThoughAnAnswerIsNotTaken) {
    start({.shutdown_grace = 300ms});
    RawClient client(port(), 4096);
    client.get("/demo/tiles/large");
    std::this_thread::sleep_for(50ms);
    const auto begin = std::chrono::steady_clock::now();
    server_->request_stop();
    server_->wait();
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 3s);
}

TEST_F(ServerTest, ServesManyClientsAtOnce) {
    start();
    std::vector<std::thread> threads;
    std::atomic<int> good{0};
    for (int t = 0; t < 8; ++t) {
        threads.emplace_back([&] {
            const std::string expected = test::mesh_bytes();
            for (int c = 0; c < 5; ++c) {
                RawClient client(port());
                for (int i = 0; i < 20; ++i) good += client.ask(kMesh).body == expected ? 1 : 0;
            }
        });
    }
    for (auto& thread : threads) thread.join();
    EXPECT_EQ(good, 800);
}

TEST_F(ServerTest, SaysWhenThePortIsTaken) {
    start();
    auto catalog = ArchiveCatalog::open({*folder_ / "demo.3tz"});
    ASSERT_TRUE(catalog.ok());
    const auto second = Server::start(std::move(*catalog), {.listen = {"127.0.0.1", port()}});
    ASSERT_FALSE(second.ok());
    EXPECT_EQ(second.error().text(),
              "cannot listen on 127.0.0.1:" + std::to_string(port()) + ": Address already in use");
}

TEST_F(ServerTest, MetricsHaveTheRecordedNames) {
    start();
    RawClient client(port());
    client.ask(kMesh);
    client.ask(kMesh, "Range: bytes=0-1\r\n");
    client.ask("/nowhere/x");
    const RawAnswer answer = client.ask("/metrics");
    EXPECT_EQ(answer.field("content-type"), "text/plain; version=0.0.4; charset=utf-8");
    for (const char* line :
         {"citystream_requests_total{city=\"demo\",class=\"2xx\"} 2\n",
          "citystream_requests_total{city=\"\",class=\"4xx\"} 1\n", "citystream_body_bytes_total{city=\"demo\"} 1002\n",
          "citystream_partial_answers_total{city=\"demo\"} 1\n", "citystream_connections_open 1\n",
          "citystream_requests_in_flight 1\n", "citystream_request_duration_seconds_count 3\n"}) {
        EXPECT_NE(answer.body.find(line), std::string::npos) << line << "is missing in\n" << answer.body;
    }
    std::set<std::string> families, recorded;
    std::istringstream text(answer.body);
    for (std::string line; std::getline(text, line);) {
        if (line.starts_with("# TYPE ")) families.insert(line.substr(7));
    }
    std::ifstream record(CITYSTREAM_SOURCE_DIR "/tests/data/server/metric_families.txt");
    for (std::string line; std::getline(record, line);) recorded.insert(line);
    EXPECT_EQ(families, recorded);
}

TEST(ListenAddress, ReadsTheUsualForms) {
    const auto parse = [](const char* text) {
        const auto address = ListenAddress::parse(text);
        return address.ok() ? address->host + " " + std::to_string(address->port) : std::string("error");
    };
    EXPECT_EQ(parse("127.0.0.1:8080"), "127.0.0.1 8080");
    EXPECT_EQ(parse("[::1]:0"), "::1 0");
    EXPECT_EQ(parse(":80"), "0.0.0.0 80");
    EXPECT_EQ(parse("9000"), "127.0.0.1 9000");
    for (const char* bad : {"", "host:", "host:x", "host:65536", "::1:80", "host:-1", "host:80x"})
        EXPECT_EQ(parse(bad), "error") << bad;
}

TEST(Duration, ReadsUnitsAndRefusesNonsense) {
    EXPECT_EQ(*parse_duration("30s"), 30000ms);
    EXPECT_EQ(*parse_duration("1.5"), 1500ms);
    EXPECT_EQ(*parse_duration("250ms"), 250ms);
    EXPECT_EQ(*parse_duration("2m"), 120000ms);
    for (const char* bad : {"", "s", "-1s", "0", "1h", "1e99s", "nan", "25000m", "5 s"})
        EXPECT_FALSE(parse_duration(bad).ok()) << bad;
}

}  // namespace
}  // namespace citystream::server
