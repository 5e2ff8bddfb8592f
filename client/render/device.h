// The Vulkan instance, device and queue that everything in this room works on. Plain structs, explicit create and
// destroy.
//
// Errors: Vulkan failures are thrown as VulkanError inside this room and become Result errors at VulkanRenderer's
// calls.
#pragma once

#include <volk.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace citystream::client {

struct VulkanError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A Vulkan structure of its type, all else zero.
template <typename T>
T vk_struct(VkStructureType type, void* next = nullptr) {
    T value{};
    value.sType = type;
    value.pNext = next;
    return value;
}

/// Throws VulkanError("what: VK_ERROR_...") when `result` is an error.
void vk_check(VkResult result, const char* what);

struct Instance {
    VkInstance handle = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
    bool validated = false;                           ///< the layer was asked for and is installed
    std::unique_ptr<std::atomic<uint64_t>> messages;  ///< warnings and errors of the validation layer
};

/// Loads Vulkan and makes an instance. `validation` turns on the Khronos layer with synchronization validation where it
/// is installed.
Instance create_instance(bool validation);
void destroy_instance(Instance& instance);
bool validation_layer_installed();

struct Device {
    VkPhysicalDevice physical = VK_NULL_HANDLE;
    VkDevice handle = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;
    uint32_t queue_family = 0;
    VkCommandPool command_pool = VK_NULL_HANDLE;
    VkFence fence = VK_NULL_HANDLE;
    VkPhysicalDeviceMemoryProperties memory{};
    bool is_cpu = false;                  ///< a software driver
    bool has_fragment_atomics64 = false;  ///< on buffers
    bool has_bc_textures = false;         ///< images of BC1 blocks
    uint32_t shuffle_lanes = 0;  ///< of a subgroup of compute shaders that can shuffle; 0: not, or not always full
    double timestamp_nanoseconds = 0;  ///< of one tick; 0: the queue has no timestamps
    std::string name;                  ///< with driver name and version
};

/// Why a physical device cannot be used by this renderer; empty when it can (Vulkan 1.2, buffer device address,
/// graphics queue, D32F).
std::string unusable_reason(VkPhysicalDevice physical);
/// Device name with driver name and version, for people.
std::string describe_device(VkPhysicalDevice physical);
std::vector<VkPhysicalDevice> physical_devices(const Instance& instance);

Device create_device(VkPhysicalDevice physical);
void destroy_device(Device& device);

/// Records with `record`, submits, waits until the queue has finished.
void submit_and_wait(const Device& device, const std::function<void(VkCommandBuffer)>& record);

constexpr uint32_t kNoMemoryType = ~0u;
/// First memory type of `type_bits` with all of `wanted` in a heap of at least `heap_bytes`; kNoMemoryType when there
/// is none.
uint32_t find_memory_type(const Device& device, uint32_t type_bits, VkMemoryPropertyFlags wanted,
                          uint64_t heap_bytes = 0);

/// Global memory barrier between two stages, named where it is used.
void memory_barrier(VkCommandBuffer commands, VkPipelineStageFlags from, VkAccessFlags from_access,
                    VkPipelineStageFlags to, VkAccessFlags to_access);

}  // namespace citystream::client
