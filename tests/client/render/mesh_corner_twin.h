// Corners of resident meshes on the GPU against ResidentMeshView, word for word, through the include that draws.
#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "client/render/mesh_draws.h"
#include "codec/mesh/mesh_resident.h"
#include "codec/mesh/strip_code.h"
#include "shaders/twin_mesh_corner.comp.h"
#include "tests/client/render/gpu_twin.h"

namespace citystream::client::test {

using namespace codec::mesh;

inline constexpr uint32_t kCharts = 5;

class MeshCornerTwin : public GpuTwin {
  protected:
    /// All corners of all ranges; of each at most so many triangles.
    void expect_same_corners(std::span<const uint32_t> words, const PositionView& camera, bool scattered,
                             uint32_t most = ~0U) {
        const Result<ResidentMeshView> mesh = ResidentMeshView::create(words, kCharts);
        ASSERT_TRUE(mesh.ok()) << mesh.error().text();
        const LayerId layer = upload_words(words, scattered);
        const std::vector<MeshDrawConstants> draws = mesh_draw_constants(words);
        ASSERT_EQ(draws.size(), mesh->ranges().size());
        uint32_t first = 0;
        for (uint32_t r = 0; r < draws.size(); ++r) {
            const MeshRange& range = mesh->ranges()[r];
            const std::vector<uint32_t> input = input_of(camera);
            TwinConstants constants{};
            constants.count = 3 * std::min(range.triangles, most);
            point_at(draws[r], strip_corners_of(words, range), constants);
            const auto gpu = run(k_twin_mesh_corner_comp, layer, constants, TWIN_CORNER_WORDS, input);
            for (uint32_t i = 0; i < constants.count; ++i) {
                SCOPED_TRACE("range " + std::to_string(r) + " corner " + std::to_string(i));
                ASSERT_EQ(cpu_words(*mesh, first + i / 3, i % 3, camera), words_of(gpu, i));
            }
            first += range.triangles;
        }
        forget_layers();
    }

    using CornerNumbers = std::vector<std::array<uint32_t, 3>>;
    static std::vector<uint32_t> input_of(const PositionView& camera) {
        std::vector<uint32_t> input;
        for (const int32_t c : camera.from_camera) input.push_back(static_cast<uint32_t>(c));
        input.push_back(camera.rule.distance_per_unit);
        input.push_back(camera.least_dropped);
        return input;
    }
    /// None but of strip code.
    static CornerNumbers strip_corners_of(std::span<const uint32_t> words, const MeshRange& range) {
        if (range.kind != RESIDENT_KIND_STRIP_CODE) return {};
        return *decode_strips(words.subspan(range.topology_begin, range.topology_words));
    }
    void point_at(MeshDrawConstants draw, const CornerNumbers& corners, TwinConstants& constants) {
        const Buffer decoded = host_buffer(corners.size() * sizeof corners[0]);
        if (!corners.empty()) std::memcpy(decoded.mapped, corners.data(), corners.size() * sizeof corners[0]);
        std::memcpy(draw.corners, &decoded.address, sizeof decoded.address);
        const Buffer record = host_buffer(sizeof draw);
        std::memcpy(record.mapped, &draw, sizeof draw);
        std::memcpy(constants.draw, &record.address, sizeof record.address);
    }

  private:
    using Words = std::array<uint32_t, TWIN_CORNER_WORDS>;
    static Words words_of(std::span<const uint32_t> all, size_t i) {
        Words words{};
        std::copy_n(all.begin() + static_cast<ptrdiff_t>(i * TWIN_CORNER_WORDS), TWIN_CORNER_WORDS, words.begin());
        return words;
    }
    static Words cpu_words(const ResidentMeshView& mesh, uint32_t triangle, uint32_t k, const PositionView& camera) {
        const ResidentCorner corner = mesh.corner(triangle, k, camera);
        int32_t texcoord[2];
        mesh.texcoord(triangle, k, texcoord);
        Words words{};
        for (size_t c = 0; c < 3; ++c) {
            words[c] = static_cast<uint32_t>(corner.position[c]);
            words[3 + c] = static_cast<uint32_t>(corner.normal[c]);
        }
        words[6] = corner.chart_entry;
        words[7] = corner.texcoord;
        for (size_t c = 0; c < 2; ++c) words[8 + c] = static_cast<uint32_t>(texcoord[c]);
        return words;
    }
};

}  // namespace citystream::client::test
