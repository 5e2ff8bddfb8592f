// The two flights of citystream-fly: of a streamed city, and of an uncompressed one by the reference renderer.
#pragma once

#include <atomic>

#include "client/fly/fly_options.h"
#include "client/path/camera_path.h"
#include "codec/result.h"

namespace citystream::client {

/// The city through the streamer and the Vulkan renderer. What can be lived with is said on stderr. `stop`: set by a
/// signal handler. Error: one line, of what could not be read, drawn or written, or of a frame over its budgets.
Status fly_city(const FlyOptions& options, const CameraPath& path, const std::atomic<bool>& stop);

/// The uncompressed city through the reference renderer.
Status fly_reference(const FlyOptions& options, const CameraPath& path, const std::atomic<bool>& stop);

}  // namespace citystream::client
