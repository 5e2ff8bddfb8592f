// The forms that are looked up by texel, as their tests see them.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "codec/facade/binary_map.h"
#include "codec/facade/max_mip_map.h"
#include "codec/facade/raw_map.h"
#include "codec/facade/singular_value_map.h"

namespace citystream::codec::facade {

using Words = std::span<const uint32_t>;

struct TexelForm {
    std::string name;
    std::function<Result<std::vector<uint32_t>>(const RunGrid&)> encode;
    std::function<Status(Words)> check;
    std::function<Result<RunGrid>(Words)> decode;
    std::function<uint32_t(Words, uint32_t x, uint32_t y)> label;
    std::function<FreeBox(Words, uint32_t x, uint32_t y)> box;  ///< null where the form has none
    bool refuses = false;                                       ///< what would be larger than raw
};

inline std::vector<TexelForm> texel_forms() {
    return {
        {"raw", [](const RunGrid& grid) { return encode_raw_map(grid, true); }, check_raw_map, decode_raw_map,
         raw_label, raw_box},
        {"raw without boxes", [](const RunGrid& grid) { return encode_raw_map(grid, false); }, check_raw_map,
         decode_raw_map, raw_label, nullptr},
        {"maximum mips", encode_max_mip_map, check_max_mip_map, decode_max_mip_map, max_mip_label, nullptr},
        {"binary factors", [](const RunGrid& grid) { return encode_binary_map(grid, BinaryVariant::kPaper); },
         check_binary_map, decode_binary_map, binary_label, binary_box, true},
        {"shared binary factors", [](const RunGrid& grid) { return encode_binary_map(grid, BinaryVariant::kShared); },
         check_binary_map, decode_binary_map, binary_label, binary_box, true},
        {"singular values", [](const RunGrid& grid) { return encode_singular_value_map(grid); },
         check_singular_value_map, decode_singular_value_map, singular_value_label, singular_value_box, true}};
}

}  // namespace citystream::codec::facade
