// What the light passes (client/render/radiance_passes.h) are measured against on the GPU: the same light from
// compressed sparse rows and, by brute force, from visibility bits.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "client/render/buffer.h"
#include "client/render/pipelines.h"
#include "codec/radiance/source_light.h"
#include "codec/radiance/transfer.h"
#include "codec/radiance/visibility_bits.h"
#include "tests/bench/light_peers_layout.h"

namespace citystream::bench {

enum class LightPeerKind : uint8_t { kCsr, kBits };

/// Tiles in GPU memory and a pass that lights them. Throws client::VulkanError.
class LightPeer {
  public:
    LightPeer(const client::Device& device, LightPeerKind kind);
    ~LightPeer();
    LightPeer(const LightPeer&) = delete;
    LightPeer& operator=(const LightPeer&) = delete;

    /// Of kCsr. 4 bytes an entry and 4 a row. Columns below 2^16, quarters above 0. `local_count`: rows of a receiver;
    /// 1: its entries go to all threads of its group.
    void add_rows(const codec::radiance::Transfer& transfer, uint32_t local_count);
    /// Of kBits. A bit a sample.
    void add_bits(const codec::radiance::VisibilityTile& tile);

    void set_light(const codec::radiance::LightVectors& light);
    /// After tiles and light are there: a dispatch a tile.
    void record(VkCommandBuffer commands) const;
    /// Words of a tile's receivers, as light_peers_layout.h has them, once the commands have run.
    std::span<const uint32_t> sums(size_t tile) const;

    uint64_t resident_bytes() const;

  private:
    struct Tile {
        client::Buffer starts, content, sums;
        LightPeerConstants constants{};
    };
    void add_tile(Tile tile, std::span<const uint32_t> content, uint32_t receivers);
    client::Buffer uploaded(std::span<const uint32_t> words) const;

    const client::Device& device_;
    client::Pass pass_;
    client::Buffer light_;
    std::vector<Tile> tiles_;
};

}  // namespace citystream::bench
