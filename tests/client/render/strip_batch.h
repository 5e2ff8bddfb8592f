// Strip streams in GPU memory and what the decoder makes of them, for the tests of the strip decoder.
#pragma once

#include <cstring>
#include <vector>

#include "client/render/strip_decoder.h"
#include "codec/bits/bit_stream.h"
#include "codec/bits/range_coder.h"
#include "codec/bits/simple9.h"
#include "tests/client/render/gpu_twin.h"
#include "tests/codec/mesh/topology_meshes.h"

namespace citystream::client::test {

using codec::mesh::CornerList;
using codec::mesh::Topology;
using Words = std::vector<uint32_t>;

inline Words strip_words(const Topology& mesh) {
    return codec::mesh::encode_strips(mesh.triangles, mesh.vertices)->words;
}
inline Words strip_words(const Topology& mesh, uint32_t mode, uint32_t prediction) {
    codec::mesh::StripCodeOptions options;
    options.mode = mode;
    options.prediction = prediction;
    return codec::mesh::encode_strips(mesh.triangles, mesh.vertices, options)->words;
}

/// A stream of `triangles` random steps and references, made without a mesh: any number of triangles in no time.
inline Words random_stream(Random& random, uint32_t triangles, uint32_t mode, uint32_t prediction) {
    codec::bits::BitWriter steps, increments;
    std::vector<uint32_t> codes;
    uint32_t met = 0, references = 0, last = 0;
    for (uint32_t i = 0; i < triangles; ++i) {
        const uint32_t bits = mode == STRIP_MODE_RESTARTS ? 2 : 1;
        uint32_t step = i == 0 ? (bits == 2 ? STRIP_STEP_RESTART : STRIP_STEP_PREVIOUS) : random.below(2);
        if (i > 0 && bits == 2 && random.below(20) == 0) step = STRIP_STEP_RESTART;
        steps.put(step, bits);
        for (uint32_t taken = i == 0 || step == STRIP_STEP_RESTART ? 3 : 1; taken > 0; --taken, ++references) {
            const bool is_new = met < 2 || random.below(2) == 0;
            increments.put(is_new ? 1 : 0, 1);
            if (is_new) {
                ++met;
                continue;
            }
            const uint32_t reach = std::min(met, 1u << random.below(18));
            const uint32_t vertex = met - 1 - random.below(reach);
            const auto difference = static_cast<int32_t>(vertex - last - prediction);
            codes.push_back(codec::bits::zigzag(difference));
            last = vertex;
        }
    }
    const Words packed = *codec::bits::pack_simple9(codes);
    Words words = {STRIP_MAGIC,
                   triangles,
                   references,
                   static_cast<uint32_t>(codes.size()),
                   static_cast<uint32_t>(packed.size()),
                   mode | prediction << STRIP_PREDICTION_BIT,
                   met,
                   0};
    for (const Words& part : {packed, increments.finish(), steps.finish()})
        words.insert(words.end(), part.begin(), part.end());
    return words;
}

class StripDecoding : public GpuTwin {
  protected:
    /// Where the words of every other stream lie apart, and each begins at some word of its layer.
    struct Batch {
        std::vector<StripStream> streams;
        StripPlan plan;
    };

    VkDeviceAddress reference_of(LayerId layer) {
        const std::vector<uint32_t>& slots = pool_.layers[layer].slots;
        if (is_contiguous(pool_, pool_.layers[layer])) return slot_address(pool_, slots[0]) | LAYER_REF_DIRECT;
        const Buffer pages = host_buffer(8 * slots.size());
        for (size_t i = 0; i < slots.size(); ++i) {
            const VkDeviceAddress address = slot_address(pool_, slots[i]);
            std::memcpy(static_cast<std::byte*>(pages.mapped) + 8 * i, &address, 8);
        }
        return pages.address;
    }

    /// `shown`: the words whose headers the decoder is told, where the uploaded ones lie.
    Batch upload_batch(std::span<const Words> uploaded, std::span<const Words> shown) {
        Batch batch;
        for (size_t i = 0; i < uploaded.size(); ++i) {
            Words words(i % 5, 0xabcdef01u);
            words.insert(words.end(), uploaded[i].begin(), uploaded[i].end());
            const LayerId layer = upload_words(words, i % 2 == 1);
            const auto header = codec::mesh::read_strip_header(shown[i]);
            EXPECT_TRUE(header.ok());
            batch.streams.push_back({reference_of(layer), static_cast<uint32_t>(i % 5), *header});
        }
        Result<StripPlan> plan = plan_strips(batch.streams);
        EXPECT_TRUE(plan.ok());
        batch.plan = std::move(*plan);
        return batch;
    }

    Batch upload_batch(std::span<const Words> streams) { return upload_batch(streams, streams); }

    static constexpr uint32_t kGuard = 0x5ca1ab1e;
    static constexpr uint64_t kGuardWords = 64;

    /// All corners of the batch. Memory on both sides of output and temporary memory must stay as it was.
    std::vector<uint32_t> decode(const StripDecoder& decoder, const Batch& batch) {
        const Buffer records = host_buffer(batch.plan.records.size() * sizeof(StripRecord));
        std::copy(batch.plan.records.begin(), batch.plan.records.end(), static_cast<StripRecord*>(records.mapped));
        const uint64_t temporary_words = strip_temporary_words(decoder, batch.plan.sizes);
        const Buffer temporary = guarded_buffer(temporary_words),
                     corners = guarded_buffer(batch.plan.sizes.corner_words);
        const StripPlaces places = {{&records, 0}, {&temporary, 4 * kGuardWords}, {&corners, 4 * kGuardWords}};
        submit_and_wait(device_, [&](VkCommandBuffer commands) {
            record_strip_decode(commands, decoder, batch.plan, places);
            memory_barrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                           VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
        });
        expect_guards(temporary, temporary_words);
        expect_guards(corners, batch.plan.sizes.corner_words);
        const auto* words = static_cast<const uint32_t*>(corners.mapped) + kGuardWords;
        return {words, words + batch.plan.sizes.corner_words};
    }

    /// The decoder's corners of every stream against decode_strips's.
    void expect_decoded(const StripDecoder& decoder, std::span<const Words> streams) {
        const Batch batch = upload_batch(streams);
        const std::vector<uint32_t> corners = decode(decoder, batch);
        for (size_t i = 0; i < streams.size(); ++i) {
            const Result<CornerList> want = codec::mesh::decode_strips(streams[i]);
            ASSERT_TRUE(want.ok());
            ASSERT_TRUE(same_corners(*want, std::span(corners).subspan(batch.plan.corners_at[i])))
                << "stream " << i << " of " << streams.size() << ", " << want->size() << " triangles, mode "
                << batch.streams[i].header.mode << ", look-back " << (decoder.tuning.path == ScanPath::kLookBack)
                << ", subgroups " << decoder.tuning.subgroups;
        }
    }

    static bool same_corners(const CornerList& want, std::span<const uint32_t> got) {
        return want.empty() || std::memcmp(want.data(), got.data(), want.size() * sizeof want[0]) == 0;
    }

    /// Both paths, with subgroups where the device has them.
    std::vector<ScanTuning> tunings() const {
        std::vector<ScanTuning> all;
        for (const ScanPath path : {ScanPath::kPasses, ScanPath::kLookBack}) {
            all.push_back({path, false});
            if (subgroups_fit_scans(device_)) all.push_back({path, true});
        }
        return all;
    }

    Random random_;

  private:
    Buffer guarded_buffer(uint64_t words) {
        const Buffer buffer = host_buffer(4 * (words + 2 * kGuardWords));
        std::fill_n(static_cast<uint32_t*>(buffer.mapped), words + 2 * kGuardWords, kGuard);
        return buffer;
    }

    static void expect_guards(const Buffer& buffer, uint64_t words) {
        const auto* all = static_cast<const uint32_t*>(buffer.mapped);
        const uint32_t* behind = all + kGuardWords + words;
        EXPECT_EQ(std::count(all, all + kGuardWords, kGuard), static_cast<ptrdiff_t>(kGuardWords));
        EXPECT_EQ(std::count(behind, behind + kGuardWords, kGuard), static_cast<ptrdiff_t>(kGuardWords));
    }
};

}  // namespace citystream::client::test
