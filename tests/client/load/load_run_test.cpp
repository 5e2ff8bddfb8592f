// Whole load runs over a tiny city read from its file: no network, so what must come is known exactly.
#include "client/load/load_run.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "client/load/load_report.h"
#include "tests/client/load/tiny_city.h"

namespace citystream::client {
namespace {

using namespace std::chrono_literals;

class LoadRun : public testing::Test {
  protected:
    LoadRun() {
        options_.client.place = city_.file();
        options_.client.width = 640;
        options_.client.height = 360;
        options_.clients = 5;
        options_.duration_seconds = 0.8;
        options_.ramp_seconds = 0.1;
        options_.threads = 2;
        // Hovers above the middle and looks down: sees all four children at full quality.
        for (const double t : {0.0, 10.0})
            path_.samples.push_back({t, 1000.0 * 128 + 64, 2000.0 * 128 + 64, 160, t, -89, 60});
    }
    LoadOutcome run() { return run_load(options_, path_, stop_, nullptr); }

    test::TinyCity city_;
    LoadOptions options_;
    CameraPath path_;
    std::atomic<bool> stop_{false};
};

TEST_F(LoadRun, EveryClientFetchesWhatItSeesExactlyOnce) {
    const LoadOutcome outcome = run();
    const LoadMeasurements& m = outcome.measured;
    EXPECT_EQ(outcome.clients_opened, 5u);
    EXPECT_EQ(m.failed, 0u) << m.first_error;
    EXPECT_EQ(m.unanswered, 0u);
    EXPECT_EQ(m.tiles_unfinished, 0u);
    // The root is held as a stand-in; the children are drawn whole.
    const uint64_t root_bytes = 2 * test::kStepBytes;
    EXPECT_EQ(m.layer_bytes, 5 * (city_.fine_bytes() + root_bytes));
    EXPECT_EQ(m.layer_bytes + m.directory_bytes, m.fetcher.body_bytes);
    EXPECT_GE(m.drawn_bytes, 5 * city_.fine_bytes());
    EXPECT_LE(m.drawn_bytes, m.layer_bytes);
    EXPECT_GE(over_fetch_of(m), 1.0);
    EXPECT_GE(m.tiles_visible, 20u);
    EXPECT_EQ(m.tiles_visible + m.tiles_unused, 25u);
    EXPECT_EQ(m.visible.count(), m.tiles_visible);
    EXPECT_EQ(m.opening.count(), 5u);
    EXPECT_EQ(m.request.count() + 2 * 5, m.answers) << "tileset.json and the root subtree belong to opening";
}

TEST_F(LoadRun, UpdatesKeepTheirSchedule) {
    options_.updates_per_second = 50;
    const LoadOutcome outcome = run();
    uint64_t expected = 0;
    for (uint32_t i = 0; i < options_.clients; ++i) {
        const double delay = start_of_client(i, options_, path_.duration()).delay_seconds;
        expected += static_cast<uint64_t>(std::ceil((options_.duration_seconds - delay) * options_.updates_per_second));
    }
    EXPECT_NEAR(static_cast<double>(outcome.measured.updates), static_cast<double>(expected), 5);
    EXPECT_EQ(outcome.measured.lateness.count(), outcome.measured.updates);
}

TEST_F(LoadRun, ASlowLinkShowsInTheLatencies) {
    options_.client.fetcher.shape = NetworkShape{0, 0.1};
    options_.duration_seconds = 1.5;
    const LoadOutcome outcome = run();
    EXPECT_GE(outcome.measured.request.percentile(50), 90ms);
    EXPECT_GE(outcome.measured.visible.percentile(50), 90ms);
}

TEST_F(LoadRun, WhatNeverCameIsCountedWithTheTimeItHadWaited) {
    options_.client.fetcher.shape = NetworkShape{200'000, 0};  // 25 kB/s: the directory comes, the tiles do not
    options_.clients = 1;
    options_.duration_seconds = 0.6;
    options_.ramp_seconds = 0;
    const LoadOutcome outcome = run();
    EXPECT_GT(outcome.measured.unanswered, 0u);
    EXPECT_GT(outcome.measured.tiles_unfinished, 0u);
    EXPECT_GE(outcome.measured.request.max(), 300ms);
    EXPECT_GE(outcome.measured.visible.max(), 300ms);
}

TEST_F(LoadRun, StopsEarlyWithTheFiguresSoFar) {
    options_.duration_seconds = 60;
    std::thread stopper([&] {
        std::this_thread::sleep_for(400ms);
        stop_ = true;
    });
    const auto begin = std::chrono::steady_clock::now();
    const LoadOutcome outcome = run();
    stopper.join();
    EXPECT_LT(std::chrono::steady_clock::now() - begin, 10s);
    EXPECT_TRUE(outcome.interrupted);
    EXPECT_TRUE(outcome.fetched_anything());
    EXPECT_GT(outcome.measured.updates, 0u);
}

TEST_F(LoadRun, SaysSoWhenNothingCouldBeFetched) {
    options_.client.place = city_.path_file("nowhere.3tz");
    const LoadOutcome outcome = run();
    EXPECT_FALSE(outcome.fetched_anything());
    EXPECT_EQ(outcome.clients_opened, 0u);
    EXPECT_NE(outcome.measured.first_error.find("nowhere.3tz"), std::string::npos);
}

TEST_F(LoadRun, ReportsItsFiguresAsJson) {
    const LoadOutcome outcome = run();
    const auto json = nlohmann::json::parse(load_json(outcome, options_));
    EXPECT_EQ(json.at("clients_opened"), 5);
    EXPECT_EQ(json.at("errors"), 0);
    EXPECT_EQ(json.at("bytes").at("layers"), outcome.measured.layer_bytes);
    for (const char* name : {"request_ms", "service_ms", "visible_ms", "open_ms", "lateness_ms"}) {
        const auto& figures = json.at(name);
        EXPECT_GT(figures.at("count"), 0) << name;
        EXPECT_LE(figures.at("p50"), figures.at("p99")) << name;
        EXPECT_LE(figures.at("p99_9"), figures.at("max")) << name;
    }
    EXPECT_NE(load_text(outcome, options_).find("over-fetch"), std::string::npos);
}

TEST(StartOfClient, IsSeededAndSpread) {
    LoadOptions options;
    options.ramp_seconds = 3;
    double least = 1e9, most = 0;
    for (uint32_t i = 0; i < 200; ++i) {
        const ClientStart start = start_of_client(i, options, 60);
        EXPECT_EQ(start.path_seconds, start_of_client(i, options, 60).path_seconds);
        EXPECT_GE(start.path_seconds, 0);
        EXPECT_LT(start.path_seconds, 60);
        EXPECT_LT(start.delay_seconds, 3);
        least = std::min(least, start.path_seconds);
        most = std::max(most, start.path_seconds);
    }
    EXPECT_LT(least, 5);
    EXPECT_GT(most, 55);
    LoadOptions other = options;
    other.seed = 2;
    EXPECT_NE(start_of_client(0, options, 60).path_seconds, start_of_client(0, other, 60).path_seconds);
}

}  // namespace
}  // namespace citystream::client
