#include "codec/atlas/image.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "codec/atlas/wide_loops.h"

namespace citystream::codec::atlas {

namespace {

// Cells of the table below. Decoded bytes are at least 1 / (255 * 12.92) apart, more than one cell, so a cell meets
// at most one threshold between bytes.
constexpr uint32_t kCells = 4096;

double decode(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

struct Tables {
    std::array<float, 256> linear;          // of each byte
    std::array<float, 257> threshold;       // byte k holds the values from threshold[k] to threshold[k + 1]
    std::array<uint8_t, kCells + 1> first;  // byte of each cell's lower end

    Tables() {
        for (uint32_t k = 0; k < 256; ++k) linear[k] = static_cast<float>(decode(k / 255.0));
        threshold[0] = 0;
        for (uint32_t k = 1; k < 256; ++k) threshold[k] = static_cast<float>(decode((k - 0.5) / 255));
        threshold[256] = 2;
        uint32_t byte = 0;
        for (uint32_t i = 0; i <= kCells; ++i) {
            const auto lower = static_cast<float>(i) / kCells;
            while (threshold[byte + 1] <= lower) ++byte;
            first[i] = static_cast<uint8_t>(byte);
        }
    }
};

const Tables& tables() {
    static const Tables all;
    return all;
}

/// NaN gives 0.
float clamp_unit(float value) {
    return value > 0 ? std::min(value, 1.0f) : 0.0f;
}

uint8_t byte_of(const Tables& t, float value) {
    const float x = clamp_unit(value);
    const uint8_t byte = t.first[static_cast<uint32_t>(x * kCells)];
    return static_cast<uint8_t>(byte + (x >= t.threshold[byte + 1u] ? 1 : 0));
}

uint8_t even_level(float value) {
    return static_cast<uint8_t>(clamp_unit(value) * 255 + 0.5f);
}

/// Texel i of an image with alpha: colours divided by it, and alpha.
std::array<uint8_t, 4> bytes_with_alpha(const Tables& t, const Image& image, size_t i) {
    const float alpha = clamp_unit(image.texels[3 * image.area() + i]);
    std::array<uint8_t, 4> bytes{};
    for (uint32_t c = 0; c < 3 && alpha > 0; ++c) bytes[c] = byte_of(t, image.texels[c * image.area() + i] / alpha);
    bytes[3] = even_level(alpha);
    return bytes;
}

}  // namespace

float linear_of_srgb(uint8_t value) {
    return tables().linear[value];
}

uint8_t srgb_of_linear(float value) {
    return byte_of(tables(), value);
}

void encode_srgb(std::span<const float> in, std::span<float> out) {
    assert(in.size() == out.size());
    run_wide([from = in.data(), to = out.data(), count = in.size()]() CITYSTREAM_INLINED {
        for (size_t i = 0; i < count; ++i) {
            const float low = from[i] > 0 ? from[i] : 0, x = low < 1 ? low : 1;
            // The curved part in terms of q = x^(1/4): 1.055 q^(5/3) - .055, here by the polynomial that meets it at
            // the eight Chebyshev nodes between the joint and 1.
            const float q = std::sqrt(std::sqrt(x));
            const float high = 1.14651502f + q * (-0.833786523f + q * (0.358946374f + q * -0.0679922621f));
            const float curve = -0.0585816804f + q * (0.125506082f + q * (1.4502421f + q * (-1.12084929f + q * high)));
            to[i] = x <= 0.0031308f ? 12.92f * x : curve;
        }
    });
}

Image linear_image(const ChartImage& image) {
    return linear_rows(image, 0, image.height);
}

Image linear_rows(const ChartImage& image, uint32_t y, uint32_t count) {
    const size_t first = size_t{y} * image.width, area = size_t{count} * image.width;
    Image out = linear_image(image.width, count, 3, std::span(image.rgb).subspan(3 * first, 3 * area));
    if (image.alpha.empty()) return out;
    out.channels = 4;
    out.texels.resize(4 * area);
    for (size_t i = 0; i < area; ++i) {
        const float alpha = static_cast<float>(image.alpha[first + i]) / 255;
        for (uint32_t c = 0; c < 3; ++c) out.texels[c * area + i] *= alpha;
        out.texels[3 * area + i] = alpha;
    }
    return out;
}

Image linear_image(uint32_t width, uint32_t height, uint32_t channels, std::span<const uint8_t> bytes) {
    assert((channels == 1 || channels == 3 || channels == 4) && bytes.size() == size_t{width} * height * channels);
    const Tables& t = tables();
    Image out(width, height, channels);
    const size_t area = out.area();
    const uint32_t colours = std::min(channels, 3u);
    for (uint32_t c = 0; c < colours; ++c) {
        float* plane = out.plane(c).data();
        for (size_t i = 0; i < area; ++i) plane[i] = t.linear[bytes[i * channels + c]];
    }
    if (channels == 4) {
        for (size_t i = 0; i < area; ++i) {
            const float alpha = static_cast<float>(bytes[4 * i + 3]) / 255;
            for (uint32_t c = 0; c < 3; ++c) out.texels[c * area + i] *= alpha;
            out.texels[3 * area + i] = alpha;
        }
    }
    return out;
}

std::vector<uint8_t> srgb_bytes(const Image& image) {
    const Tables& t = tables();
    const size_t area = image.area();
    std::vector<uint8_t> bytes(image.texels.size());
    if (image.channels == 4) {
        for (size_t i = 0; i < area; ++i) {
            const auto texel = bytes_with_alpha(t, image, i);
            std::copy(texel.begin(), texel.end(), &bytes[4 * i]);
        }
        return bytes;
    }
    for (uint32_t c = 0; c < image.channels; ++c) {
        const float* plane = image.plane(c).data();
        for (size_t i = 0; i < area; ++i) bytes[i * image.channels + c] = byte_of(t, plane[i]);
    }
    return bytes;
}

ChartImage chart_image(const Image& image) {
    const std::vector<uint8_t> bytes = srgb_bytes(image);
    ChartImage out;
    out.width = image.width;
    out.height = image.height;
    out.rgb.resize(3 * image.area());
    for (size_t i = 0; i < image.area(); ++i) {
        for (uint32_t c = 0; c < 3; ++c)
            out.rgb[3 * i + c] = bytes[i * image.channels + std::min(c, image.channels - 1)];
    }
    if (image.channels < 4) return out;
    for (size_t i = 0; i < image.area(); ++i) out.alpha.push_back(bytes[4 * i + 3]);
    return out;
}

void quantise(Image& image) {
    const Tables& t = tables();
    if (image.channels != 4) {
        for (float& texel : image.texels) texel = t.linear[byte_of(t, texel)];
        return;
    }
    const size_t area = image.area();
    for (size_t i = 0; i < area; ++i) {
        const auto bytes = bytes_with_alpha(t, image, i);
        const float alpha = static_cast<float>(bytes[3]) / 255;
        for (uint32_t c = 0; c < 3; ++c) image.texels[c * area + i] = t.linear[bytes[c]] * alpha;
        image.texels[3 * area + i] = alpha;
    }
}

void test_alpha(Image& image) {
    if (image.channels != 4) return;
    const size_t area = image.area();
    for (size_t i = 0; i < area; ++i) {
        float& alpha = image.texels[3 * area + i];
        const bool there = alpha >= 0.5f;
        for (uint32_t c = 0; c < 3; ++c) {
            float& colour = image.texels[c * area + i];
            colour = there ? colour / alpha : 0.0f;
        }
        alpha = there ? 1.0f : 0.0f;
    }
}

}  // namespace citystream::codec::atlas
