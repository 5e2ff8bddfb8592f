// Every representation of one facade, measured and verified entry by entry: the rows of the paper's Table 1 and ours.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/bench/facade_sets.h"

namespace citystream::bench {

struct RepresentationRow {
    std::string facade, representation;
    std::string map;   ///< "D", "M" or "A" of a split row; empty: what the representation needs to render
    std::string form;  ///< what the map is kept as: the representation, or what it falls back to or chooses
    uint32_t rows = 0, columns = 0;
    uint64_t resident_bytes = 0, wire_bytes = 0;
    std::optional<double> loads_per_lookup, loads_per_ray;  ///< empty where nothing is looked up or cast
    uint64_t terms = 0;
    double encode_s = 0;
    uint64_t mismatches = 0;
};

/// Rows "raw", "png", "zstd", "xz", "svd", "binary", "binary-shared", "max-mip", "quotient", "tiled", "patch" and
/// "default" (what the builder ships) of D, M and A together; with `split`, also D, M and A each where it can be told.
///
/// Resident bytes are what random access needs: of archives the plain D and M. Wire bytes of forms that never travel:
/// zstd -19 of their words. Loads are counted by running the shaders on the CPU: random texels, and rays from the top
/// plane at 0 to 85 degrees in all directions, mean over the angles, material included; svd and binary by their boxes.
/// Refused factors fall back to raw.
std::vector<RepresentationRow> measure_representations(const BenchFacade& facade, bool split);

/// Bytes of all D, M and A as matrices by xz -9e, and of one joint matrix by the better of xz -9e and zstd -19.
struct ArchiveBytes {
    uint64_t xz_all = 0, best_joint = 0;
};
ArchiveBytes archive_bytes(const BenchFacade& facade);

}  // namespace citystream::bench
