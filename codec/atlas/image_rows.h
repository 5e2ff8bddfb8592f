// A picture that is read from the bottom up in strips of rows, so that it need not exist as a whole.
#pragma once

#include <algorithm>
#include <functional>

#include "codec/atlas/image.h"

namespace citystream::codec::atlas {

inline constexpr uint32_t kStripRows = 32;

struct ImageRows {
    uint32_t width = 0, height = 0, channels = 0;
    /// Fills the strip (this width, up to kStripRows rows, these channels) with the rows from y on.
    std::function<void(uint32_t y, Image& strip)> read;
};

/// Calls visit(y, strip) for all strips from the bottom up, until it returns false.
template <typename Visit>
void visit_strips(const ImageRows& rows, const Visit& visit) {
    Image strip;
    for (uint32_t y = 0; y < rows.height; y += kStripRows) {
        const uint32_t count = std::min(kStripRows, rows.height - y);
        if (strip.height != count) strip = Image(rows.width, count, rows.channels);
        rows.read(y, strip);
        if (!visit(y, std::as_const(strip))) return;
    }
}

/// The strips of an image, which must outlive the result.
inline ImageRows rows_of(const Image& image) {
    return {image.width, image.height, image.channels, [&image](uint32_t y, Image& strip) {
                for (uint32_t c = 0; c < image.channels; ++c)
                    std::copy_n(image.row(c, y).data(), strip.area(), strip.plane(c).data());
            }};
}

/// The image of all strips.
inline Image whole_image(const ImageRows& rows) {
    Image image(rows.width, rows.height, rows.channels);
    visit_strips(rows, [&image](uint32_t y, const Image& strip) {
        for (uint32_t c = 0; c < image.channels; ++c)
            std::copy_n(strip.plane(c).data(), strip.area(), image.row(c, y).data());
        return true;
    });
    return image;
}

}  // namespace citystream::codec::atlas
