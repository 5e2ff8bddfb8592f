#include "client/stream/fetcher.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "client/stream/byte_count.h"
#include "client/stream/flight_statistics.h"
#include "client/stream/http_fetcher.h"
#include "client/stream/local_fetcher.h"
#include "client/stream/network_shape.h"
#include "client/stream/request_queue.h"
#include "tests/client/stream/tiny_server.h"
#include "tiles/archive/archive.h"

namespace citystream::client {
namespace {

using test::Fault;
using test::TinyServer;

std::string text_of(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string patterned(size_t size) {
    std::string text(size, 0);
    uint32_t state = 9;
    for (char& c : text) c = static_cast<char>((state = state * 1664525u + 1013904223u) >> 24);
    return text;
}

FetcherOptions quick() {
    FetcherOptions options;
    options.connections = 2;
    options.first_backoff_seconds = 0.01;
    options.timeout_seconds = 0.3;
    return options;
}

FetchResult fetch(Fetcher& fetcher, const std::string& path, uint64_t offset, uint64_t length) {
    FetchRequest request;
    request.id = 77;
    request.path = path;
    request.offset = offset;
    request.length = length;
    fetcher.submit(request);
    for (int i = 0; i < 200; ++i) {
        for (FetchResult& result : fetcher.wait(std::chrono::milliseconds(100))) {
            if (result.id == 77) return std::move(result);
        }
    }
    return {77, Error{"no result in 20 s"}, false, 0, 0};
}

class TemporaryFolder {
  public:
    TemporaryFolder()
        : path_(std::filesystem::temp_directory_path() / ("citystream-fetcher-test-" + std::to_string(::getpid()))) {
        std::filesystem::create_directories(path_);
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    std::filesystem::path path() const { return path_; }
    void write(const std::string& name, const std::string& text) const {
        std::filesystem::create_directories((path_ / name).parent_path());
        std::ofstream(path_ / name, std::ios::binary) << text;
    }

  private:
    std::filesystem::path path_;
};

TEST(NetworkShape, ReadsRatesAndRoundTrips) {
    const auto shape = NetworkShape::parse("5mbit,38ms");
    ASSERT_TRUE(shape);
    EXPECT_EQ(shape->bits_per_second, 5e6);
    EXPECT_DOUBLE_EQ(shape->round_trip_seconds, 0.038);
    EXPECT_EQ(NetworkShape::parse("64kbit")->bits_per_second, 64e3);
    EXPECT_EQ(NetworkShape::parse("0.1s,1gbit")->bits_per_second, 1e9);
    for (const char* bad : {"", "5", "mbit", "5mbit,", "5mbit,6mbit", "-1mbit", "5parsec", "5mbit,61s", "nanmbit"}) {
        EXPECT_FALSE(NetworkShape::parse(bad)) << bad;
    }
}

TEST(ByteCount, ReadsSizesAsPeopleWriteThem) {
    EXPECT_EQ(*parse_byte_count("512MiB"), 512u << 20);
    EXPECT_EQ(*parse_byte_count("1.5gib"), 3u << 29);
    EXPECT_EQ(*parse_byte_count("2MB"), 2'000'000u);
    EXPECT_EQ(*parse_byte_count("1234"), 1234u);
    for (const char* bad : {"", "MiB", "-1", "1 parsec", "1e30", "nan"}) EXPECT_FALSE(parse_byte_count(bad)) << bad;
}

TEST(Percentile, IsTheNearestRank) {
    EXPECT_EQ(percentile({}, 50), 0);
    EXPECT_EQ(percentile({3, 1, 2}, 50), 2);
    EXPECT_EQ(percentile({4, 3, 2, 1}, 100), 4);
    EXPECT_EQ(percentile({4, 3, 2, 1}, 90), 4);
    EXPECT_EQ(percentile({4, 3, 2, 1}, 25), 1);
}

TEST(RequestQueue, HandsOutTheMostUrgentAndYieldsOneResultEach) {
    RequestQueue queue;
    for (uint64_t id = 1; id <= 3; ++id) queue.submit({id, "a", 0, 0, 1, id == 2 ? 9.0 : 1.0});
    EXPECT_EQ(queue.take()->id, 2u);
    queue.cancel(1);
    queue.cancel(2);
    queue.deliver({2, std::vector<std::byte>(5), false, 1, 0});
    EXPECT_EQ(queue.take()->id, 3u);
    queue.deliver({3, std::vector<std::byte>(5), false, 1, 0});
    queue.deliver({3, std::vector<std::byte>(5), false, 1, 0});
    const auto results = queue.poll();
    ASSERT_EQ(results.size(), 3u);
    EXPECT_TRUE(results[0].cancelled);
    EXPECT_TRUE(results[1].cancelled);
    EXPECT_FALSE(results[1].bytes);
    EXPECT_FALSE(results[2].cancelled);
    EXPECT_EQ(queue.pending(), 0u);
    EXPECT_EQ(queue.statistics().cancelled, 2u);
}

TEST(HttpPlace, TakesAddressesApart) {
    const auto place = parse_http_place("http://localhost:8080/city/tileset.json");
    ASSERT_TRUE(place);
    EXPECT_EQ(place->host, "localhost");
    EXPECT_EQ(place->port, "8080");
    EXPECT_EQ(place->base, "/city/");
    EXPECT_TRUE(place->has_path);
    EXPECT_EQ(parse_http_place("http://a/b/c")->base, "/b/c/");
    EXPECT_EQ(parse_http_place("http://a")->port, "80");
    EXPECT_FALSE(parse_http_place("http://a:1/")->has_path);
    EXPECT_EQ(parse_http_place("http://[::1]:80/x")->host, "[::1]");
    for (const char* bad : {"http://", "http://:80", "http://a:0", "http://a:70000", "http://a:x", "http://a b/",
                            "http://u@a/", "http://a/\r\nx", "http://[::1", "ftp://a"}) {
        EXPECT_FALSE(parse_http_place(bad)) << bad;
    }
}

TEST(HttpPlace, ReadsContentRangesStrictly) {
    const auto range = parse_content_range("bytes 5-9/100");
    ASSERT_TRUE(range);
    EXPECT_EQ(range->first, 5u);
    EXPECT_EQ(range->last, 9u);
    EXPECT_EQ(*range->total, 100u);
    EXPECT_FALSE(parse_content_range("bytes 5-9/*")->total.has_value());
    for (const char* bad :
         {"", "bytes", "bytes 9-5/100", "bytes 5-9/9", "bytes 5-/9", "items 5-9/10", "bytes 5-9/10x"}) {
        EXPECT_FALSE(parse_content_range(bad)) << bad;
    }
}

TEST(HttpFetcher, ReadsRangesAndWholeEntriesOverKeptConnections) {
    const std::string body = patterned(100'000);
    TinyServer server(TinyServer::Files{{"/city/tiles/a", body}});
    auto fetcher = Fetcher::open(server.address() + "/city", quick());
    ASSERT_TRUE(fetcher) << fetcher.error().text();
    for (int i = 0; i < 20; ++i) {
        const FetchResult part = fetch(**fetcher, "tiles/a", 1000u * i, 777);
        ASSERT_TRUE(part.bytes) << part.bytes.error().text();
        EXPECT_EQ(text_of(*part.bytes), body.substr(1000u * i, 777));
    }
    EXPECT_EQ(text_of(*fetch(**fetcher, "tiles/a", 0, 0).bytes), body);
    EXPECT_EQ(server.connections(), 1) << "one request at a time needs one connection";
    EXPECT_EQ((*fetcher)->statistics().body_bytes, 20u * 777 + body.size());
    EXPECT_GT((*fetcher)->statistics().header_bytes, 21u * 40);
}

TEST(HttpFetcher, SurvivesEveryKindOfBadAnswer) {
    const std::string body = patterned(50'000);
    TinyServer server(TinyServer::Files{{"/a", body}});
    for (const Fault fault : {Fault::kCloseAtOnce, Fault::kCloseInBody, Fault::kWrongRange, Fault::kShortBody,
                              Fault::kStatus500, Fault::kGarbage, Fault::kStall}) {
        auto fetcher = Fetcher::open(server.address() + "/tileset.json", quick());
        ASSERT_TRUE(fetcher);
        ASSERT_TRUE(fetch(**fetcher, "a", 0, 10).bytes);
        server.set_faults({fault, fault});
        const FetchResult result = fetch(**fetcher, "a", 30'000, 9'999);
        ASSERT_TRUE(result.bytes) << static_cast<int>(fault) << ": " << result.bytes.error().text();
        EXPECT_EQ(text_of(*result.bytes), body.substr(30'000, 9'999));
        EXPECT_GE(result.attempts, 2u);
    }
}

TEST(HttpFetcher, SlicesTheWholeFileOfAServerThatKnowsNoRanges) {
    const std::string body = patterned(300'000);
    TinyServer server(TinyServer::Files{{"/a", body}});
    server.always(Fault::kNoRanges);
    auto fetcher = Fetcher::open(server.address() + "/tileset.json", quick());
    ASSERT_TRUE(fetcher);
    const FetchResult result = fetch(**fetcher, "a", 123'456, 1000);
    ASSERT_TRUE(result.bytes) << result.bytes.error().text();
    EXPECT_EQ(text_of(*result.bytes), body.substr(123'456, 1000));
    EXPECT_GE((*fetcher)->statistics().body_bytes, 124'456u) << "what came is counted, wanted or not";
    const FetchResult beyond = fetch(**fetcher, "a", 299'999, 1000);
    EXPECT_FALSE(beyond.bytes);
}

TEST(HttpFetcher, DoesNotAskAgainForWhatIsNotThere) {
    TinyServer server(TinyServer::Files{{"/a", "x"}});
    auto fetcher = Fetcher::open(server.address() + "/tileset.json", quick());
    ASSERT_TRUE(fetcher);
    const FetchResult result = fetch(**fetcher, "nothing", 0, 10);
    ASSERT_FALSE(result.bytes);
    EXPECT_NE(result.bytes.error().text().find("404"), std::string::npos);
    EXPECT_NE(result.bytes.error().text().find("/nothing"), std::string::npos);
    EXPECT_EQ(result.attempts, 1u);
}

TEST(HttpFetcher, GivesUpWithOneLineAndThenTriesOnceEachUntilTheServerIsBack) {
    TinyServer server(TinyServer::Files{{"/a", "0123456789"}});
    FetcherOptions options = quick();
    options.max_attempts = 4;
    auto fetcher = Fetcher::open(server.address() + "/tileset.json", options);
    ASSERT_TRUE(fetch(**fetcher, "a", 0, 10).bytes);
    server.stop();
    const FetchResult first = fetch(**fetcher, "a", 0, 10);
    ASSERT_FALSE(first.bytes);
    EXPECT_EQ(first.attempts, 4u);
    EXPECT_EQ(first.bytes.error().text().find('\n'), std::string::npos);
    EXPECT_EQ(fetch(**fetcher, "a", 0, 10).attempts, 1u);
    server.start_again();
    EXPECT_TRUE(fetch(**fetcher, "a", 0, 10).bytes);
    EXPECT_GT((*fetcher)->statistics().retries, 0u);
}

TEST(HttpFetcher, AServerThatDiesAndComesBackIsSurvived) {
    TinyServer server(TinyServer::Files{{"/a", "0123456789"}});
    FetcherOptions options = quick();
    options.first_backoff_seconds = 0.05;
    auto fetcher = Fetcher::open(server.address() + "/tileset.json", options);
    ASSERT_TRUE(fetch(**fetcher, "a", 0, 10).bytes);
    server.stop();
    (*fetcher)->submit({5, "a", 2, 4, 100, 0});
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    server.start_again();
    std::vector<FetchResult> results;
    for (int i = 0; i < 100 && results.empty(); ++i) results = (*fetcher)->wait(std::chrono::milliseconds(100));
    ASSERT_EQ(results.size(), 1u);
    ASSERT_TRUE(results[0].bytes) << results[0].bytes.error().text();
    EXPECT_EQ(text_of(*results[0].bytes), "2345");
}

TEST(HttpFetcher, RefusesAnEntryLargerThanAllowed) {
    TinyServer server(TinyServer::Files{{"/a", patterned(100'000)}});
    auto fetcher = Fetcher::open(server.address() + "/tileset.json", quick());
    EXPECT_FALSE(fetch_now(**fetcher, "a", 50'000));
    EXPECT_TRUE(fetch_now(**fetcher, "a", 100'000));
}

TEST(HttpFetcher, TakesTheOnlyCityOfAServerAndNamesThemWhenThereAreMore) {
    TinyServer one(TinyServer::Files{
        {"/cities.json", R"({"cities":[{"name":"delft","tileset":"/delft/tileset.json"}]})"}, {"/delft/a", "A"}});
    auto fetcher = Fetcher::open(one.address(), quick());
    ASSERT_TRUE(fetcher) << fetcher.error().text();
    EXPECT_TRUE(fetch_now(**fetcher, "a", 10));
    TinyServer two(TinyServer::Files{
        {"/cities.json",
         R"({"cities":[{"name":"delft","tileset":"/delft/tileset.json"},{"name":"bonn","tileset":"/bonn/tileset.json"}]})"}});
    const auto several = Fetcher::open(two.address() + "/", quick());
    ASSERT_FALSE(several);
    EXPECT_NE(several.error().text().find("delft, bonn"), std::string::npos) << several.error().text();
    TinyServer plain(TinyServer::Files{{"/a", "root"}});
    auto root = Fetcher::open(plain.address(), quick());
    ASSERT_TRUE(root) << "a static server without a list has its city at the root";
    EXPECT_TRUE(fetch_now(**root, "a", 10));
}

TEST(HttpFetcher, ManyFetchersShareOneThread) {
    const std::string body = patterned(5000);
    TinyServer server(TinyServer::Files{{"/a", body}});
    FetcherOptions options = quick();
    options.network = std::make_shared<NetworkThreads>(1);
    std::vector<std::unique_ptr<Fetcher>> fetchers;
    for (int i = 0; i < 30; ++i)
        fetchers.push_back(std::move(*Fetcher::open(server.address() + "/tileset.json", options)));
    for (uint64_t i = 0; i < fetchers.size(); ++i) fetchers[i]->submit({i, "a", i, 100, 100, 0});
    for (uint64_t i = 0; i < fetchers.size(); ++i) {
        const auto results = fetchers[i]->wait(std::chrono::seconds(10));
        ASSERT_EQ(results.size(), 1u);
        ASSERT_TRUE(results[0].bytes) << results[0].bytes.error().text();
        EXPECT_EQ(text_of(*results[0].bytes), body.substr(i, 100));
    }
    fetchers[0]->submit({1, "a", 0, 100, 100, 0});  // destroyed while under way
}

TEST(HttpFetcher, ShapingHoldsBytesToTheRateAndAddsTheRoundTrip) {
    TinyServer server(TinyServer::Files{{"/a", patterned(40'000)}});
    FetcherOptions options = quick();
    options.timeout_seconds = 5;
    options.shape = NetworkShape{1.6e6, 0.05};  // 40,000 bytes in 0.2 s
    auto fetcher = Fetcher::open(server.address() + "/tileset.json", options);
    const FetchResult result = fetch(**fetcher, "a", 0, 40'000);
    ASSERT_TRUE(result.bytes);
    EXPECT_GE(result.seconds, 0.25);
    EXPECT_LE(result.seconds, 2.0);
}

/// Seconds of one answer of `size` bytes while the other connection asks for one small range after the other.
double seconds_beside_small_requests(Fetcher& fetcher, uint64_t size, uint64_t& next_id) {
    const uint64_t large = next_id++;
    fetcher.submit({large, "a", 0, size, size, 9});
    if (fetcher.pending() < 2) fetcher.submit({next_id++, "a", 0, 100, 100, 0});
    while (true) {
        for (const FetchResult& result : fetcher.wait(std::chrono::milliseconds(100))) {
            if (result.id == large) return result.bytes ? result.seconds : 1e9;
            fetcher.submit({next_id++, "a", 0, 100, 100, 0});
        }
    }
}

TEST(HttpFetcher, ShapingLetsAnAnswerPassWhileOtherRequestsAreOnTheirWay) {
    TinyServer server(TinyServer::Files{{"/a", patterned(200'000)}});
    FetcherOptions options = quick();
    options.timeout_seconds = 10;
    options.shape = NetworkShape{8e6, 0.05};  // 200,000 bytes in 0.2 s, after two round trips
    auto fetcher = Fetcher::open(server.address() + "/tileset.json", options);
    ASSERT_TRUE(fetcher);
    // A busy machine only ever adds time: the best of a few counts.
    double best = 1e9;
    uint64_t next_id = 1;
    for (int attempt = 0; attempt < 3 && best > 0.45; ++attempt)
        best = std::min(best, seconds_beside_small_requests(**fetcher, 200'000, next_id));
    EXPECT_GE(best, 0.25);
    EXPECT_LE(best, 0.45) << "the link idles while a request is on its way";
}

using LinkClock = ShapedLink::Clock;

TEST(ShapedLink, PassesNoMoreBytesThanItsRateInAnySpan) {
    ShapedLink link(NetworkShape{8e6, 0});  // 1,000 bytes in 1 ms
    const LinkClock::time_point begin{std::chrono::hours(1)};
    LinkClock::time_point now = begin;
    uint64_t bytes = 0, state = 5;
    for (int i = 0; i < 2000; ++i) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        now += std::chrono::microseconds((state >> 33) % 4000);  // on time, late, or long idle
        bytes += (state >> 50) % 3000;
        const auto passed = link.reserve((state >> 50) % 3000, now);
        ASSERT_GE(passed, now);
        now = std::max(now, passed);
        const double span = std::chrono::duration<double>(now + ShapedLink::kLateness - begin).count();
        ASSERT_LE(static_cast<double>(bytes), 1e6 * span);
    }
}

TEST(ShapedLink, LosesNothingToSleepersThatWakeALittleLate) {
    ShapedLink link(NetworkShape{8e6, 0});
    const LinkClock::time_point begin{std::chrono::hours(1)};
    LinkClock::time_point now = begin;
    for (int i = 0; i < 100; ++i) now = link.reserve(1000, now) + std::chrono::microseconds(300);
    const auto seconds = std::chrono::duration<double>(now - begin).count();
    EXPECT_NEAR(seconds, 0.1, 0.001);
    const LinkClock::time_point later = now + std::chrono::seconds(1);
    EXPECT_EQ(link.reserve(1000, later), later + std::chrono::milliseconds(1)) << "an idle second earns nothing";
}

TEST(ShapedLink, WithoutARateBytesTakeNoTime) {
    ShapedLink link(NetworkShape{0, 0.04});
    const LinkClock::time_point now{std::chrono::hours(1)};
    EXPECT_EQ(link.reserve(1'000'000'000, now), now);
    EXPECT_EQ(link.half_round_trip(), std::chrono::milliseconds(20));
}

TEST(LocalFetcher, ShapingHoldsBytesToTheRateAndAddsTheRoundTrip) {
    FetcherOptions options;
    options.shape = NetworkShape{8e6, 0.02};
    auto fetcher = make_local_fetcher([](const FetchRequest&) { return std::vector<std::byte>(20'000); }, options);
    const auto begin = std::chrono::steady_clock::now();
    for (uint64_t i = 0; i < 5; ++i) fetcher->submit({i, "a", 0, 20'000, 20'000, 0});
    size_t results = 0;
    while (results < 5) results += fetcher->wait(std::chrono::milliseconds(100)).size();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    EXPECT_GE(seconds, 0.119);  // 100,000 bytes at 1 MB/s, after one round trip
    EXPECT_LE(seconds, 1.0);
}

TEST(FolderFetcher, ReadsEntriesAndNothingOutside) {
    const TemporaryFolder folder;
    folder.write("city/tiles/0/a", "0123456789");
    folder.write("city/tileset.json", "{}");
    folder.write("secret", "no");
    std::filesystem::create_symlink("../secret", folder.path() / "city/link");
    std::filesystem::create_symlink("..", folder.path() / "city/up");
    for (const char* place : {"city", "city/tileset.json"}) {
        auto fetcher = Fetcher::open((folder.path() / place).string(), {});
        ASSERT_TRUE(fetcher) << fetcher.error().text();
        EXPECT_EQ(text_of(*fetch(**fetcher, "tiles/0/a", 3, 4).bytes), "3456");
        EXPECT_EQ(text_of(*fetch(**fetcher, "tiles/0/a", 0, 0).bytes), "0123456789");
        for (const char* bad :
             {"../secret", "link", "up/secret", "/etc/passwd", "tiles", "tiles//0/a", "./tileset.json", "none", ""}) {
            EXPECT_FALSE(fetch(**fetcher, bad, 0, 0).bytes) << bad;
        }
        EXPECT_FALSE(fetch(**fetcher, "tiles/0/a", 8, 4).bytes);
        EXPECT_FALSE(fetch(**fetcher, "tiles/0/a", ~uint64_t{0} - 1, 4).bytes);
    }
}

TEST(ArchiveFetcher, ReadsRangesOfEntries) {
    const TemporaryFolder folder;
    const std::string file = (folder.path() / "c.3tz").string();
    const std::string body = patterned(1000);
    {
        auto writer = tiles::archive::ArchiveWriter::create(file);
        ASSERT_TRUE(writer);
        ASSERT_TRUE((*writer)->add("tiles/a", std::as_bytes(std::span(body))));
        ASSERT_TRUE((*writer)->finish());
    }
    auto fetcher = Fetcher::open(file, {});
    ASSERT_TRUE(fetcher) << fetcher.error().text();
    EXPECT_EQ(text_of(*fetch(**fetcher, "tiles/a", 100, 50).bytes), body.substr(100, 50));
    const FetchResult missing = fetch(**fetcher, "tiles/b", 0, 0);
    ASSERT_FALSE(missing.bytes);
    EXPECT_NE(missing.bytes.error().text().find("tiles/b"), std::string::npos);
}

TEST(Fetcher, SaysWhatIsWrongWithAPlace) {
    for (const char* place : {"/nonexistent/city.3tz", "https://host/city", "http://", "ftp://host"}) {
        const auto fetcher = Fetcher::open(place, {});
        ASSERT_FALSE(fetcher) << place;
        EXPECT_NE(fetcher.error().text().find(place), std::string::npos);
    }
}

}  // namespace
}  // namespace citystream::client
