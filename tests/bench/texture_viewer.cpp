#include "tests/bench/texture_viewer.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

#include "client/render/device_choice.h"
#include "client/render/frame_constants.h"
#include "client/render/frame_target.h"
#include "client/render/graphics_pipeline.h"
#include "client/render/lighting_layout.h"
#include "codec/atlas/bc1.h"
#include "tests/bench/texture_viewer.frag.h"
#include "tests/bench/texture_viewer.vert.h"
#include "tests/bench/texture_viewer_layout.h"

namespace citystream::bench {
namespace {

using namespace client;

constexpr VkFormat kTextureFormat = VK_FORMAT_BC1_RGB_UNORM_BLOCK;
constexpr uint64_t kStagingBytes = 16 << 20;

struct Texture {
    VkImage image = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
    VkDescriptorSet set = VK_NULL_HANDLE;
};

/// Blocks of all mips, finest first.
struct TextureBlocks {
    std::vector<std::vector<uint32_t>> mips;
    uint32_t width = 0, height = 0;
};

TextureBlocks blocks_of(codec::atlas::ChartImage picture) {
    TextureBlocks out{{}, picture.width, picture.height};
    for (;;) {
        out.mips.push_back(codec::atlas::encode_bc1_image(picture.rgb, picture.width, picture.height));
        if (picture.width == 1 && picture.height == 1) return out;
        picture = codec::atlas::downsample(picture);
    }
}

class Viewer final : public TextureViewer {
  public:
    Viewer() = default;
    Viewer(const Viewer&) = delete;
    Viewer& operator=(const Viewer&) = delete;
    ~Viewer() override;

    void start(const TexturedCity& city, TextureOrder order, uint32_t width, uint32_t height);
    Result<FrameImage> draw(const Camera& camera) override;
    uint32_t draws() const override { return static_cast<uint32_t>(runs_.size()); }
    uint64_t texture_bytes() const override { return texture_bytes_; }
    uint64_t geometry_bytes() const override { return vertices_.bytes + indices_.bytes; }

  private:
    void make_geometry(const TexturedCity& city, TextureOrder order);
    void make_textures(const TexturedCity& city);
    void bind_memory();
    void upload(const Texture& texture, const TextureBlocks& blocks);
    void make_sets();
    void write_set(Texture& texture);
    void make_pipeline();
    void record(VkCommandBuffer commands, const PlainConstants& constants) const;

    Instance instance_;
    Device device_;
    FrameTarget target_;
    Buffer vertices_, indices_, staging_;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
    std::vector<Texture> textures_;
    std::vector<PictureRun> runs_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
    VkDescriptorPool sets_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
    uint64_t texture_bytes_ = 0;
};

Viewer::~Viewer() {
    if (device_.handle != VK_NULL_HANDLE) {
        vkDeviceWaitIdle(device_.handle);
        for (const Texture& texture : textures_) {
            vkDestroyImageView(device_.handle, texture.view, nullptr);
            vkDestroyImage(device_.handle, texture.image, nullptr);
        }
        vkFreeMemory(device_.handle, memory_, nullptr);
        vkDestroyPipeline(device_.handle, pipeline_, nullptr);
        vkDestroyPipelineLayout(device_.handle, layout_, nullptr);
        vkDestroyDescriptorPool(device_.handle, sets_, nullptr);
        vkDestroyDescriptorSetLayout(device_.handle, set_layout_, nullptr);
        vkDestroySampler(device_.handle, sampler_, nullptr);
        for (Buffer* buffer : {&vertices_, &indices_, &staging_}) destroy_buffer(device_, *buffer);
        destroy_frame_target(device_, target_);
    }
    destroy_device(device_);
    destroy_instance(instance_);
}

void Viewer::start(const TexturedCity& city, TextureOrder order, uint32_t width, uint32_t height) {
    instance_ = create_instance(false);
    const Result<VkPhysicalDevice> physical = choose_device(instance_, "", enumerate_egl_devices());
    if (!physical) throw VulkanError(physical.error().text());
    device_ = create_device(*physical);
    if (!device_.has_bc_textures) throw VulkanError(device_.name + " has no BC1 textures");
    target_ = create_frame_target(device_, width, height, 1);
    make_geometry(city, order);
    make_textures(city);
    make_sets();
    make_pipeline();
}

void Viewer::make_geometry(const TexturedCity& city, TextureOrder order) {
    std::vector<PictureRun> ordered = city.runs;
    if (order == TextureOrder::kByPicture) std::ranges::stable_sort(ordered, {}, &PictureRun::picture);
    std::vector<uint32_t> indices;
    indices.reserve(city.indices.size());
    for (const PictureRun& run : ordered) {
        const bool goes_on = order == TextureOrder::kByPicture && !runs_.empty() && runs_.back().picture == run.picture;
        if (!goes_on) runs_.push_back({run.picture, static_cast<uint32_t>(indices.size()), 0});
        runs_.back().indices += run.indices;
        const auto first = city.indices.begin() + run.first_index;
        indices.insert(indices.end(), first, first + run.indices);
    }
    vertices_ = create_buffer(device_, city.vertices.size() * sizeof(PlainVertex), BufferPlace::kUpload);
    std::memcpy(vertices_.mapped, city.vertices.data(), vertices_.bytes);
    indices_ = create_buffer(device_, indices.size() * 4, BufferPlace::kUpload);
    std::memcpy(indices_.mapped, indices.data(), indices_.bytes);
}

void Viewer::make_textures(const TexturedCity& city) {
    std::vector<TextureBlocks> blocks;
    for (const auto& picture : city.pictures) {
        blocks.push_back(blocks_of(picture));
        auto info = vk_struct<VkImageCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO);
        info.imageType = VK_IMAGE_TYPE_2D;
        info.format = kTextureFormat;
        info.extent = {picture.width, picture.height, 1};
        info.mipLevels = static_cast<uint32_t>(blocks.back().mips.size());
        info.arrayLayers = 1;
        info.samples = VK_SAMPLE_COUNT_1_BIT;
        info.usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
        textures_.emplace_back();
        vk_check(vkCreateImage(device_.handle, &info, nullptr, &textures_.back().image), "vkCreateImage");
    }
    bind_memory();
    staging_ = create_buffer(device_, kStagingBytes, BufferPlace::kUpload);
    for (size_t i = 0; i < textures_.size(); ++i) {
        auto view = vk_struct<VkImageViewCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO);
        view.image = textures_[i].image;
        view.viewType = VK_IMAGE_VIEW_TYPE_2D;
        view.format = kTextureFormat;
        view.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, VK_REMAINING_MIP_LEVELS, 0, 1};
        vk_check(vkCreateImageView(device_.handle, &view, nullptr, &textures_[i].view), "vkCreateImageView");
        upload(textures_[i], blocks[i]);
    }
}

// One allocation for all: drivers allow few thousand.
void Viewer::bind_memory() {
    std::vector<VkDeviceSize> offsets;
    uint32_t types = ~0u;
    for (const Texture& texture : textures_) {
        VkMemoryRequirements needs{};
        vkGetImageMemoryRequirements(device_.handle, texture.image, &needs);
        texture_bytes_ = (texture_bytes_ + needs.alignment - 1) / needs.alignment * needs.alignment;
        offsets.push_back(texture_bytes_);
        texture_bytes_ += needs.size;
        types &= needs.memoryTypeBits;
    }
    const uint32_t type = find_memory_type(device_, types, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, nullptr, texture_bytes_, type};
    vk_check(vkAllocateMemory(device_.handle, &allocate, nullptr, &memory_), "allocation of texture memory");
    for (size_t i = 0; i < textures_.size(); ++i)
        vk_check(vkBindImageMemory(device_.handle, textures_[i].image, memory_, offsets[i]), "vkBindImageMemory");
}

void Viewer::upload(const Texture& texture, const TextureBlocks& blocks) {
    std::vector<VkBufferImageCopy> copies;
    uint64_t at = 0;
    for (uint32_t mip = 0; mip < blocks.mips.size(); ++mip) {
        const std::vector<uint32_t>& words = blocks.mips[mip];
        if (at + words.size() * 4 > kStagingBytes) throw VulkanError("a picture is too large for this bench");
        std::memcpy(static_cast<std::byte*>(staging_.mapped) + at, words.data(), words.size() * 4);
        VkBufferImageCopy copy{};
        copy.bufferOffset = at;
        copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, mip, 0, 1};
        copy.imageExtent = {std::max(1u, blocks.width >> mip), std::max(1u, blocks.height >> mip), 1};
        copies.push_back(copy);
        at += words.size() * 4;
    }
    submit_and_wait(device_, [&](VkCommandBuffer commands) {
        auto barrier = vk_struct<VkImageMemoryBarrier>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER);
        barrier.image = texture.image;
        barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, VK_REMAINING_MIP_LEVELS, 0, 1};
        barrier.newLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
        barrier.dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
        vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, nullptr,
                             0, nullptr, 1, &barrier);
        vkCmdCopyBufferToImage(commands, staging_.handle, texture.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                               static_cast<uint32_t>(copies.size()), copies.data());
        barrier.oldLayout = barrier.newLayout;
        barrier.newLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
        barrier.srcAccessMask = barrier.dstAccessMask;
        barrier.dstAccessMask = VK_ACCESS_SHADER_READ_BIT;
        vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT, 0, 0,
                             nullptr, 0, nullptr, 1, &barrier);
    });
}

void Viewer::make_sets() {
    auto sampler = vk_struct<VkSamplerCreateInfo>(VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO);
    sampler.magFilter = sampler.minFilter = VK_FILTER_LINEAR;
    sampler.mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR;
    sampler.maxLod = VK_LOD_CLAMP_NONE;
    vk_check(vkCreateSampler(device_.handle, &sampler, nullptr, &sampler_), "vkCreateSampler");
    const VkDescriptorSetLayoutBinding binding{0, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1,
                                               VK_SHADER_STAGE_FRAGMENT_BIT, &sampler_};
    auto layout = vk_struct<VkDescriptorSetLayoutCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
    layout.bindingCount = 1;
    layout.pBindings = &binding;
    vk_check(vkCreateDescriptorSetLayout(device_.handle, &layout, nullptr, &set_layout_),
             "vkCreateDescriptorSetLayout");
    const auto count = static_cast<uint32_t>(textures_.size());
    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, count};
    auto pool = vk_struct<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
    pool.maxSets = count;
    pool.poolSizeCount = 1;
    pool.pPoolSizes = &size;
    vk_check(vkCreateDescriptorPool(device_.handle, &pool, nullptr, &sets_), "vkCreateDescriptorPool");
    for (Texture& texture : textures_) write_set(texture);
}

void Viewer::write_set(Texture& texture) {
    auto allocate = vk_struct<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
    allocate.descriptorPool = sets_;
    allocate.descriptorSetCount = 1;
    allocate.pSetLayouts = &set_layout_;
    vk_check(vkAllocateDescriptorSets(device_.handle, &allocate, &texture.set), "vkAllocateDescriptorSets");
    const VkDescriptorImageInfo image{VK_NULL_HANDLE, texture.view, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    auto write = vk_struct<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET);
    write.dstSet = texture.set;
    write.descriptorCount = 1;
    write.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    write.pImageInfo = &image;
    vkUpdateDescriptorSets(device_.handle, 1, &write, 0, nullptr);
}

void Viewer::make_pipeline() {
    const VkPushConstantRange range{VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof(PlainConstants)};
    auto layout = vk_struct<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
    layout.setLayoutCount = 1;
    layout.pSetLayouts = &set_layout_;
    layout.pushConstantRangeCount = 1;
    layout.pPushConstantRanges = &range;
    vk_check(vkCreatePipelineLayout(device_.handle, &layout, nullptr, &layout_), "vkCreatePipelineLayout");
    const VkVertexInputBindingDescription binding{0, sizeof(PlainVertex), VK_VERTEX_INPUT_RATE_VERTEX};
    const std::array<VkVertexInputAttributeDescription, 3> attributes = {
        {{0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(PlainVertex, position)},
         {1, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(PlainVertex, normal)},
         {2, 0, VK_FORMAT_R32G32_SFLOAT, offsetof(PlainVertex, texcoord)}}};
    auto input =
        vk_struct<VkPipelineVertexInputStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO);
    input.vertexBindingDescriptionCount = 1;
    input.pVertexBindingDescriptions = &binding;
    input.vertexAttributeDescriptionCount = static_cast<uint32_t>(attributes.size());
    input.pVertexAttributeDescriptions = attributes.data();
    const std::array<VkShaderModule, 2> modules = {create_shader_module(device_, k_texture_viewer_vert),
                                                   create_shader_module(device_, k_texture_viewer_frag)};
    const std::array<VkPipelineShaderStageCreateInfo, 2> stages = {
        shader_stage(VK_SHADER_STAGE_VERTEX_BIT, modules[0]), shader_stage(VK_SHADER_STAGE_FRAGMENT_BIT, modules[1])};
    // The state of the client's own passes.
    pipeline_ = create_graphics_pipeline(device_, target_.clear_pass, layout_, stages, {}, input);
    for (VkShaderModule module : modules) vkDestroyShaderModule(device_.handle, module, nullptr);
}

void Viewer::record(VkCommandBuffer commands, const PlainConstants& constants) const {
    const float sky[4] = {static_cast<float>(SKY_R), static_cast<float>(SKY_G), static_cast<float>(SKY_B), 1};
    begin_target(commands, target_);
    begin_pass(commands, target_, target_.clear_pass, sky);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_);
    vkCmdPushConstants(commands, layout_, VK_SHADER_STAGE_VERTEX_BIT, 0, sizeof constants, &constants);
    const VkDeviceSize offset = 0;
    vkCmdBindVertexBuffers(commands, 0, 1, &vertices_.handle, &offset);
    vkCmdBindIndexBuffer(commands, indices_.handle, 0, VK_INDEX_TYPE_UINT32);
    for (const PictureRun& run : runs_) {
        vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_, 0, 1, &textures_[run.picture].set,
                                0, nullptr);
        vkCmdDrawIndexed(commands, run.indices, 1, run.first_index, 0, 0);
    }
    vkCmdEndRenderPass(commands);
    copy_colour(commands, target_, target_.readback);
    memory_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_HOST_BIT,
                   VK_ACCESS_HOST_READ_BIT);
}

Result<FrameImage> Viewer::draw(const Camera& camera) {
    const FrameConstants frame = make_frame_constants(camera, {});
    PlainConstants constants{};
    std::memcpy(constants.clip_x, frame.clip_x, sizeof frame.clip_x);
    std::memcpy(constants.clip_y, frame.clip_y, sizeof frame.clip_y);
    std::memcpy(constants.clip_w, frame.clip_w, sizeof frame.clip_w);
    constants.near_plane = frame.near_plane;
    for (size_t c = 0; c < 3; ++c) constants.corner[c] = static_cast<float>(-camera.position[c]);
    try {
        submit_and_wait(device_, [&](VkCommandBuffer commands) { record(commands, constants); });
    } catch (const VulkanError& error) {
        return Error{error.what()};
    }
    const auto* bytes = static_cast<const uint8_t*>(target_.readback.mapped);
    return FrameImage{target_.width, target_.height, {bytes, bytes + size_t{4} * target_.width * target_.height}};
}

}  // namespace

Result<std::unique_ptr<TextureViewer>> TextureViewer::create(const TexturedCity& city, TextureOrder order,
                                                             uint32_t width, uint32_t height) {
    auto viewer = std::make_unique<Viewer>();
    try {
        viewer->start(city, order, width, height);
    } catch (const VulkanError& error) {
        return Error{error.what()};
    }
    return std::unique_ptr<TextureViewer>(std::move(viewer));
}

}  // namespace citystream::bench
