// Scans on the GPU against a loop, for every way of running them.
#include "client/render/scan.h"

#include <algorithm>
#include <cstring>

#include "client/render/device_choice.h"
#include "codec/bits/bit_stream.h"
#include "tests/client/render/device_test.h"
#include "tests/client/render/scenes.h"

namespace citystream::client::test {
namespace {

struct Elements {
    std::vector<uint32_t> values;
    std::vector<uint32_t> segments;
};

uint32_t transformed(uint32_t value, uint32_t transform) {
    if (transform == SCAN_TRANSFORM_UNZIGZAG) return value >> 1 ^ (~(value & 1) + 1);
    if (transform == SCAN_TRANSFORM_STRIP_LENGTH) return value >= 2 ? 3 : 1;
    return value;
}

std::vector<uint32_t> scanned(const Elements& elements, const ScanKind& kind) {
    std::vector<uint32_t> out;
    uint32_t running = 0;
    size_t segment = 0;
    for (size_t i = 0; i < elements.values.size(); ++i) {
        for (; segment < elements.segments.size() && elements.segments[segment] == i; ++segment) running = 0;
        const uint32_t value = transformed(elements.values[i], kind.transform);
        const uint32_t after = kind.operation == SCAN_OPERATION_SUM ? running + value : std::max(running, value);
        out.push_back(kind.inclusive ? after : running);
        running = after;
    }
    return out;
}

std::vector<uint32_t> packed(const Elements& elements, uint32_t bits) {
    codec::bits::BitWriter writer;
    for (const uint32_t value : elements.values) writer.put(value, bits);
    return writer.finish();
}

class GpuScan : public DeviceTest {
  protected:
    /// Both paths, with and without subgroups where the device has them.
    std::vector<ScanTuning> tunings() const {
        std::vector<ScanTuning> all;
        for (const ScanPath path : {ScanPath::kPasses, ScanPath::kLookBack}) {
            all.push_back({path, false});
            if (subgroups_fit_scans(device_)) all.push_back({path, true});
        }
        return all;
    }

    Elements random_elements(uint32_t count, uint32_t bits, uint32_t segments) {
        Elements elements;
        elements.values.resize(count);
        for (uint32_t& value : elements.values) value = static_cast<uint32_t>(random_.next()) & ~0u >> (32 - bits);
        for (uint32_t s = 0; s < segments; ++s) elements.segments.push_back(random_.below(count));
        std::sort(elements.segments.begin(), elements.segments.end());
        return elements;
    }

    std::vector<uint32_t> run(Scan& scan, const Elements& elements, const ScanKind& kind, uint32_t repeats = 1) {
        const auto count = static_cast<uint32_t>(elements.values.size());
        const std::vector<uint32_t> words = packed(elements, kind.element_bits);
        Buffer in = buffer_of(words);
        Buffer segments = buffer_of(elements.segments);
        Buffer out = create_buffer(device_, uint64_t{4} * count, BufferPlace::kReadback);
        Buffer state = create_buffer(device_, 4 * scan_state_words(scan.tuning, count) + 8, BufferPlace::kDevice);
        const ScanPlaces places = {
            in.address, out.address, segments.address, static_cast<uint32_t>(elements.segments.size()), &state, 8};
        std::vector<uint32_t> result;
        for (uint32_t repeat = 0; repeat < repeats; ++repeat) {
            std::memset(out.mapped, 0xee, out.bytes);
            submit_and_wait(device_, [&](VkCommandBuffer commands) {
                record_scan(commands, scan, places, count);
                memory_barrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                               VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
            });
            const auto* first = static_cast<const uint32_t*>(out.mapped);
            const bool same = repeat == 0 || std::equal(result.begin(), result.end(), first);
            EXPECT_TRUE(same) << "repeat " << repeat;
            result.assign(first, first + count);
        }
        for (Buffer* buffer : {&in, &segments, &out, &state}) destroy_buffer(device_, *buffer);
        return result;
    }

    void expect_scans(const ScanKind& kind, const ScanTuning& tuning, std::span<const Elements> sets) {
        Scan scan = create_scan(device_, kind, tuning);
        for (const Elements& elements : sets) {
            const std::vector<uint32_t> want = scanned(elements, kind);
            const std::vector<uint32_t> got = run(scan, elements, kind);
            const auto wrong = std::mismatch(want.begin(), want.end(), got.begin()).first - want.begin();
            EXPECT_EQ(static_cast<size_t>(wrong), want.size())
                << want.size() << " elements of " << kind.element_bits << " bits, operation " << kind.operation
                << ", transform " << kind.transform << ", look-back " << (tuning.path == ScanPath::kLookBack)
                << ", subgroups " << tuning.subgroups;
        }
        destroy_scan(device_, scan);
    }

    Buffer buffer_of(std::span<const uint32_t> words) {
        Buffer buffer = create_buffer(device_, std::max<uint64_t>(4, words.size_bytes()), BufferPlace::kReadback);
        if (!words.empty()) std::memcpy(buffer.mapped, words.data(), words.size_bytes());
        return buffer;
    }

    Random random_;
};

// Compiling a pipeline takes longer than running it: kinds take turns with ways.
TEST_F(GpuScan, EveryOperationAndElementSizeIsTheSameAsALoop) {
    const std::vector<ScanTuning> ways = tunings();
    size_t turn = 0;
    for (const uint32_t bits : {1u, 2u, 4u, 8u, 16u, 32u}) {
        std::vector<Elements> sets;
        for (const uint32_t count : {1u, 33u, 5000u}) sets.push_back(random_elements(count, bits, 0));
        for (const uint32_t operation : {SCAN_OPERATION_SUM, SCAN_OPERATION_MAXIMUM}) {
            const bool inclusive = (bits + operation) % 3 != 0;
            expect_scans({operation, inclusive, bits}, ways[turn++ % ways.size()], sets);
        }
    }
}

TEST_F(GpuScan, FunctionsAreAppliedAsElementsAreLoaded) {
    for (const ScanTuning& tuning : {tunings().front(), tunings().back()}) {
        expect_scans({SCAN_OPERATION_SUM, true, 32, SCAN_TRANSFORM_UNZIGZAG}, tuning,
                     std::vector{random_elements(3000, 32, 0)});
        expect_scans({SCAN_OPERATION_SUM, false, 2, SCAN_TRANSFORM_STRIP_LENGTH}, tuning,
                     std::vector{random_elements(3000, 2, 0)});
    }
}

TEST_F(GpuScan, SizesAtTheEdgesOfLanesBlocksAndWordsAreScanned) {
    for (const ScanTuning& tuning : tunings()) {
        std::vector<Elements> sets;
        for (const uint32_t edge : {8u, 256u, 1024u, 65536u, 1024u * SCAN_LANES}) {
            for (const uint32_t count : {edge - 1, edge, edge + 1}) sets.push_back(random_elements(count, 1, 0));
        }
        expect_scans({SCAN_OPERATION_SUM, false, 1}, tuning, sets);
    }
}

TEST_F(GpuScan, SegmentsOfAnyLengthAreScannedEachOnItsOwn) {
    std::vector<Elements> sets;
    for (const uint32_t segments : {1u, 7u, 500u, 50000u}) sets.push_back(random_elements(20000, 16, segments));
    uint32_t turn = 0;
    for (const ScanTuning& tuning : tunings()) {
        expect_scans({SCAN_OPERATION_SUM, turn % 2 == 0, 16}, tuning, sets);
        expect_scans({SCAN_OPERATION_MAXIMUM, turn % 2 == 1, 16}, tuning, sets);
        ++turn;
    }
}

TEST_F(GpuScan, MoreThanSixteenMillionElementsAreScanned) {
    const std::vector<Elements> sets = {random_elements((1u << 24) + 1, 1, 3)};
    for (const ScanTuning& tuning : tunings()) {
        if (tuning.subgroups != subgroups_fit_scans(device_)) continue;
        expect_scans({SCAN_OPERATION_SUM, false, 1}, tuning, sets);
    }
}

TEST_F(GpuScan, BlocksThatNeverSpeakAreWorkedOutByThoseBehindThem) {
    // All silent: every block works out all before it, which is only for few.
    const std::vector<Elements> few = {random_elements(20000, 8, 2)};
    const std::vector<Elements> many = {random_elements(200000, 8, 0), random_elements(200000, 8, 11)};
    for (const uint32_t silent : {1u, 2u, 7u}) {
        const ScanTuning tuning{ScanPath::kLookBack, silent != 2 && subgroups_fit_scans(device_), 0, silent};
        expect_scans({silent == 1 ? SCAN_OPERATION_MAXIMUM : SCAN_OPERATION_SUM, true, 8}, tuning,
                     silent == 1 ? few : many);
    }
}

TEST_F(GpuScan, RepeatedScansGiveTheSameWords) {
    const Elements elements = random_elements(40000, 4, 9);
    const ScanKind kind{SCAN_OPERATION_SUM, true, 4};
    for (const ScanPath path : {ScanPath::kPasses, ScanPath::kLookBack}) {
        Scan scan = create_scan(device_, kind, {path, subgroups_fit_scans(device_)});
        EXPECT_EQ(run(scan, elements, kind, 100), scanned(elements, kind));
        destroy_scan(device_, scan);
    }
}

}  // namespace
}  // namespace citystream::client::test
