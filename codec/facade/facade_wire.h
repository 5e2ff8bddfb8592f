// How a facade map travels: a payload smaller than the resident words and entropy coded by itself, expanded on arrival
// without search.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/facade/run_grid.h"
#include "codec/result.h"

namespace citystream::codec::facade {

/// A map as the builder ships it: the form with the least cost among patch, quotient and tiled.
struct ShippedMap {
    std::vector<uint32_t> words;  ///< resident
    std::vector<std::byte> wire;  ///< expands to exactly `words`
};

/// Of patch, tiled and quotient the one with the least resident bytes + wire bytes, the first of equals. (All three
/// look a label up in a bounded number of loads: patch about 8 to 11, tiled 4 or 5, quotient 3 or 4, so loads do not
/// decide.) The quotient bounds the size of every input. Exact, deterministic.
ShippedMap encode_shipped_map(const RunGrid& grid);

/// The payload of resident words (patch, quotient or tiled; programming error else).
std::vector<std::byte> encode_wire(std::span<const uint32_t> words);

/// Expands and checks (check_form). For untrusted bytes: fails when they do not expand to exactly `resident_bytes`,
/// when bytes are left over, or when the words do not pass. Reading ends where the bytes do, whatever sizes they claim,
/// and nothing is built of a payload that is too short or too long. Work and memory are bounded, too, by what words of
/// `resident_bytes` can describe: at most 20 bytes a cell of the run grid of a patch map (which has at most 2^14 cells
/// and 256 more for each resident byte), 4 a cell of the label grid of a quotient and of the run grid of a tiled map;
/// never more than 8192 x 8192 cells.
Result<std::vector<uint32_t>> expand_wire(std::span<const std::byte> wire, size_t resident_bytes);

}  // namespace citystream::codec::facade
