#include "client/render/device_choice.h"

#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <algorithm>
#include <cctype>
#include <cstring>

#include "client/render/vulkan_renderer.h"

namespace citystream::client {
namespace {

bool has_extension(VkPhysicalDevice physical, const char* name) {
    uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, extensions.data());
    return std::any_of(extensions.begin(), extensions.end(),
                       [&](const VkExtensionProperties& e) { return std::strcmp(e.extensionName, name) == 0; });
}

bool same_uuid(VkPhysicalDevice physical, const EglDevice& egl) {
    if (!egl.has_uuid) return false;
    auto id = vk_struct<VkPhysicalDeviceIDProperties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ID_PROPERTIES);
    VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &id, {}};
    vkGetPhysicalDeviceProperties2(physical, &properties);
    return std::equal(egl.uuid.begin(), egl.uuid.end(), id.deviceUUID);
}

bool same_drm_node(VkPhysicalDevice physical, const EglDevice& egl) {
    struct stat node {};
    if (egl.drm_node.empty() || stat(egl.drm_node.c_str(), &node) != 0) return false;
    if (!has_extension(physical, VK_EXT_PHYSICAL_DEVICE_DRM_EXTENSION_NAME)) return false;
    auto drm = vk_struct<VkPhysicalDeviceDrmPropertiesEXT>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRM_PROPERTIES_EXT);
    VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &drm, {}};
    vkGetPhysicalDeviceProperties2(physical, &properties);
    const int64_t node_major = major(node.st_rdev);
    const int64_t node_minor = minor(node.st_rdev);
    return (drm.hasRender != VK_FALSE && drm.renderMajor == node_major && drm.renderMinor == node_minor) ||
           (drm.hasPrimary != VK_FALSE && drm.primaryMajor == node_major && drm.primaryMinor == node_minor);
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

int type_rank(VkPhysicalDevice physical) {
    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(physical, &properties);
    switch (properties.deviceType) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
            return 0;
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
            return 1;
        case VK_PHYSICAL_DEVICE_TYPE_CPU:
            return 3;
        default:
            return 2;
    }
}

Result<VkPhysicalDevice> usable_or_error(VkPhysicalDevice physical) {
    const std::string reason = unusable_reason(physical);
    if (!reason.empty()) return Error{"Vulkan device '" + describe_device(physical) + "' cannot be used: " + reason};
    return physical;
}

Result<VkPhysicalDevice> choose_by_wish(const std::vector<VkPhysicalDevice>& devices, const std::string& wish) {
    if (wish.size() < 4 &&
        std::all_of(wish.begin(), wish.end(), [](unsigned char c) { return std::isdigit(c) != 0; })) {
        const size_t index = std::stoul(wish);
        if (index < devices.size()) return usable_or_error(devices[index]);
    } else {
        for (VkPhysicalDevice physical : devices) {
            if (lower(describe_device(physical)).find(lower(wish)) != std::string::npos)
                return usable_or_error(physical);
        }
    }
    std::string names;
    for (size_t i = 0; i < devices.size(); ++i) {
        names += (i == 0 ? "" : "; ") + std::to_string(i) + ": " + describe_device(devices[i]);
    }
    return Error{"no Vulkan device '" + wish + "'; there are: " + names};
}

VkPhysicalDevice choose_by_egl(const std::vector<VkPhysicalDevice>& devices, std::span<const EglDevice> egl_devices) {
    for (const DeviceMatch wanted : {DeviceMatch::kUuid, DeviceMatch::kDrmNode}) {
        for (const EglDevice& egl : egl_devices) {
            for (VkPhysicalDevice physical : devices) {
                if (match_device(physical, egl) == wanted && unusable_reason(physical).empty()) return physical;
            }
        }
    }
    return VK_NULL_HANDLE;
}

std::string match_text(VkPhysicalDevice physical, std::span<const EglDevice> egl_devices) {
    std::string text;
    for (size_t i = 0; i < egl_devices.size(); ++i) {
        const DeviceMatch match = match_device(physical, egl_devices[i]);
        if (match == DeviceMatch::kNone) continue;
        text +=
            " = EGL device " + std::to_string(i) + (match == DeviceMatch::kUuid ? " (same UUID)" : " (same DRM node)");
    }
    return text;
}

std::vector<std::string> list_with(const Instance& instance, std::span<const EglDevice> egl_devices) {
    std::vector<std::string> lines;
    const Result<VkPhysicalDevice> chosen = choose_device(instance, "", egl_devices);
    const std::vector<VkPhysicalDevice> devices = physical_devices(instance);
    for (size_t i = 0; i < devices.size(); ++i) {
        const std::string reason = unusable_reason(devices[i]);
        std::string line = "Vulkan " + std::to_string(i) + ": " + describe_device(devices[i]);
        line += match_text(devices[i], egl_devices);
        if (!reason.empty()) line += ", cannot be used: " + reason;
        if (chosen.ok() && *chosen == devices[i]) line += ", default";
        lines.push_back(std::move(line));
    }
    return lines;
}

}  // namespace

DeviceMatch match_device(VkPhysicalDevice physical, const EglDevice& egl) {
    if (same_uuid(physical, egl)) return DeviceMatch::kUuid;
    return same_drm_node(physical, egl) ? DeviceMatch::kDrmNode : DeviceMatch::kNone;
}

Result<VkPhysicalDevice> choose_device(const Instance& instance, const std::string& wish,
                                       std::span<const EglDevice> egl_devices) {
    std::vector<VkPhysicalDevice> devices = physical_devices(instance);
    if (devices.empty()) return Error{"no Vulkan device: install a driver, e.g. mesa-vulkan-drivers"};
    if (!wish.empty()) return choose_by_wish(devices, wish);
    if (VkPhysicalDevice matched = choose_by_egl(devices, egl_devices); matched != VK_NULL_HANDLE) return matched;
    std::stable_sort(devices.begin(), devices.end(),
                     [](VkPhysicalDevice a, VkPhysicalDevice b) { return type_rank(a) < type_rank(b); });
    for (VkPhysicalDevice physical : devices) {
        if (unusable_reason(physical).empty()) return physical;
    }
    return usable_or_error(devices.front());
}

std::vector<std::string> list_devices() {
    const std::vector<EglDevice> egl_devices = enumerate_egl_devices();
    std::vector<std::string> lines;
    for (size_t i = 0; i < egl_devices.size(); ++i) {
        const EglDevice& egl = egl_devices[i];
        lines.push_back("EGL " + std::to_string(i) + ": " + (egl.name.empty() ? "unnamed" : egl.name) +
                        (egl.software ? ", software" : "") + (egl.drm_node.empty() ? "" : ", " + egl.drm_node));
    }
    Instance instance;
    try {
        instance = create_instance(false);
        for (std::string& line : list_with(instance, egl_devices)) lines.push_back(std::move(line));
    } catch (const VulkanError& error) {
        lines.push_back(std::string("Vulkan: ") + error.what());
    }
    destroy_instance(instance);
    return lines;
}

}  // namespace citystream::client
