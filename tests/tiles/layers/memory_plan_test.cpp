#include "tiles/layers/memory_plan.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <future>
#include <memory>
#include <vector>

#include "tiles/layers/memory_pass.h"

namespace citystream::tiles::layers {
namespace {

constexpr uint64_t kMebibyte = 1 << 20;

TEST(MemoryPlan, LeavesAFifthOfWhatTheProcessHasNotTaken) {
    for (const uint64_t limit : {200 * kMebibyte, 512 * kMebibyte, 16384 * kMebibyte}) {
        const uint64_t free = limit - 100 * kMebibyte;
        const MemoryPlan plan = plan_memory(limit, 100 * kMebibyte);
        EXPECT_LE(plan.work + plan.images + plan.facades, free - free / 5);
        EXPECT_GE(plan.work + plan.images, free / 2);
        EXPECT_LE(plan.facades, 64 * kMebibyte);
    }
}

TEST(MemoryPlan, AProcessBeyondItsLimitGoesOnWithLittle) {
    const MemoryPlan plan = plan_memory(80 * kMebibyte, 100 * kMebibyte);
    EXPECT_EQ(plan.work, 10 * kMebibyte);
    EXPECT_GT(plan.images, 0U);
    EXPECT_GT(plan.facades, 0U);
}

TEST(MemoryPlan, KnowsWhatTheProcessHolds) {
    const uint64_t before = resident_memory();
    EXPECT_GT(before, 0U);
    const std::vector<char> held(64 * kMebibyte, 1);
    EXPECT_GE(resident_memory(), before + 60 * kMebibyte) << held.back();
}

TEST(MemoryPass, WhatAsksForMoreWaitsUntilItFits) {
    MemoryGate gate(100);
    MemoryPass small(gate, 40);
    auto large = std::make_unique<MemoryPass>(gate, 60);
    std::promise<void> changed;
    auto has_changed = changed.get_future();
    auto thread = std::async(std::launch::async, [&] {
        small.change(70);
        changed.set_value();
    });
    EXPECT_EQ(has_changed.wait_for(std::chrono::milliseconds(50)), std::future_status::timeout);
    large.reset();
    thread.get();
    EXPECT_EQ(gate.peak(), 100U);
}

TEST(MemoryPass, ManyThatAllAskForMoreEndAndStayWithinTheBudget) {
    MemoryGate gate(100);
    std::array<std::future<void>, 4> threads;
    for (auto& thread : threads) {
        thread = std::async(std::launch::async, [&gate] {
            for (int i = 0; i < 200; ++i) {
                MemoryPass pass(gate, 20);
                pass.change(60);
            }
        });
    }
    for (auto& thread : threads) thread.get();
    EXPECT_LE(gate.peak(), 100U);
}

}  // namespace
}  // namespace citystream::tiles::layers
