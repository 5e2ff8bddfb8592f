// Matrices of a facade in general archive formats: what our wire forms are compared with. Each call also reads back
// what it wrote.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "codec/facade/run_grid.h"

namespace citystream::bench {

/// Entries as little-endian numbers of 1, 2 or 4 bytes, row 0 first.
struct PlainMatrix {
    uint32_t width = 0, height = 0, entry_bytes = 1;
    std::vector<std::byte> bytes;
};

/// Displacement (int16).
PlainMatrix displacement_matrix(const codec::facade::FacadeMatrices& matrices);
/// Material, in one byte where all are below 256.
PlainMatrix material_matrix(const codec::facade::FacadeMatrices& matrices);
/// Entries in as few bytes as the greatest needs.
PlainMatrix index_matrix(uint32_t width, uint32_t height, std::span<const uint32_t> entries);
/// Displacement and material as one matrix: the rank of each texel's pair.
PlainMatrix joint_matrix(const codec::facade::FacadeMatrices& matrices);

struct Archived {
    uint64_t bytes = 0;
    uint64_t mismatches = 0;  ///< entries that came back otherwise
    double seconds = 0;       ///< to encode
};

/// "png" (best compression; 16-bit grey with two images for 4-byte entries), "zstd" (-19), "xz" (-9e).
Archived archive(std::string_view archiver, const PlainMatrix& matrix);

}  // namespace citystream::bench
