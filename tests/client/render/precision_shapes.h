// Precision buffers of random shapes and words.
#pragma once

#include <random>
#include <vector>

#include "codec/mesh/adaptive_precision.h"

namespace citystream::client::test {

/// Without bins: three components, no leading zeros.
inline codec::mesh::PrecisionShape make_shape(std::mt19937_64& random, uint32_t vertices, uint32_t full_bits,
                                              bool with_bins) {
    codec::mesh::PrecisionShape shape;
    shape.vertices = vertices;
    shape.full_bits = full_bits;
    shape.components = 1 + static_cast<uint32_t>(random() % 4);
    if (!with_bins) shape.components = 3;
    for (uint32_t c = 1; with_bins && c < shape.components; ++c)
        shape.leading[c] = static_cast<uint32_t>(random() % (full_bits + 1));
    if (with_bins && vertices > 0) {
        shape.bins.clear();
        uint32_t first = 0;
        for (uint32_t level = 0; level <= full_bits && first < vertices && shape.bins.size() < PRECISION_MOST_BINS;
             level += static_cast<uint32_t>(1 + random() % 3)) {
            shape.bins.push_back({first, level});
            first += static_cast<uint32_t>(1 + random() % (vertices / 3 + 1));
        }
    }
    return shape;
}

inline std::vector<uint32_t> random_words(std::mt19937_64& random, const codec::mesh::PrecisionShape& shape) {
    std::vector<uint32_t> words;
    for (uint32_t i = 0; i < shape.vertices * shape.components; ++i) {
        const uint32_t bits = shape.full_bits - shape.leading[i % shape.components];
        words.push_back(static_cast<uint32_t>(random() & ((uint64_t{1} << bits) - 1)));
    }
    return words;
}

/// Planes from..to - 1, one after the other.
inline std::vector<uint32_t> planes_between(const codec::mesh::PrecisionShape& shape, std::span<const uint32_t> words,
                                            uint32_t from, uint32_t to) {
    std::vector<uint32_t> planes;
    for (uint32_t plane = from; plane < to; ++plane) {
        const auto bits = codec::mesh::precision_plane(shape, words, plane);
        planes.insert(planes.end(), bits.begin(), bits.end());
    }
    return planes;
}

}  // namespace citystream::client::test
