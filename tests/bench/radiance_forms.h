// A transfer in each of the forms that it can be kept and sent in: bytes, work, time, and whether all of them say the
// same.
//
//   dense      every entry a byte; wire: zstd -3 (higher levels take hours of a gigabyte)
//   csr        16-bit column and 8-bit value an entry, 32 bits a row; csr_wire.h's rows by the range coder (row_wire.h)
//   rowdedupe  the same of distinct rows, 32 bits a row for which it is; csr_wire.h
//   bicluster  biclusters of all rows, 4 (r + 2l) bytes each, as the paper's sizes imply; bicluster_wire.h
//   bits       a bit a sample, and a 16-bit local direction for each sample of each frame; visibility_wire.h. Frames
//              follow from the receivers' places, or from a mesh's normals
//   default    the layer: of a tile its steps on the wire and its words in memory (radiance_layer.h), receivers' places
//              and irradiance included; of a mesh bits, and biclusters of distinct rows as radiance_resident.h has them
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "codec/radiance/bicluster.h"
#include "tests/bench/radiance_samples.h"

namespace citystream::bench {

enum class SeedingChoice : uint8_t { kEntry, kRow, kBest };

inline constexpr std::array<std::string_view, 6> kFormNames = {"dense",     "csr",  "rowdedupe",
                                                               "bicluster", "bits", "default"};

struct FormOptions {
    std::vector<std::string> forms = {kFormNames.begin(), kFormNames.end()};  ///< that are measured
    uint32_t local_side = 8;
    SeedingChoice seeding = SeedingChoice::kBest;  ///< kBest: both are tried, the one with less work is taken
    uint32_t row_budget = 0;                       ///< of `bicluster`, in quarters a row (bicluster.h)
    int repetitions = 5;
};

struct FormFigures {
    std::string name;
    uint64_t resident_bytes = 0, wire_bytes = 0;
    uint64_t flops = 0;  ///< of a channel
    /// Processor time of one thread, as all of these. Search of a tile's layer: what decoding to clusters takes longer
    /// than to rows.
    double search_seconds = 0, encode_seconds = 0, decode_seconds = 0;
    double transfer_seconds = 0;  ///< of three channels: sums of the samples' medians
    /// Entries that come back from the wire or from memory as others, and rows whose light is not what the bits give
    /// added up in fp64; with a row budget, those that miss by more than it allows.
    uint64_t mismatches = 0;
};

struct TransferFigures {
    uint64_t receivers = 0, nonzeros = 0;
    double transfer_seconds = 0;     ///< making the matrix from bits, processor time
    std::vector<FormFigures> forms;  ///< those of the options, in the order above
};

/// Sums over the samples. Light is a made-up sky in whole numbers, so that all forms must agree to the last bit.
/// Precondition: receivers times local directions of each sample below 2^24.
TransferFigures measure_forms(std::span<const RadianceSample> samples, const FormOptions& options);

/// Biclusters by a choice of seeding.
codec::radiance::Biclusters search_biclusters(const codec::radiance::Transfer& transfer, SeedingChoice seeding,
                                              uint32_t row_budget);

}  // namespace citystream::bench
