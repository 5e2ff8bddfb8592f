// Frames as PNG files.
#pragma once

#include <string>

#include "client/render/frame.h"
#include "codec/result.h"

namespace citystream::client {

/// Writes 8-bit RGB (alpha is dropped: frames are opaque). The same image gives the same bytes. Fails with the path and
/// the reason.
Status write_png(const std::string& path, const FrameImage& image);

/// Reads any PNG as 8-bit RGBA (grey and palette expanded, alpha 255 where there is none, 16 bits cut to 8). At most
/// 16384 x 16384.
Result<FrameImage> read_png(const std::string& path);

}  // namespace citystream::client
