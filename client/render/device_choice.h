// Which Vulkan device draws: the one that matches the EGL device, unless the user names another.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "client/render/device.h"
#include "client/render/egl_device.h"
#include "codec/result.h"

namespace citystream::client {

/// How a Vulkan device was matched to an EGL device.
enum class DeviceMatch { kNone, kDrmNode, kUuid };
DeviceMatch match_device(VkPhysicalDevice physical, const EglDevice& egl);

/// `wish`: an index into physical_devices(), or a part of a device's name (letter case ignored); empty: the first EGL
/// device's match by UUID, else by DRM node, else the first discrete GPU, integrated GPU, other, software. Unusable
/// devices are passed over, or are an error that says why when wished for by index or name.
Result<VkPhysicalDevice> choose_device(const Instance& instance, const std::string& wish,
                                       std::span<const EglDevice> egl_devices);

}  // namespace citystream::client
