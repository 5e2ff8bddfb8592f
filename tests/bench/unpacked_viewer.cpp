#include "tests/bench/unpacked_viewer.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <map>

#include "client/render/device_choice.h"
#include "client/render/frame_constants.h"
#include "client/render/frame_target.h"
#include "client/render/graphics_pipeline.h"
#include "client/render/lighting_layout.h"
#include "codec/chart_word.h"
#include "codec/grid.h"
#include "shaders/mesh.frag.h"
#include "tests/bench/unpacked_viewer.vert.h"

namespace citystream::bench {
namespace {

using namespace client;

constexpr VkShaderStageFlags kStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
constexpr uint32_t kGrey = CHART_WORD_UNTEXTURED & CHART_WORD_COLOUR_MASK;

struct TileRun {
    std::array<double, 3> origin;
    uint32_t first_index, indices;
    int32_t first_vertex;
};

class Viewer final : public UnpackedViewer {
  public:
    Viewer() = default;
    Viewer(const Viewer&) = delete;
    Viewer& operator=(const Viewer&) = delete;
    ~Viewer() override;

    void start(std::span<const UnpackedTile> tiles, uint32_t width, uint32_t height);
    Result<FrameImage> draw(const Camera& camera, FrameTimings& timings) override;
    uint64_t geometry_bytes() const override { return vertices_.bytes + indices_.bytes; }
    bool on_processor() const override { return device_.is_cpu; }

  private:
    void make_geometry(std::span<const UnpackedTile> tiles);
    void make_pipeline();
    void record(VkCommandBuffer commands, const Camera& camera) const;
    void mark(VkCommandBuffer commands, uint32_t stamp) const;

    Instance instance_;
    Device device_;
    FrameTarget target_;
    Buffer vertices_, indices_;
    std::vector<TileRun> runs_;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
    VkQueryPool timestamps_ = VK_NULL_HANDLE;
};

Viewer::~Viewer() {
    if (device_.handle != VK_NULL_HANDLE) {
        vkDeviceWaitIdle(device_.handle);
        vkDestroyQueryPool(device_.handle, timestamps_, nullptr);
        vkDestroyPipeline(device_.handle, pipeline_, nullptr);
        vkDestroyPipelineLayout(device_.handle, layout_, nullptr);
        for (Buffer* buffer : {&vertices_, &indices_}) destroy_buffer(device_, *buffer);
        destroy_frame_target(device_, target_);
    }
    destroy_device(device_);
    destroy_instance(instance_);
}

void Viewer::start(std::span<const UnpackedTile> tiles, uint32_t width, uint32_t height) {
    instance_ = create_instance(false);
    const Result<VkPhysicalDevice> physical = choose_device(instance_, "", enumerate_egl_devices());
    if (!physical) throw VulkanError(physical.error().text());
    device_ = create_device(*physical);
    target_ = create_frame_target(device_, width, height, 1);
    auto queries = vk_struct<VkQueryPoolCreateInfo>(VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO);
    queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
    queries.queryCount = 2;
    vk_check(vkCreateQueryPool(device_.handle, &queries, nullptr, &timestamps_), "vkCreateQueryPool");
    make_geometry(tiles);
    make_pipeline();
}

// In memory of the device where it can be written to.
void Viewer::make_geometry(std::span<const UnpackedTile> tiles) {
    std::vector<UnpackedVertex> vertices;
    std::vector<uint32_t> indices;
    for (const UnpackedTile& tile : tiles) {
        runs_.push_back({tile.origin, static_cast<uint32_t>(indices.size()), static_cast<uint32_t>(tile.indices.size()),
                         static_cast<int32_t>(vertices.size())});
        vertices.insert(vertices.end(), tile.vertices.begin(), tile.vertices.end());
        indices.insert(indices.end(), tile.indices.begin(), tile.indices.end());
    }
    const auto fill = [&](Buffer& buffer, const void* from, uint64_t bytes) {
        if (bytes == 0) throw VulkanError("a city without triangles");
        const bool direct = has_device_host_memory(device_, bytes);
        buffer = create_buffer(device_, bytes, direct ? BufferPlace::kDeviceHost : BufferPlace::kDevice);
        Buffer staging = direct ? Buffer() : create_buffer(device_, bytes, BufferPlace::kUpload);
        std::memcpy(direct ? buffer.mapped : staging.mapped, from, bytes);
        if (direct) return;
        submit_and_wait(device_, [&](VkCommandBuffer commands) {
            const VkBufferCopy all{0, 0, bytes};
            vkCmdCopyBuffer(commands, staging.handle, buffer.handle, 1, &all);
            memory_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                           VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_ACCESS_MEMORY_READ_BIT);
        });
        destroy_buffer(device_, staging);
    };
    fill(vertices_, vertices.data(), vertices.size() * sizeof(UnpackedVertex));
    fill(indices_, indices.data(), indices.size() * 4);
}

void Viewer::make_pipeline() {
    const VkPushConstantRange range{kStages, 0, sizeof(DrawConstants)};
    auto layout = vk_struct<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
    layout.pushConstantRangeCount = 1;
    layout.pPushConstantRanges = &range;
    vk_check(vkCreatePipelineLayout(device_.handle, &layout, nullptr, &layout_), "vkCreatePipelineLayout");
    const VkVertexInputBindingDescription binding{0, sizeof(UnpackedVertex), VK_VERTEX_INPUT_RATE_VERTEX};
    const std::array<VkVertexInputAttributeDescription, 3> attributes = {
        {{0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(UnpackedVertex, position)},
         {1, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(UnpackedVertex, normal)},
         {2, 0, VK_FORMAT_R32_UINT, offsetof(UnpackedVertex, colour)}}};
    auto input =
        vk_struct<VkPipelineVertexInputStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO);
    input.vertexBindingDescriptionCount = 1;
    input.pVertexBindingDescriptions = &binding;
    input.vertexAttributeDescriptionCount = static_cast<uint32_t>(attributes.size());
    input.pVertexAttributeDescriptions = attributes.data();
    // As the client's pass for layers in one piece.
    const VkBool32 direct = VK_TRUE;
    const VkSpecializationMapEntry entry{DIRECT_LAYERS_CONSTANT, 0, sizeof direct};
    const VkSpecializationInfo constants{1, &entry, sizeof direct, &direct};
    const std::array<VkShaderModule, 2> modules = {create_shader_module(device_, k_unpacked_viewer_vert),
                                                   create_shader_module(device_, k_mesh_frag)};
    const std::array<VkPipelineShaderStageCreateInfo, 2> stages = {
        shader_stage(VK_SHADER_STAGE_VERTEX_BIT, modules[0], &constants),
        shader_stage(VK_SHADER_STAGE_FRAGMENT_BIT, modules[1], &constants)};
    pipeline_ = create_graphics_pipeline(device_, target_.clear_pass, layout_, stages, {}, input);
    for (VkShaderModule module : modules) vkDestroyShaderModule(device_.handle, module, nullptr);
}

void Viewer::mark(VkCommandBuffer commands, uint32_t stamp) const {
    if (device_.timestamp_nanoseconds == 0) return;
    vkCmdWriteTimestamp(commands, stamp == 0 ? VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT : VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT,
                        timestamps_, stamp);
}

void Viewer::record(VkCommandBuffer commands, const Camera& camera) const {
    const float sky[4] = {static_cast<float>(SKY_R), static_cast<float>(SKY_G), static_cast<float>(SKY_B), 1};
    const CameraCell cell = camera_cell(camera.position);
    DrawConstants constants{make_frame_constants(camera, cell), {}};
    if (device_.timestamp_nanoseconds != 0) vkCmdResetQueryPool(commands, timestamps_, 0, 2);
    mark(commands, 0);
    begin_target(commands, target_);
    begin_pass(commands, target_, target_.clear_pass, sky);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_);
    const VkDeviceSize offset = 0;
    vkCmdBindVertexBuffers(commands, 0, 1, &vertices_.handle, &offset);
    vkCmdBindIndexBuffer(commands, indices_.handle, 0, VK_INDEX_TYPE_UINT32);
    for (const TileRun& run : runs_) {
        for (size_t c = 0; c < 3; ++c)
            constants.tile.origin[c] = static_cast<int>(to_grid(run.origin[c]) - cell.cell[c]);
        vkCmdPushConstants(commands, layout_, kStages, 0, sizeof constants, &constants);
        vkCmdDrawIndexed(commands, run.indices, 1, run.first_index, run.first_vertex, 0);
    }
    vkCmdEndRenderPass(commands);
    mark(commands, 1);
    copy_colour(commands, target_, target_.readback);
    memory_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_HOST_BIT,
                   VK_ACCESS_HOST_READ_BIT);
}

Result<FrameImage> Viewer::draw(const Camera& camera, FrameTimings& timings) {
    try {
        submit_and_wait(device_, [&](VkCommandBuffer commands) { record(commands, camera); });
        if (device_.timestamp_nanoseconds != 0) {
            std::array<uint64_t, 2> ticks{};
            vk_check(vkGetQueryPoolResults(device_.handle, timestamps_, 0, 2, sizeof ticks, ticks.data(),
                                           sizeof ticks[0], VK_QUERY_RESULT_64_BIT),
                     "vkGetQueryPoolResults");
            timings.gpu_mesh_ms = static_cast<double>(ticks[1] - ticks[0]) * device_.timestamp_nanoseconds * 1e-6;
        }
    } catch (const VulkanError& error) {
        return Error{error.what()};
    }
    FrameImage image{target_.width, target_.height, {}};
    const auto* bytes = static_cast<const uint8_t*>(target_.readback.mapped);
    image.rgba.assign(bytes, bytes + size_t{4} * image.width * image.height);
    return image;
}

}  // namespace

UnpackedTile unpack(const codec::mesh::MeshTile& mesh, const std::array<double, 3>& origin) {
    UnpackedTile tile{origin, {}, {}};
    std::map<UnpackedVertex, uint32_t> numbers;
    for (size_t corner = 0; corner < mesh.indices.size(); ++corner) {
        const codec::mesh::MeshVertex& from = mesh.vertices[mesh.indices[corner]];
        const uint32_t chart = mesh.triangle_chart[corner / 3];
        UnpackedVertex vertex{{}, {}, codec::names_colour(chart) ? chart & CHART_WORD_COLOUR_MASK : kGrey};
        const float length = std::hypot(from.normal[0], from.normal[1], from.normal[2]);
        for (size_t c = 0; c < 3; ++c) {
            vertex.position[c] = static_cast<float>(to_metres(from.position[c]));
            vertex.normal[c] = from.normal[c] / length;
        }
        const auto [at, fresh] = numbers.try_emplace(vertex, static_cast<uint32_t>(tile.vertices.size()));
        if (fresh) tile.vertices.push_back(vertex);
        tile.indices.push_back(at->second);
    }
    return tile;
}

Result<std::unique_ptr<UnpackedViewer>> UnpackedViewer::create(std::span<const UnpackedTile> tiles, uint32_t width,
                                                               uint32_t height) {
    auto viewer = std::make_unique<Viewer>();
    try {
        viewer->start(tiles, width, height);
    } catch (const VulkanError& error) {
        return Error{error.what()};
    }
    return std::unique_ptr<UnpackedViewer>(std::move(viewer));
}

}  // namespace citystream::bench
