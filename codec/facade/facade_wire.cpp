#include "codec/facade/facade_wire.h"

#include <algorithm>
#include <cassert>
#include <optional>
#include <string>

#include "codec/bits/range_coder.h"
#include "codec/facade/cut_wire.h"
#include "codec/facade/facade_form.h"
#include "codec/facade/patch_wire.h"
#include "codec/facade/quotient_map.h"
#include "codec/facade/quotient_wire.h"
#include "codec/facade/tiled_layout.h"
#include "codec/facade/tiled_map.h"

namespace citystream::codec::facade {

namespace {

/// The forms that travel, the likeliest first: a bit each says "not this one".
constexpr FacadeForm kShippedForms[] = {FacadeForm::kPatch, FacadeForm::kTiled, FacadeForm::kQuotient};
constexpr double kIsAnother[] = {1.0 / 16, 1.0 / 2, 1.0 / 256};

template <typename Coder>
std::optional<FacadeForm> code_form(Coder& coder, FacadeForm form) {
    for (size_t i = 0; i < std::size(kShippedForms); ++i) {
        bits::BitModel another(kIsAnother[i]);
        if (coder.bit(another, form == kShippedForms[i] ? 0 : 1) == 0) return kShippedForms[i];
    }
    return std::nullopt;
}

/// Tiles of 64 cells take a record of at least 3 bits each; cells of a quotient take at least one bit, or are one.
QuotientLimits limits_of(FacadeForm form, size_t resident_bytes) {
    constexpr uint64_t kMostRunCells = uint64_t{kMaxFacadeSide} * kMaxFacadeSide;
    const uint64_t bits = 8 * uint64_t{resident_bytes};
    if (form == FacadeForm::kQuotient) return {bits, kMostRunCells};
    const uint64_t cells = (bits / TILE_CELL_BITS_BITS) << (2 * TILE_SIDE_LOG2);
    return {cells, cells};
}

Result<std::vector<uint32_t>> expand_quotient_wire(FacadeForm form, bits::RangeDecoder& decoder,
                                                   size_t resident_bytes) {
    const auto parts = get_quotient_wire(decoder, limits_of(form, resident_bytes));
    if (!parts) return parts.error();
    if (const Status finished = decoder.finish(); !finished) return finished.error();
    if (form == FacadeForm::kQuotient) return write_quotient_map(*parts);
    return encode_tiled_map(expand_quotient(*parts));
}

constexpr double kIsPools = 1.0 / 16;

/// A bit says whether the map comes as its pools, or as quotient and cuts: what is smaller.
void put_patch(std::span<const uint32_t> words, bits::RangeEncoder& encoder) {
    const std::optional<CutMap> cut = cut_map_of(words);
    bits::RangeEncoder as_pools, as_cuts;
    put_patch_wire(words, as_pools);
    if (cut) put_cut_wire(*cut, as_cuts);
    const bool pools = !cut || as_pools.finish().size() < as_cuts.finish().size();
    bits::BitModel is_pools(kIsPools);
    encoder.bit(is_pools, pools ? 1 : 0);
    if (pools)
        put_patch_wire(words, encoder);
    else
        put_cut_wire(*cut, encoder);
}

Result<std::vector<uint32_t>> get_patch(bits::RangeDecoder& decoder, size_t resident_bytes) {
    bits::BitModel is_pools(kIsPools);
    if (decoder.bit(is_pools) == 0) return get_cut_wire(decoder, resident_bytes);
    auto words = get_patch_wire(decoder, resident_bytes);
    if (const Status finished = decoder.finish(); !finished) return finished.error();
    return words;
}

uint64_t cost_of(const ShippedMap& map) {
    return 4 * uint64_t{map.words.size()} + map.wire.size();
}

}  // namespace

ShippedMap encode_shipped_map(const RunGrid& grid) {
    ShippedMap least;
    for (const FacadeForm form : kShippedForms) {
        auto words = encode_form(form, grid);
        // A form that is the larger one without its payload already needs none.
        if (!words || (!least.words.empty() && 4 * words->size() >= cost_of(least))) continue;
        ShippedMap map{std::move(*words), {}};
        map.wire = encode_wire(map.words);
        if (least.words.empty() || cost_of(map) < cost_of(least)) least = std::move(map);
    }
    return least;
}

std::vector<std::byte> encode_wire(std::span<const uint32_t> words) {
    const auto form = static_cast<FacadeForm>(words[FACADE_FORM_WORD_FORM] >> 16);
    bits::RangeEncoder encoder;
    [[maybe_unused]] const bool ships = code_form(encoder, form).has_value();
    assert(ships);
    if (form == FacadeForm::kPatch) {
        put_patch(words, encoder);
    } else if (form == FacadeForm::kQuotient) {
        put_quotient_wire(read_quotient_map(words).value(), encoder);
    } else {
        put_quotient_wire(make_quotient(decode_tiled_map(words).value()), encoder);
    }
    return encoder.finish();
}

Result<std::vector<uint32_t>> expand_wire(std::span<const std::byte> wire, size_t resident_bytes) {
    bits::RangeDecoder decoder(wire);
    const auto form = code_form(decoder, FacadeForm::kPatch);
    if (!form) return Error{"facade payload of unknown form", 0};
    auto words = *form == FacadeForm::kPatch ? get_patch(decoder, resident_bytes)
                                             : expand_quotient_wire(*form, decoder, resident_bytes);
    if (!words) return words.error();
    if (4 * words->size() != resident_bytes) {
        return Error{"facade payload expands to " + std::to_string(4 * words->size()) + " bytes, expected " +
                     std::to_string(resident_bytes)};
    }
    if (const Status checked = check_form(*words); !checked) return checked.error();
    return words;
}

}  // namespace citystream::codec::facade
