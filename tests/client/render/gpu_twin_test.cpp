// The GPU's decoders against the CPU's, word for word, through the same includes that draw.
#include <bit>
#include <cstring>

#include "client/render/device_choice.h"
#include "client/render/frame_constants.h"
#include "client/render/pipelines.h"
#include "client/render/twin_layout.h"
#include "codec/mesh/octahedral.h"
#include "shaders/twin_atlas.comp.h"
#include "shaders/twin_facade.comp.h"
#include "shaders/twin_mesh.comp.h"
#include "tests/client/render/scenes.h"

namespace citystream::client::test {
namespace {

class GpuTwin : public testing::Test {
  protected:
    void SetUp() override {
        instance_ = create_instance(validation_layer_installed());
        const Result<VkPhysicalDevice> physical = choose_device(instance_, "", {});
        ASSERT_TRUE(physical.ok());
        device_ = create_device(*physical);
        pool_ = create_slot_pool(device_, 64 << 20);
    }

    void TearDown() override {
        destroy_slot_pool(pool_);
        for (Buffer& buffer : buffers_) destroy_buffer(device_, buffer);
        destroy_device(device_);
        EXPECT_EQ(instance_.messages->load(), 0u);
        destroy_instance(instance_);
    }

    // Uploads words so that they lie in slots out of order, or in one piece: both ways of reading are tested.
    LayerId upload_words(std::span<const uint32_t> words, bool scattered) {
        const LayerId layer = create_layer(pool_);
        constexpr size_t kSlotWords = kSlotBytes / 4;
        for (size_t at = 0; at < words.size(); at += kSlotWords) {
            const size_t count = std::min(kSlotWords, words.size() - at);
            EXPECT_TRUE(append_words(pool_, layer, words.subspan(at, count)).ok());
            if (!scattered) continue;
            EXPECT_TRUE(append_words(pool_, create_layer(pool_), words.first(1)).ok());
        }
        return layer;
    }

    Buffer& host_buffer(uint64_t bytes) {
        return buffers_.emplace_back(create_buffer(device_, std::max<uint64_t>(bytes, 4), BufferPlace::kReadback));
    }

    // Runs a twin pass over `layer`; returns count * words_each words.
    std::vector<uint32_t> run(std::span<const uint32_t> code, LayerId layer, TwinConstants constants,
                              uint32_t words_each, std::span<const uint32_t> input = {}) {
        const Buffer in = host_buffer(input.size_bytes());
        if (!input.empty()) std::memcpy(in.mapped, input.data(), input.size_bytes());
        const Buffer out = host_buffer(uint64_t{4} * constants.count * words_each);
        const Buffer pages = host_buffer(8 * pool_.layers[layer].slots.size());
        VkDeviceAddress reference = pages.address;
        for (size_t i = 0; i < pool_.layers[layer].slots.size(); ++i) {
            const VkDeviceAddress address = slot_address(pool_, pool_.layers[layer].slots[i]);
            std::memcpy(static_cast<std::byte*>(pages.mapped) + 8 * i, &address, 8);
        }
        if (is_contiguous(pool_, pool_.layers[layer])) {
            reference = slot_address(pool_, pool_.layers[layer].slots[0]) | LAYER_REF_DIRECT;
        }
        std::memcpy(constants.layer, &reference, 8);
        std::memcpy(constants.input_words, &in.address, 8);
        std::memcpy(constants.output_words, &out.address, 8);
        Pass pass = create_compute_pass(device_, code, sizeof constants);
        submit_and_wait(device_, [&](VkCommandBuffer commands) {
            vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pass.handle);
            vkCmdPushConstants(commands, pass.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof constants, &constants);
            vkCmdDispatch(commands, (constants.count + TWIN_GROUP - 1) / TWIN_GROUP, 1, 1);
            memory_barrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                           VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
        });
        destroy_pass(device_, pass);
        const auto* words = static_cast<const uint32_t*>(out.mapped);
        return {words, words + size_t{constants.count} * words_each};
    }

    Instance instance_;
    Device device_;
    SlotPool pool_;
    std::vector<Buffer> buffers_;
};

codec::mesh::MeshTile random_mesh(Random& random, uint32_t triangles, uint32_t charts) {
    codec::mesh::MeshTile tile;
    for (uint32_t i = 0; i < triangles; ++i) {
        codec::mesh::MeshVertex vertex{};
        for (int32_t& p : vertex.position) p = random.between(-200000, 200000);
        double length = 0;
        double n[3];
        for (double& c : n) {
            c = random.unit() * 2 - 1;
            length += c * c;
        }
        for (int c = 0; c < 3; ++c) vertex.normal[c] = static_cast<float>(n[c] / std::sqrt(length));
        for (int32_t& t : vertex.texcoord) t = random.between(-300000, 900000);
        tile.vertices.push_back(vertex);
    }
    for (uint32_t i = 0; i < triangles; ++i) {
        for (int c = 0; c < 3; ++c) tile.indices.push_back(random.below(triangles));
        tile.triangle_chart.push_back(random.below(charts));
    }
    tile.dressed_begin = triangles;
    return tile;
}

void expect_same_corners(const codec::mesh::MeshLayerView& view, const std::vector<uint32_t>& gpu) {
    for (uint32_t corner = 0; corner < 3 * view.triangle_count(); ++corner) {
        const uint32_t* words = &gpu[size_t{corner} * TWIN_MESH_WORDS];
        const uint32_t vertex = view.index(corner);
        int32_t position[3], normal[3], texcoord[2];
        view.position(vertex, position);
        codec::mesh::unfold_octahedral16(view.packed_normal(vertex), normal);
        view.texcoord(vertex, corner / 3, texcoord);
        ASSERT_EQ(words[0], vertex) << "corner " << corner;
        for (size_t c = 0; c < 3; ++c)
            ASSERT_EQ(static_cast<int32_t>(words[1 + c]), position[c]) << "corner " << corner;
        ASSERT_EQ(words[4], view.packed_normal(vertex));
        for (size_t c = 0; c < 3; ++c) ASSERT_EQ(static_cast<int32_t>(words[5 + c]), normal[c]) << "corner " << corner;
        for (size_t c = 0; c < 2; ++c)
            ASSERT_EQ(static_cast<int32_t>(words[8 + c]), texcoord[c]) << "corner " << corner;
        ASSERT_EQ(words[10], view.atlas_chart(corner / 3));
    }
}

TEST_F(GpuTwin, MeshCornersAreTheSameWordsForEveryPrefix) {
    Random random;
    for (const uint32_t triangles : {1u, 77u, 5000u}) {
        const LayerSteps steps = codec::mesh::encode_mesh(random_mesh(random, triangles, 9), 0);
        for (size_t count = 1; count <= steps.size(); ++count) {
            const std::vector<uint32_t> words = joined(steps, count);
            const std::vector<uint32_t> sizes = step_words(steps, count);
            const auto view = codec::mesh::MeshLayerView::create(words, sizes, 9);
            ASSERT_TRUE(view.ok()) << view.error().text();
            TwinConstants constants{};
            constants.count = 3 * triangles;
            constants.first = static_cast<uint32_t>(count);
            for (size_t s = 1; s < count; ++s) {
                constants.mesh_step_begin[s] = constants.mesh_step_begin[s - 1] + sizes[s - 1];
            }
            const LayerId layer = upload_words(words, triangles != 77);
            expect_same_corners(*view, run(k_twin_mesh_comp, layer, constants, TWIN_MESH_WORDS));
        }
    }
}

TEST_F(GpuTwin, EveryPackedNormalUnfoldsToTheSameIntegers) {
    codec::mesh::MeshTile tile;
    for (uint32_t code = 0; code < 65536; ++code) {
        codec::mesh::MeshVertex vertex{};
        vertex.position[0] = static_cast<int32_t>(code);
        codec::mesh::unpack_octahedral16(code, vertex.normal);
        tile.vertices.push_back(vertex);
        tile.indices.push_back(code);
    }
    while (tile.indices.size() % 3 != 0) tile.indices.push_back(0);
    tile.triangle_chart.assign(tile.indices.size() / 3, 0);
    tile.dressed_begin = static_cast<uint32_t>(tile.triangle_chart.size());
    const LayerSteps steps = codec::mesh::encode_mesh(tile, 0);
    const std::vector<uint32_t> words = joined(steps);
    const auto view = codec::mesh::MeshLayerView::create(words, step_words(steps), 1);
    ASSERT_TRUE(view.ok());
    TwinConstants constants{};
    constants.count = static_cast<uint32_t>(tile.indices.size());
    constants.first = static_cast<uint32_t>(steps.size());
    for (size_t s = 1; s < steps.size(); ++s) {
        constants.mesh_step_begin[s] =
            constants.mesh_step_begin[s - 1] + static_cast<uint32_t>(steps[s - 1].words.size());
    }
    expect_same_corners(*view, run(k_twin_mesh_comp, upload_words(words, true), constants, TWIN_MESH_WORDS));
}

TEST_F(GpuTwin, AtlasTexelsAreTheSameBytes) {
    Random random;
    std::vector<codec::atlas::ChartImage> charts = {test_chart(1, 1), test_chart(130, 67), test_chart(5, 64),
                                                    test_chart(64, 64)};
    for (uint8_t& byte : charts[1].rgb) byte = static_cast<uint8_t>(random.next());
    const LayerSteps steps = codec::atlas::encode_atlas(charts);
    const std::vector<uint32_t> words = joined(steps);
    const auto view = codec::atlas::AtlasLayerView::create(words, step_words(steps));
    ASSERT_TRUE(view.ok()) << view.error().text();
    const LayerId layer = upload_words(words, true);
    for (uint32_t chart = 0; chart < charts.size(); ++chart) {
        for (uint32_t mip = 0; mip < view->mip_count(chart); ++mip) {
            const uint32_t width = std::max(1u, view->width(chart) >> mip);
            const uint32_t height = std::max(1u, view->height(chart) >> mip);
            TwinConstants constants{};
            constants.count = width * height;
            constants.first = chart;
            constants.second = mip;
            const std::vector<uint32_t> gpu = run(k_twin_atlas_comp, layer, constants, 1);
            for (uint32_t i = 0; i < width * height; ++i) {
                uint8_t rgb[3];
                view->texel(chart, mip, i % width, i / width, rgb);
                ASSERT_EQ(gpu[i], static_cast<uint32_t>(rgb[0] | rgb[1] << 8 | rgb[2] << 16))
                    << "chart " << chart << " mip " << mip;
            }
        }
    }
}

codec::facade::FacadeImage random_facade(Random& random, uint32_t width, uint32_t height, uint32_t boxes) {
    codec::facade::FacadeImage image{width, height, std::vector<int16_t>(size_t{width} * height, 0),
                                     std::vector<uint8_t>(size_t{width} * height, 0)};
    for (uint32_t box = 0; box < boxes; ++box) {
        const uint32_t x0 = random.below(width), y0 = random.below(height);
        const uint32_t x1 = std::min(width, x0 + 1 + random.below(width / 3)),
                       y1 = std::min(height, y0 + 1 + random.below(height / 3));
        const auto depth = static_cast<int16_t>(random.between(-300, 400));
        const auto material = static_cast<uint8_t>(random.below(16));
        for (uint32_t y = y0; y < y1; ++y) {
            for (uint32_t x = x0; x < x1; ++x) {
                image.displacement_mm[size_t{y} * width + x] = depth;
                image.material[size_t{y} * width + x] = material;
            }
        }
    }
    return image;
}

// Least distance, in texels or tenths of a millimetre, that the ray keeps from every decision of the walk: breaks and
// the four lines of a cell's box near the hit. Rays that come closer may be told apart differently in float.
bool same_hit_nearby(const codec::facade::FacadeMapView& map, const double origin[3], const double direction[3],
                     const codec::facade::FacadeRayHit& want, bool hit, uint32_t label) {
    for (const double du : {-1e-3, 1e-3}) {
        for (const double dv : {-1e-3, 1e-3}) {
            for (const double dw : {-1e-2, 1e-2}) {
                const double moved[3] = {origin[0] + du, origin[1] + dv, origin[2] + dw};
                const codec::facade::FacadeRayHit other = codec::facade::cast_facade_ray(map, moved, direction);
                if (other.hit == hit && (!hit || other.label == label))
                    return other.hit != want.hit || other.label != want.label;
            }
        }
    }
    return false;
}

TEST_F(GpuTwin, FacadeRaysHitTheSameLabels) {
    Random random;
    uint64_t rays = 0, near_breaks = 0, wrong = 0, hits = 0;
    for (uint32_t scene = 0; scene < 6; ++scene) {
        const codec::facade::FacadeImage image =
            random_facade(random, 200 + 150 * scene, 300 + 100 * scene, scene * 12);
        const auto words = codec::facade::encode_facade_map(image);
        ASSERT_TRUE(words.ok());
        const auto map = codec::facade::FacadeMapView::create(*words);
        ASSERT_TRUE(map.ok());
        constexpr uint32_t kRays = 25000;
        std::vector<uint32_t> input;
        for (uint32_t i = 0; i < kRays; ++i) {
            const double width = image.width, height = image.height;
            const float origin[3] = {static_cast<float>((random.unit() * 1.6 - 0.3) * width),
                                     static_cast<float>((random.unit() * 1.6 - 0.3) * height),
                                     static_cast<float>(random.unit() * 3000 - 500)};
            const float target[3] = {static_cast<float>(random.unit() * width),
                                     static_cast<float>(random.unit() * height),
                                     static_cast<float>(random.unit() * 400 - 200)};
            for (const float c : origin) input.push_back(std::bit_cast<uint32_t>(c));
            for (size_t c = 0; c < 3; ++c)
                input.push_back(std::bit_cast<uint32_t>(i % 50 == c ? 0.0f : target[c] - origin[c]));
        }
        TwinConstants constants{};
        constants.count = kRays;
        const std::vector<uint32_t> gpu =
            run(k_twin_facade_comp, upload_words(*words, scene % 2 == 0), constants, TWIN_HIT_WORDS, input);
        for (uint32_t i = 0; i < kRays; ++i) {
            double ray[6];
            for (size_t c = 0; c < 6; ++c) ray[c] = static_cast<double>(std::bit_cast<float>(input[size_t{i} * 6 + c]));
            const codec::facade::FacadeRayHit want = codec::facade::cast_facade_ray(*map, ray, ray + 3);
            const uint32_t* got = &gpu[size_t{i} * TWIN_HIT_WORDS];
            const bool hit = got[0] != 0;
            ++rays;
            hits += want.hit ? 1 : 0;
            if (hit == want.hit && (!hit || got[2] == want.label)) {
                if (!hit) continue;
                const double t = static_cast<double>(std::bit_cast<float>(got[1]));
                const double length = std::abs(ray[3]) + std::abs(ray[4]) + std::abs(ray[5]) / 10;
                if (std::abs(t - want.t) * length < 0.01) continue;
            }
            if (same_hit_nearby(*map, ray, ray + 3, want, hit, got[2]))
                ++near_breaks;
            else
                ++wrong;
        }
    }
    EXPECT_GE(rays, 100000u);
    EXPECT_GT(hits, rays / 4);
    EXPECT_EQ(wrong, 0u);
    EXPECT_LE(near_breaks, rays / 1000);
    RecordProperty("rays", std::to_string(rays));
    RecordProperty("near_breaks", std::to_string(near_breaks));
    std::printf("rays %zu, hits %zu, differ near a break %zu\n", size_t{rays}, size_t{hits}, size_t{near_breaks});
}

}  // namespace
}  // namespace citystream::client::test
