#include "client/path/frame_size.h"

#include <charconv>
#include <string>

namespace citystream::client {
namespace {

/// 0: no number, or one out of range.
uint32_t side_in(std::string_view text, uint32_t greatest) {
    uint32_t side = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), side);
    return error == std::errc() && end == text.data() + text.size() && side <= greatest ? side : 0;
}

}  // namespace

Result<FrameSize> parse_frame_size(std::string_view text, uint32_t greatest_side) {
    const size_t cross = text.find('x');
    FrameSize size;
    if (cross != text.npos)
        size = {side_in(text.substr(0, cross), greatest_side), side_in(text.substr(cross + 1), greatest_side)};
    if (size.width > 0 && size.height > 0) return size;
    return Error{"'" + std::string(text) + "' is no picture size like 1280x720 (1 to " + std::to_string(greatest_side) +
                 " each)"};
}

}  // namespace citystream::client
