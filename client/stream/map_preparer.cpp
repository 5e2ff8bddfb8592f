#include "client/stream/map_preparer.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "codec/facade/facade_wire.h"
#include "codec/facade/raw_map.h"

namespace citystream::client {

using codec::facade::FacadeForm;

namespace {

/// Jobs that are not worth a thread: less than this many bytes, and no conversion.
constexpr uint64_t kWorthThreads = 256 << 10;
/// D, M, A and boxes plain, and what encoders keep beside them.
constexpr uint64_t kConvertingBytesPerTexel = 24;

using Clock = std::chrono::steady_clock;

Result<std::vector<uint32_t>> encode(FacadeForm form, bool boxes, const codec::facade::RunGrid& grid) {
    return form == FacadeForm::kRaw ? codec::facade::encode_raw_map(grid, boxes)
                                    : codec::facade::encode_form(form, grid);
}

void convert(PreparedMap& map, const Result<codec::facade::RunGrid>& grid, const MapTarget& target) {
    const Clock::time_point begin = Clock::now();
    Result<std::vector<uint32_t>> words = Error{"no words"};
    if (grid) {
        words = encode(target.form, target.boxes, *grid);
        map.converted = words.ok();
        map.refused = !words.ok();
        if (map.refused) words = encode(FacadeForm::kRaw, target.boxes, *grid);
    } else {
        words = grid.error();
    }
    map.words.clear();
    if (words) {
        map.words = std::move(*words);
    } else {
        map.failure = words.error().text();
    }
    map.convert_ms = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

PreparedMap prepare(const MapJob& job, const std::optional<MapTarget>& target) {
    PreparedMap map;
    auto words = codec::facade::expand_wire(job.wire, job.resident_bytes);
    if (!words) {
        map.failure = words.error().text();
        return map;
    }
    map.words = std::move(*words);
    const auto grid = codec::facade::decode_form(map.words);
    map.opaque = grid.ok() && !grid->has_open_cells();
    if (target) convert(map, grid, *target);
    return map;
}

}  // namespace

std::vector<PreparedMap> prepare_maps(std::span<const MapJob> jobs, const std::optional<MapTarget>& target,
                                      uint32_t threads) {
    std::vector<PreparedMap> maps(jobs.size());
    uint64_t bytes = 0;
    for (const MapJob& job : jobs) bytes += job.resident_bytes;
    if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
    if (!target && bytes < kWorthThreads) threads = 1;
    threads = static_cast<uint32_t>(std::min<size_t>(threads, jobs.size()));

    std::atomic<size_t> next{0};
    const auto work = [&] {
        for (size_t i = next++; i < jobs.size(); i = next++) maps[i] = prepare(jobs[i], target);
    };
    std::vector<std::thread> others;
    for (uint32_t i = 1; i < threads; ++i) others.emplace_back(work);
    work();
    for (std::thread& other : others) other.join();
    return maps;
}

uint64_t preparing_bytes(uint32_t resident_bytes, uint32_t width, uint32_t height,
                         const std::optional<MapTarget>& target) {
    const uint64_t expanding = uint64_t{2} * resident_bytes;
    return target ? expanding + kConvertingBytesPerTexel * width * height : expanding;
}

}  // namespace citystream::client
