#include "client/render/egl_device.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLES3/gl3.h>

#include <string_view>

namespace citystream::client {
namespace {

constexpr GLenum kNumDeviceUuids = 0x9596;  // GL_NUM_DEVICE_UUIDS_EXT
constexpr GLenum kDeviceUuid = 0x9597;      // GL_DEVICE_UUID_EXT

bool has_word(const char* list, std::string_view word) {
    if (list == nullptr) return false;
    std::string_view rest(list);
    while (!rest.empty()) {
        const size_t end = std::min(rest.find(' '), rest.size());
        if (rest.substr(0, end) == word) return true;
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return false;
}

template <typename Function>
Function egl_function(const char* name) {
    return reinterpret_cast<Function>(eglGetProcAddress(name));
}

std::string text_of(const char* text) {
    return text == nullptr ? std::string() : std::string(text);
}

// What only a current GL context can tell.
void read_context(EglDevice& device) {
    const auto get_string = egl_function<const GLubyte* (*)(GLenum)>("glGetString");
    const auto get_integer = egl_function<void (*)(GLenum, GLint*)>("glGetIntegerv");
    const auto get_bytes = egl_function<void (*)(GLenum, GLuint, GLubyte*)>("glGetUnsignedBytei_vEXT");
    if (get_string == nullptr || get_integer == nullptr) return;
    device.name = text_of(reinterpret_cast<const char*>(get_string(GL_RENDERER)));
    const auto* extensions = reinterpret_cast<const char*>(get_string(GL_EXTENSIONS));
    if (get_bytes == nullptr || !has_word(extensions, "GL_EXT_memory_object")) return;
    GLint count = 0;
    get_integer(kNumDeviceUuids, &count);
    if (count < 1) return;
    get_bytes(kDeviceUuid, 0, device.uuid.data());
    device.has_uuid = true;
}

// Displays are not terminated: EGL gives every caller in the process the same display of a device, and another renderer
// may be using it.
void probe_display(EGLDisplay display, EglDevice& device) {
    if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) == EGL_FALSE) return;
    device.name = text_of(eglQueryString(display, EGL_VENDOR));
    const char* extensions = eglQueryString(display, EGL_EXTENSIONS);
    if (!has_word(extensions, "EGL_KHR_surfaceless_context") || !has_word(extensions, "EGL_KHR_no_config_context"))
        return;
    if (eglBindAPI(EGL_OPENGL_ES_API) == EGL_FALSE) return;
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_NONE};
    EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    if (context == EGL_NO_CONTEXT) return;
    if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE) {
        read_context(device);
        eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    }
    eglDestroyContext(display, context);
}

EglDevice probe_device(EGLDeviceEXT handle) {
    EglDevice device;
    const auto query_string = egl_function<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
    const auto get_display = egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
    if (query_string != nullptr) {
        const char* extensions = query_string(handle, EGL_EXTENSIONS);
        device.software = has_word(extensions, "EGL_MESA_device_software");
        if (has_word(extensions, "EGL_EXT_device_drm_render_node")) {
            device.drm_node = text_of(query_string(handle, EGL_DRM_RENDER_NODE_FILE_EXT));
        }
        if (device.drm_node.empty() && has_word(extensions, "EGL_EXT_device_drm")) {
            device.drm_node = text_of(query_string(handle, EGL_DRM_DEVICE_FILE_EXT));
        }
    }
    if (get_display != nullptr) probe_display(get_display(EGL_PLATFORM_DEVICE_EXT, handle, nullptr), device);
    return device;
}

std::vector<EglDevice> probe_all() {
    std::vector<EglDevice> devices;
    const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    const auto query_devices = egl_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
    if (has_word(extensions, "EGL_EXT_device_enumeration") && query_devices != nullptr) {
        EGLDeviceEXT handles[16];
        EGLint count = 0;
        if (query_devices(16, handles, &count) == EGL_TRUE) {
            for (EGLint i = 0; i < count; ++i) devices.push_back(probe_device(handles[i]));
        }
    }
    const auto get_display = egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
    if (devices.empty() && has_word(extensions, "EGL_MESA_platform_surfaceless") && get_display != nullptr) {
        EglDevice device;
        probe_display(get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr), device);
        if (!device.name.empty()) devices.push_back(device);
    }
    return devices;
}

}  // namespace

std::vector<EglDevice> enumerate_egl_devices() {
    const EGLenum api = eglQueryAPI();
    EGLDisplay display = eglGetCurrentDisplay();
    EGLContext context = eglGetCurrentContext();
    EGLSurface draw = eglGetCurrentSurface(EGL_DRAW);
    EGLSurface read = eglGetCurrentSurface(EGL_READ);
    std::vector<EglDevice> devices = probe_all();
    eglBindAPI(api);
    if (context != EGL_NO_CONTEXT) eglMakeCurrent(display, draw, read, context);
    return devices;
}

}  // namespace citystream::client
