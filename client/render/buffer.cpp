#include "client/render/buffer.h"

namespace citystream::client {
namespace {

constexpr VkMemoryPropertyFlags kMapped = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;

uint32_t choose_memory_type(const Device& device, uint32_t type_bits, BufferPlace place) {
    constexpr VkMemoryPropertyFlags kLocal = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    const VkMemoryPropertyFlags wishes[4][2] = {
        {kLocal, 0},
        {kLocal | kMapped, kLocal | kMapped},
        {kLocal | kMapped, kMapped},
        {kMapped | VK_MEMORY_PROPERTY_HOST_CACHED_BIT, kMapped},
    };
    const auto& wish = wishes[static_cast<size_t>(place)];
    const uint32_t best = find_memory_type(device, type_bits, wish[0]);
    return best != kNoMemoryType ? best : find_memory_type(device, type_bits, wish[1]);
}

void allocate_memory(const Device& device, Buffer& buffer, BufferPlace place) {
    VkMemoryRequirements needs{};
    vkGetBufferMemoryRequirements(device.handle, buffer.handle, &needs);
    const uint32_t type = choose_memory_type(device, needs.memoryTypeBits, place);
    if (type == kNoMemoryType) throw VulkanError("no memory type for a buffer on " + device.name);
    auto flags = vk_struct<VkMemoryAllocateFlagsInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO);
    flags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
    VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, &flags, needs.size, type};
    vk_check(vkAllocateMemory(device.handle, &allocate, nullptr, &buffer.memory), "allocation of buffer memory");
    vk_check(vkBindBufferMemory(device.handle, buffer.handle, buffer.memory, 0), "vkBindBufferMemory");
    if (place != BufferPlace::kDevice) {
        vk_check(vkMapMemory(device.handle, buffer.memory, 0, VK_WHOLE_SIZE, 0, &buffer.mapped), "vkMapMemory");
    }
    VkBufferDeviceAddressInfo address{VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO, nullptr, buffer.handle};
    buffer.address = vkGetBufferDeviceAddress(device.handle, &address);
}

}  // namespace

bool has_device_host_memory(const Device& device, uint64_t bytes) {
    return find_memory_type(device, ~0u, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | kMapped, bytes) != kNoMemoryType;
}

Buffer create_buffer(const Device& device, uint64_t bytes, BufferPlace place) {
    Buffer buffer;
    buffer.bytes = bytes;
    auto info = vk_struct<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
    info.size = bytes;
    info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT |
                 VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                 VK_BUFFER_USAGE_INDEX_BUFFER_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT;
    vk_check(vkCreateBuffer(device.handle, &info, nullptr, &buffer.handle), "vkCreateBuffer");
    try {
        allocate_memory(device, buffer, place);
    } catch (const VulkanError&) {
        destroy_buffer(device, buffer);
        throw;
    }
    return buffer;
}

void destroy_buffer(const Device& device, Buffer& buffer) {
    if (buffer.handle != VK_NULL_HANDLE) vkDestroyBuffer(device.handle, buffer.handle, nullptr);
    if (buffer.memory != VK_NULL_HANDLE) vkFreeMemory(device.handle, buffer.memory, nullptr);
    buffer = {};
}

}  // namespace citystream::client
