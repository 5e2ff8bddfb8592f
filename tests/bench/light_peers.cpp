#include "tests/bench/light_peers.h"

#include <algorithm>
#include <cstring>

#include "tests/bench/light_peer_bits.comp.h"
#include "tests/bench/light_peer_csr.comp.h"

namespace citystream::bench {

using namespace client;

namespace {

void set_address(uint32_t (&address)[2], const Buffer& buffer) {
    std::memcpy(address, &buffer.address, sizeof buffer.address);
}

}  // namespace

LightPeer::LightPeer(const Device& device, LightPeerKind kind) : device_(device) {
    const std::span<const uint32_t> code = kind == LightPeerKind::kCsr
                                               ? std::span<const uint32_t>(k_light_peer_csr_comp)
                                               : std::span<const uint32_t>(k_light_peer_bits_comp);
    pass_ = create_compute_pass(device, code, sizeof(LightPeerConstants));
}

LightPeer::~LightPeer() {
    for (Tile& tile : tiles_) {
        for (Buffer* buffer : {&tile.starts, &tile.content, &tile.sums}) destroy_buffer(device_, *buffer);
    }
    destroy_buffer(device_, light_);
    destroy_pass(device_, pass_);
}

Buffer LightPeer::uploaded(std::span<const uint32_t> words) const {
    const Buffer buffer = create_buffer(device_, std::max<uint64_t>(words.size_bytes(), 4), BufferPlace::kUpload);
    std::memcpy(buffer.mapped, words.data(), words.size_bytes());
    return buffer;
}

void LightPeer::add_tile(Tile tile, std::span<const uint32_t> content, uint32_t receivers) {
    tile.content = uploaded(content);
    const uint64_t words = uint64_t{LIGHT_PEER_SUM_WORDS} * receivers;
    tile.sums = create_buffer(device_, std::max<uint64_t>(4 * words, 4), BufferPlace::kReadback);
    set_address(tile.constants.content, tile.content);
    set_address(tile.constants.sums, tile.sums);
    tile.constants.receivers = receivers;
    tiles_.push_back(tile);
}

void LightPeer::add_rows(const codec::radiance::Transfer& transfer, uint32_t local_count) {
    std::vector<uint32_t> entries(transfer.column.size());
    for (size_t i = 0; i < entries.size(); ++i)
        entries[i] = transfer.column[i] | static_cast<uint32_t>(transfer.quarters[i]) << LIGHT_PEER_QUARTERS_SHIFT;
    Tile tile;
    tile.starts = uploaded(transfer.row_begin);
    set_address(tile.constants.starts, tile.starts);
    tile.constants.rows_each = local_count;
    add_tile(tile, entries, transfer.rows() / local_count);
}

void LightPeer::add_bits(const codec::radiance::VisibilityTile& visibility) {
    Tile tile;
    tile.constants.words_each = static_cast<uint32_t>(visibility.words_a_receiver());
    tile.constants.texels_across = visibility.side;
    add_tile(tile, visibility.words, visibility.receivers());
}

void LightPeer::set_light(const codec::radiance::LightVectors& light) {
    const uint64_t bytes = 4 * uint64_t{LIGHT_PEER_SUM_WORDS} * light[0].size();
    if (light_.bytes < bytes) {
        destroy_buffer(device_, light_);
        light_ = create_buffer(device_, bytes, BufferPlace::kUpload);
    }
    auto* word = static_cast<uint32_t*>(light_.mapped);
    for (size_t k = 0; k < light[0].size(); ++k) {
        for (const auto& axis : light) word = std::copy(axis[k].begin(), axis[k].end(), word);
    }
}

void LightPeer::record(VkCommandBuffer commands) const {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pass_.handle);
    for (const Tile& tile : tiles_) {
        if (tile.constants.receivers == 0) continue;
        LightPeerConstants constants = tile.constants;
        set_address(constants.light, light_);
        vkCmdPushConstants(commands, pass_.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof constants, &constants);
        const uint32_t receivers = constants.receivers, across = LIGHT_PEER_ROW_GROUPS;
        vkCmdDispatch(commands, std::min(receivers, across), (receivers + across - 1) / across, 1);
    }
    memory_barrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                   VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
}

std::span<const uint32_t> LightPeer::sums(size_t tile) const {
    const Tile& one = tiles_[tile];
    return {static_cast<const uint32_t*>(one.sums.mapped), size_t{LIGHT_PEER_SUM_WORDS} * one.constants.receivers};
}

uint64_t LightPeer::resident_bytes() const {
    uint64_t bytes = 0;
    for (const Tile& tile : tiles_) bytes += tile.starts.bytes + tile.content.bytes;
    return bytes;
}

}  // namespace citystream::bench
