// The EGL devices of the machine, enumerated without a display: they say which GPU an OpenGL consumer of our frames
// would use, so the Vulkan device is chosen to be the same one.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace citystream::client {

struct EglDevice {
    std::string name;      ///< GL renderer where a context could be made, else the EGL vendor
    std::string drm_node;  ///< e.g. /dev/dri/renderD128; empty for software
    bool software = false;
    bool has_uuid = false;           ///< GL_EXT_memory_object was there
    std::array<uint8_t, 16> uuid{};  ///< GL_DEVICE_UUID_EXT
};

/// Never fails: without EGL, or without EGL_EXT_device_enumeration, the list is empty (or holds the surfaceless
/// platform alone). The calling thread's current context is kept.
std::vector<EglDevice> enumerate_egl_devices();

}  // namespace citystream::client
