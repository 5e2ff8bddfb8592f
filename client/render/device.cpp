#include "client/render/device.h"

#include <cstdio>
#include <cstring>

namespace citystream::client {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL count_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                             VkDebugUtilsMessageTypeFlagsEXT types,
                                             const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    // Messages that are only of the loader (a foreign driver it could not open, say) are not about our calls.
    if (types == VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT) return VK_FALSE;
    if (severity >= VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT) {
        static_cast<std::atomic<uint64_t>*>(user)->fetch_add(1);
        std::fprintf(stderr, "vulkan: %s\n", data->pMessage);
    }
    return VK_FALSE;
}

VkDebugUtilsMessengerCreateInfoEXT messenger_info(std::atomic<uint64_t>* messages) {
    auto info = vk_struct<VkDebugUtilsMessengerCreateInfoEXT>(VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
    info.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
    info.pfnUserCallback = count_message;
    info.pUserData = messages;
    return info;
}

// Taken per instance: volk's global pointers belong to the instance loaded last, which may lack the extension.
template <typename Function>
Function instance_function(VkInstance instance, const char* name) {
    return reinterpret_cast<Function>(vkGetInstanceProcAddr(instance, name));
}

bool has_graphics_queue(VkPhysicalDevice physical, uint32_t* family) {
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
    constexpr VkQueueFlags kWanted = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    for (uint32_t i = 0; i < count; ++i) {
        if ((families[i].queueFlags & kWanted) == kWanted) {
            *family = i;
            return true;
        }
    }
    return false;
}

double timestamp_period(VkPhysicalDevice physical, uint32_t family) {
    uint32_t count = family + 1;
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(physical, &properties);
    return families[family].timestampValidBits == 0 ? 0.0 : static_cast<double>(properties.limits.timestampPeriod);
}

}  // namespace

void vk_check(VkResult result, const char* what) {
    if (result >= VK_SUCCESS) return;
    const char* meaning = "";
    switch (result) {
        case VK_ERROR_OUT_OF_HOST_MEMORY:
            meaning = " (out of host memory)";
            break;
        case VK_ERROR_OUT_OF_DEVICE_MEMORY:
            meaning = " (out of device memory)";
            break;
        case VK_ERROR_DEVICE_LOST:
            meaning = " (device lost)";
            break;
        case VK_ERROR_INITIALIZATION_FAILED:
            meaning = " (initialization failed)";
            break;
        case VK_ERROR_INCOMPATIBLE_DRIVER:
            meaning = " (no driver found)";
            break;
        default:
            break;
    }
    throw VulkanError(std::string(what) + " failed: VkResult " + std::to_string(result) + meaning);
}

bool validation_layer_installed() {
    if (volkInitialize() != VK_SUCCESS) return false;
    uint32_t count = 0;
    vkEnumerateInstanceLayerProperties(&count, nullptr);
    std::vector<VkLayerProperties> layers(count);
    vkEnumerateInstanceLayerProperties(&count, layers.data());
    for (const VkLayerProperties& layer : layers) {
        if (std::strcmp(layer.layerName, kValidationLayer) == 0) return true;
    }
    return false;
}

Instance create_instance(bool validation) {
    if (volkInitialize() != VK_SUCCESS) {
        throw VulkanError(
            "no Vulkan loader (libvulkan.so.1): install libvulkan1 and a driver, e.g. mesa-vulkan-drivers");
    }
    Instance instance;
    instance.messages = std::make_unique<std::atomic<uint64_t>>(0);
    instance.validated = validation && validation_layer_installed();
    if (validation && !instance.validated) {
        std::fprintf(stderr, "vulkan: %s is not installed, drawing without it\n", kValidationLayer);
    }

    auto application = vk_struct<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
    application.pApplicationName = "citystream";
    application.apiVersion = VK_API_VERSION_1_2;
    const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    const VkValidationFeatureEnableEXT enabled = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    VkDebugUtilsMessengerCreateInfoEXT messenger = messenger_info(instance.messages.get());
    VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT, &messenger, 1, &enabled, 0, nullptr};
    auto info = vk_struct<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
    info.pApplicationInfo = &application;
    if (instance.validated) {
        info.pNext = &features;
        info.enabledLayerCount = 1;
        info.ppEnabledLayerNames = &kValidationLayer;
        info.enabledExtensionCount = 1;
        info.ppEnabledExtensionNames = &extension;
    }
    vk_check(vkCreateInstance(&info, nullptr, &instance.handle), "vkCreateInstance");
    volkLoadInstance(instance.handle);
    if (instance.validated) {
        const auto create =
            instance_function<PFN_vkCreateDebugUtilsMessengerEXT>(instance.handle, "vkCreateDebugUtilsMessengerEXT");
        if (create != nullptr) vk_check(create(instance.handle, &messenger, nullptr, &instance.messenger), "messenger");
    }
    return instance;
}

void destroy_instance(Instance& instance) {
    if (instance.handle == VK_NULL_HANDLE) return;
    if (instance.messenger != VK_NULL_HANDLE) {
        instance_function<PFN_vkDestroyDebugUtilsMessengerEXT>(instance.handle, "vkDestroyDebugUtilsMessengerEXT")(
            instance.handle, instance.messenger, nullptr);
    }
    vkDestroyInstance(instance.handle, nullptr);
    instance = {};
}

std::vector<VkPhysicalDevice> physical_devices(const Instance& instance) {
    uint32_t count = 0;
    vk_check(vkEnumeratePhysicalDevices(instance.handle, &count, nullptr), "vkEnumeratePhysicalDevices");
    std::vector<VkPhysicalDevice> devices(count);
    vk_check(vkEnumeratePhysicalDevices(instance.handle, &count, devices.data()), "vkEnumeratePhysicalDevices");
    devices.resize(count);
    return devices;
}

std::string unusable_reason(VkPhysicalDevice physical) {
    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(physical, &properties);
    if (properties.apiVersion < VK_API_VERSION_1_2) return "older than Vulkan 1.2";
    auto features12 =
        vk_struct<VkPhysicalDeviceVulkan12Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
    VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &features12, {}};
    vkGetPhysicalDeviceFeatures2(physical, &features);
    if (features12.bufferDeviceAddress == VK_FALSE) return "no bufferDeviceAddress";
    uint32_t family = 0;
    if (!has_graphics_queue(physical, &family)) return "no queue for graphics and compute";
    VkFormatProperties depth{};
    vkGetPhysicalDeviceFormatProperties(physical, VK_FORMAT_D32_SFLOAT, &depth);
    if ((depth.optimalTilingFeatures & VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT) == 0) return "no D32F depth";
    return {};
}

std::string describe_device(VkPhysicalDevice physical) {
    VkPhysicalDeviceProperties plain{};
    vkGetPhysicalDeviceProperties(physical, &plain);
    if (plain.apiVersion < VK_API_VERSION_1_2) return plain.deviceName;
    auto driver = vk_struct<VkPhysicalDeviceDriverProperties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES);
    VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &driver, {}};
    vkGetPhysicalDeviceProperties2(physical, &properties);
    return std::string(plain.deviceName) + ", " + driver.driverName + " " + driver.driverInfo;
}

namespace {

bool has_fragment_atomics64(VkPhysicalDevice physical) {
    auto features12 =
        vk_struct<VkPhysicalDeviceVulkan12Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
    VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &features12, {}};
    vkGetPhysicalDeviceFeatures2(physical, &features);
    return features12.shaderBufferInt64Atomics == VK_TRUE && features.features.shaderInt64 == VK_TRUE &&
           features.features.fragmentStoresAndAtomics == VK_TRUE;
}

bool has_extension(VkPhysicalDevice physical, const char* name) {
    uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, extensions.data());
    for (const VkExtensionProperties& extension : extensions) {
        if (std::strcmp(extension.extensionName, name) == 0) return true;
    }
    return false;
}

// Only where pipelines can ask for full subgroups: their lanes are then the workgroup's in order.
uint32_t shuffle_lanes(VkPhysicalDevice physical) {
    if (!has_extension(physical, VK_EXT_SUBGROUP_SIZE_CONTROL_EXTENSION_NAME)) return 0;
    auto control = vk_struct<VkPhysicalDeviceSubgroupSizeControlFeatures>(
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_SIZE_CONTROL_FEATURES);
    VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &control, {}};
    vkGetPhysicalDeviceFeatures2(physical, &features);
    if (control.computeFullSubgroups == VK_FALSE) return 0;
    auto subgroup =
        vk_struct<VkPhysicalDeviceSubgroupProperties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES);
    VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &subgroup, {}};
    vkGetPhysicalDeviceProperties2(physical, &properties);
    constexpr VkSubgroupFeatureFlags kWanted = VK_SUBGROUP_FEATURE_BASIC_BIT | VK_SUBGROUP_FEATURE_SHUFFLE_RELATIVE_BIT;
    const bool can = (subgroup.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT) != 0 &&
                     (subgroup.supportedOperations & kWanted) == kWanted;
    return can ? subgroup.subgroupSize : 0;
}

bool is_cpu(VkPhysicalDevice physical) {
    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(physical, &properties);
    return properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
}

}  // namespace

Device create_device(VkPhysicalDevice physical) {
    const std::string reason = unusable_reason(physical);
    if (!reason.empty()) throw VulkanError(describe_device(physical) + " cannot be used: " + reason);
    Device device;
    device.physical = physical;
    device.name = describe_device(physical);
    has_graphics_queue(physical, &device.queue_family);
    device.timestamp_nanoseconds = timestamp_period(physical, device.queue_family);
    vkGetPhysicalDeviceMemoryProperties(physical, &device.memory);

    const float priority = 1.0f;
    auto queue = vk_struct<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
    queue.queueFamilyIndex = device.queue_family;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    auto features12 =
        vk_struct<VkPhysicalDeviceVulkan12Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
    features12.bufferDeviceAddress = VK_TRUE;
    VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &features12, {}};
    // Our own passes read blocks as words; textures are for what benches compare them with.
    VkPhysicalDeviceFeatures offered{};
    vkGetPhysicalDeviceFeatures(physical, &offered);
    features.features.textureCompressionBC = offered.textureCompressionBC;
    device.has_bc_textures = offered.textureCompressionBC == VK_TRUE;
    device.is_cpu = is_cpu(physical);
    device.has_fragment_atomics64 = has_fragment_atomics64(physical);
    if (device.has_fragment_atomics64) {
        features12.shaderBufferInt64Atomics = VK_TRUE;
        features.features.shaderInt64 = features.features.fragmentStoresAndAtomics = VK_TRUE;
    }
    auto control = vk_struct<VkPhysicalDeviceSubgroupSizeControlFeatures>(
        VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_SIZE_CONTROL_FEATURES);
    control.computeFullSubgroups = VK_TRUE;
    const char* extension = VK_EXT_SUBGROUP_SIZE_CONTROL_EXTENSION_NAME;
    device.shuffle_lanes = shuffle_lanes(physical);
    auto info = vk_struct<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &features);
    if (device.shuffle_lanes != 0) {
        features12.pNext = &control;
        info.enabledExtensionCount = 1;
        info.ppEnabledExtensionNames = &extension;
    }
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    vk_check(vkCreateDevice(physical, &info, nullptr, &device.handle), "vkCreateDevice");
    vkGetDeviceQueue(device.handle, device.queue_family, 0, &device.queue);

    auto pool = vk_struct<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
    pool.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
    pool.queueFamilyIndex = device.queue_family;
    auto fence = vk_struct<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
    try {
        vk_check(vkCreateCommandPool(device.handle, &pool, nullptr, &device.command_pool), "vkCreateCommandPool");
        vk_check(vkCreateFence(device.handle, &fence, nullptr, &device.fence), "vkCreateFence");
    } catch (const VulkanError&) {
        destroy_device(device);
        throw;
    }
    return device;
}

void destroy_device(Device& device) {
    if (device.handle == VK_NULL_HANDLE) return;
    vkDeviceWaitIdle(device.handle);
    vkDestroyFence(device.handle, device.fence, nullptr);
    vkDestroyCommandPool(device.handle, device.command_pool, nullptr);
    vkDestroyDevice(device.handle, nullptr);
    device = {};
}

void submit_and_wait(const Device& device, const std::function<void(VkCommandBuffer)>& record) {
    auto allocate = vk_struct<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
    allocate.commandPool = device.command_pool;
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    vk_check(vkAllocateCommandBuffers(device.handle, &allocate, &commands), "vkAllocateCommandBuffers");
    auto begin = vk_struct<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    vk_check(vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
    record(commands);
    vk_check(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
    auto submit = vk_struct<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &commands;
    vk_check(vkQueueSubmit(device.queue, 1, &submit, device.fence), "vkQueueSubmit");
    vk_check(vkWaitForFences(device.handle, 1, &device.fence, VK_TRUE, UINT64_MAX), "vkWaitForFences");
    vk_check(vkResetFences(device.handle, 1, &device.fence), "vkResetFences");
    vkFreeCommandBuffers(device.handle, device.command_pool, 1, &commands);
}

uint32_t find_memory_type(const Device& device, uint32_t type_bits, VkMemoryPropertyFlags wanted, uint64_t heap_bytes) {
    for (uint32_t i = 0; i < device.memory.memoryTypeCount; ++i) {
        const VkMemoryType& type = device.memory.memoryTypes[i];
        if ((type_bits >> i & 1) == 0 || (type.propertyFlags & wanted) != wanted) continue;
        if (device.memory.memoryHeaps[type.heapIndex].size >= heap_bytes) return i;
    }
    return kNoMemoryType;
}

void memory_barrier(VkCommandBuffer commands, VkPipelineStageFlags from, VkAccessFlags from_access,
                    VkPipelineStageFlags to, VkAccessFlags to_access) {
    VkMemoryBarrier barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER, nullptr, from_access, to_access};
    vkCmdPipelineBarrier(commands, from, to, 0, 1, &barrier, 0, nullptr, 0, nullptr);
}

}  // namespace citystream::client
