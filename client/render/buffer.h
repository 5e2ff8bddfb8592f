// A Vulkan buffer with memory of its own and a device address: what slots, frame records and readback are made of.
#pragma once

#include "client/render/device.h"

namespace citystream::client {

struct Buffer {
    VkBuffer handle = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkDeviceAddress address = 0;
    void* mapped = nullptr;  ///< null when the memory is not host-visible; coherent otherwise
    uint64_t bytes = 0;
};

enum class BufferPlace {
    kDevice,      ///< device-local, not mapped
    kDeviceHost,  ///< device-local and mapped (one memory, or a large BAR)
    kUpload,      ///< mapped, written by the CPU; device-local where such memory exists
    kReadback,    ///< mapped and cached where such memory exists
};

/// `bytes` > 0. Usable as storage by address, transfer source and destination, index and vertex buffer. Throws
/// VulkanError when memory is short.
Buffer create_buffer(const Device& device, uint64_t bytes, BufferPlace place);
void destroy_buffer(const Device& device, Buffer& buffer);

/// Whether the device has mapped device-local memory in a heap that holds `bytes`.
bool has_device_host_memory(const Device& device, uint64_t bytes);

}  // namespace citystream::client
