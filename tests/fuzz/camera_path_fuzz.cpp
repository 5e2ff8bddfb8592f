// Any text as a camera path: an error or a path whose samples are finite and whose times grow.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "client/path/camera_path.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const auto path = citystream::client::parse_camera_path({reinterpret_cast<const char*>(data), size});
    if (!path) return 0;
    if (path->samples.empty()) std::abort();
    for (size_t i = 0; i < path->samples.size(); ++i) {
        const auto& s = path->samples[i];
        if (!std::isfinite(s.x + s.y + s.z + s.yaw + s.pitch + s.fov + s.t)) std::abort();
        if (i > 0 && !(s.t > path->samples[i - 1].t)) std::abort();
    }
    if (!std::isfinite(path->at(path->samples.front().t + path->duration() / 2).x)) std::abort();
    return 0;
}
