// Mesh layers in GPU memory whose words somebody changed. What the check accepts is the same on the GPU as on the CPU;
// what it refuses harms nothing either, as long as its words are read where memory is: shaders have no loop and no
// recursion whose end the words decide.
#include <random>
#include <set>

#include "tests/client/render/mesh_corner_twin.h"
#include "tests/codec/mesh/resident_contents.h"

namespace citystream::client::test {
namespace {

const PositionView kFar = {{-90000, 1 << 19, -40}, {700, RESIDENT_CELL_BITS}, 2};

/// Small layers of every topology, with prisms, images, bent normals, bins.
std::vector<std::vector<uint32_t>> small_layers() {
    std::vector<std::vector<uint32_t>> layers;
    uint32_t seed = 1;
    for (const MeshTopology topology : {MeshTopology::kIndices, MeshTopology::kLocalStrips, MeshTopology::kStripCode}) {
        for (const bool constrained : {false, true}) {
            const ContentKind kind{.topology = topology, .constrained = constrained};
            MeshContent content = random_content(terrain_mesh(6), kind, seed++);
            content.prisms.resize(12);
            layers.push_back(make_resident(content).with_steps(2));
        }
    }
    return layers;
}

class HostileMesh : public MeshCornerTwin {
  protected:
    /// A few words changed: a bit, a small number, any number, or another word of the layer. Every second time in the
    /// header, the ranges and what follows them.
    std::vector<uint32_t> mutated(std::vector<uint32_t> words) {
        const auto changes = static_cast<uint32_t>(1 + random_() % 3);
        for (uint32_t i = 0; i < changes; ++i) {
            const size_t most = random_() % 2 == 0 ? std::min<size_t>(words.size(), 160) : words.size();
            uint32_t& word = words[random_() % most];
            switch (random_() % 4) {
                case 0:
                    word ^= 1u << random_() % 32;
                    break;
                case 1:
                    word += static_cast<uint32_t>(random_() % 7) - 3;
                    break;
                case 2:
                    word = static_cast<uint32_t>(random_());
                    break;
                default:
                    word = words[random_() % words.size()];
            }
        }
        return words;
    }

    std::mt19937 random_{1};
};

TEST_F(HostileMesh, WhatTheCheckAcceptsIsTheSameOnTheGpuAsOnTheCpu) {
    uint32_t accepted = 0;
    for (const std::vector<uint32_t>& layer : small_layers()) {
        for (uint32_t i = 0; i < 250; ++i) {
            const std::vector<uint32_t> words = mutated(layer);
            if (words == layer || !ResidentMeshView::create(words, kCharts)) continue;
            ++accepted;
            expect_same_corners(words, kFar, i % 2 == 0, 40);
            if (HasFatalFailure()) return;
        }
    }
    EXPECT_GE(accepted, 250u);
}

/// Every word that 32 bits can name lies in memory: those behind the layer's are those of one slot.
class EndlessLayer {
  public:
    static constexpr uint64_t kPages = uint64_t{1} << (32 - SLOT_WORDS_LOG2), kSlotWords = 1u << SLOT_WORDS_LOG2;
    static constexpr uint64_t kMostSlots = 64;

    explicit EndlessLayer(const Device& device)
        : device_(device),
          pages_(create_buffer(device, sizeof(VkDeviceAddress) * kPages, BufferPlace::kUpload)),
          slots_(create_buffer(device, 4 * kSlotWords * kMostSlots, BufferPlace::kUpload)) {
        auto* const page = static_cast<VkDeviceAddress*>(pages_.mapped);
        for (uint64_t i = 0; i < kPages; ++i) page[i] = slots_.address + 4 * kSlotWords * std::min(i, kMostSlots - 1);
    }
    EndlessLayer(const EndlessLayer&) = delete;
    EndlessLayer& operator=(const EndlessLayer&) = delete;
    ~EndlessLayer() {
        destroy_buffer(device_, pages_);
        destroy_buffer(device_, slots_);
    }

    /// The layer's reference.
    VkDeviceAddress hold(std::span<const uint32_t> words) {
        EXPECT_LE(words.size(), kSlotWords * (kMostSlots - 1));
        std::memcpy(slots_.mapped, words.data(), words.size_bytes());
        return pages_.address;
    }

  private:
    const Device& device_;
    Buffer pages_, slots_;
};

TEST_F(HostileMesh, WhatTheCheckRefusesEndsAsSoonAsAnythingElse) {
    EndlessLayer endless(device_);
    constexpr uint32_t kTriangles = 21;
    std::vector<std::array<uint32_t, 3>> corners(kTriangles);
    uint32_t refused = 0;
    std::set<uint32_t> kinds;
    for (const std::vector<uint32_t>& layer : small_layers()) {
        for (uint32_t i = 0; i < 250; ++i) {
            const std::vector<uint32_t> words = mutated(layer);
            if (ResidentMeshView::create(words, kCharts).ok()) continue;
            ++refused;
            const VkDeviceAddress reference = endless.hold(words);
            const std::vector<MeshDrawConstants> draws = mesh_draw_constants(words);
            for (size_t r = 0; r < std::min<size_t>(draws.size(), 6); ++r) {
                kinds.insert(draws[r].form & 255);
                for (auto& triangle : corners)
                    for (uint32_t& vertex : triangle) vertex = static_cast<uint32_t>(random_());
                TwinConstants constants{};
                constants.count = 3 * kTriangles;
                point_at(draws[r], corners, constants);
                const auto drawn =
                    run_at(k_twin_mesh_corner_comp, reference, constants, TWIN_CORNER_WORDS, input_of(kFar));
                ASSERT_EQ(drawn.size(), constants.count * TWIN_CORNER_WORDS);
            }
            forget_layers();
        }
    }
    EXPECT_GE(refused, 250u);
    EXPECT_GE(kinds.size(), 4u) << "all kinds of ranges";
}

}  // namespace
}  // namespace citystream::client::test
