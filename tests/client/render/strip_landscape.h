// A landscape of many meshes, each a strip stream, and pictures of it.
#pragma once

#include <cmath>
#include <numeric>

#include "tests/client/render/strip_batch.h"
#include "tests/client/render/strip_view.h"

namespace citystream::client::test {

constexpr uint32_t kPieces = 10, kQuads = 24, kSize = 320;

struct Landscape {
    std::vector<Words> streams;
    std::vector<uint32_t> vertices;  ///< two words each, in the streams' order
    std::vector<uint32_t> first_vertex;
};

/// Hills of kPieces x kPieces pieces, each a mesh of its own.
inline Landscape landscape() {
    Landscape all;
    const Topology grid = codec::mesh::quad_grid(kQuads, kQuads, false);
    const codec::mesh::StripCode code = *codec::mesh::encode_strips(grid.triangles, grid.vertices);
    for (uint32_t piece = 0; piece < kPieces * kPieces; ++piece) {
        all.streams.push_back(code.words);
        all.first_vertex.push_back(static_cast<uint32_t>(all.vertices.size() / 2));
        for (const uint32_t vertex : code.vertices) {
            const uint32_t x = piece % kPieces * kQuads + vertex % (kQuads + 1);
            const uint32_t y = piece / kPieces * kQuads + vertex / (kQuads + 1);
            const double height = 30 + 15 * std::sin(x * 0.11) + 15 * std::cos(y * 0.07);
            all.vertices.push_back(x | y << 16);
            all.vertices.push_back(static_cast<uint32_t>(height));
        }
    }
    return all;
}

/// From obliquely above: hills hide what is behind them.
inline StripViewConstants view_of(const Buffer& vertices) {
    constexpr float kAcross = 2.0f / (kPieces * kQuads);
    StripViewConstants constants{
        {{kAcross, 0, 0, -1}, {0, -0.6f * kAcross, -2 * kAcross, 0.9f}, {0, -0.4f * kAcross, 0, 0.9f}, {0, 0, 0, 1}},
        {}};
    std::memcpy(constants.vertices, &vertices.address, 8);
    return constants;
}

class StripLandscape : public StripDecoding {
  protected:
    void SetUp() override {
        StripDecoding::SetUp();
        view_ = create_strip_view(device_, kSize, kSize);
        scene_ = landscape();
        vertices_ = host_buffer(4 * scene_.vertices.size());
        std::memcpy(vertices_.mapped, scene_.vertices.data(), 4 * scene_.vertices.size());
        batch_ = upload_batch(scene_.streams);
    }

    void TearDown() override {
        destroy_strip_view(device_, view_);
        StripDecoding::TearDown();
    }

    StripDraw draw_of(size_t stream, uint64_t first_corner) const {
        return {first_corner, 3 * batch_.streams[stream].header.triangles, scene_.first_vertex[stream]};
    }

    std::vector<uint32_t> pixels() const {
        const auto* first = static_cast<const uint32_t*>(view_.target.readback.mapped);
        return {first, first + kSize * kSize};
    }

    /// Of some streams, from the CPU's corners, all in memory at once.
    std::vector<uint32_t> picture_of(std::span<const size_t> streams) {
        std::vector<uint32_t> words;
        std::vector<StripDraw> draws;
        for (const size_t i : streams) {
            draws.push_back(draw_of(i, words.size()));
            const CornerList decoded = *codec::mesh::decode_strips(scene_.streams[i]);
            for (const auto& triangle : decoded) words.insert(words.end(), triangle.begin(), triangle.end());
        }
        const Buffer corners = host_buffer(4 * words.size());
        if (!words.empty()) std::memcpy(corners.mapped, words.data(), 4 * words.size());
        submit_and_wait(device_, [&](VkCommandBuffer commands) {
            record_strip_view(commands, view_, view_of(vertices_), {&corners, 0}, draws, true);
            finish_strip_view(commands, view_);
        });
        return pixels();
    }

    std::vector<uint32_t> picture_of_the_whole() {
        std::vector<size_t> all(scene_.streams.size());
        std::iota(all.begin(), all.end(), size_t{0});
        return picture_of(all);
    }

    StripView view_;
    Landscape scene_;
    Buffer vertices_;
    Batch batch_;
};

}  // namespace citystream::client::test
