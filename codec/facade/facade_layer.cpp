#include "codec/facade/facade_layer.h"

#include <bit>
#include <cmath>
#include <string>

#include "codec/chart_word.h"
#include "codec/facade/facade_layout.h"

namespace citystream::codec::facade {

namespace {

/// Corners are sums of two coordinates and must stay int32.
constexpr int32_t kMaxCoordinate = 1 << 30;

Error error_at(std::string message, uint64_t word) {
    return Error{"facade layer: " + std::move(message), word * 4};
}

bool in_range(int32_t coordinate) {
    return coordinate >= -kMaxCoordinate && coordinate <= kMaxCoordinate;
}

Status check_placement(const Placement& placement, uint64_t word, uint32_t dictionary_size, uint64_t palette_count) {
    for (const int32_t coordinate :
         {placement.origin[0], placement.origin[1], placement.origin[2], placement.along[0], placement.along[1]}) {
        if (!in_range(coordinate)) return error_at("placement reaches too far from its tile", word);
    }
    if (placement.height > static_cast<uint32_t>(kMaxCoordinate)) {
        return error_at("placement is too high", word + FACADE_PLACEMENT_HEIGHT);
    }
    if (placement.map >= dictionary_size) {
        return error_at(
            "map " + std::to_string(placement.map) + " of a dictionary of " + std::to_string(dictionary_size),
            word + FACADE_PLACEMENT_MAP);
    }
    if (placement.palette >= palette_count) {
        return error_at("palette " + std::to_string(placement.palette) + " of " + std::to_string(palette_count),
                        word + FACADE_PLACEMENT_PALETTE);
    }
    return Done{};
}

Placement read_placement(std::span<const uint32_t> words) {
    Placement placement{};
    for (int c = 0; c < 3; ++c) placement.origin[c] = static_cast<int32_t>(words[FACADE_PLACEMENT_ORIGIN_X + c]);
    for (int c = 0; c < 2; ++c) placement.along[c] = static_cast<int32_t>(words[FACADE_PLACEMENT_ALONG_X + c]);
    placement.height = words[FACADE_PLACEMENT_HEIGHT];
    placement.map = words[FACADE_PLACEMENT_MAP];
    placement.palette = words[FACADE_PLACEMENT_PALETTE];
    return placement;
}

Result<Palette> read_palette(std::span<const uint32_t> words, uint64_t word, uint32_t atlas_chart_count) {
    Palette palette{};
    for (PaletteEntry& entry : palette.slots) {
        entry = {words[word], std::bit_cast<float>(words[word + 1])};
        if (!is_chart_word(entry.chart_word, atlas_chart_count)) {
            return error_at(
                "chart " + std::to_string(entry.chart_word) + " of an atlas of " + std::to_string(atlas_chart_count),
                word);
        }
        if (!std::isfinite(entry.metres_per_repeat) || entry.metres_per_repeat < 0) {
            return error_at("length of a repeat is not a positive number", word + 1);
        }
        word += FACADE_PALETTE_ENTRY_WORDS;
    }
    return palette;
}

Status check_header(std::span<const uint32_t> words) {
    if (words.size() < FACADE_LAYER_HEADER_WORDS) return error_at("shorter than its header", words.size());
    if (words[FACADE_LAYER_WORD_MAGIC] != FACADE_LAYER_MAGIC) return error_at("wrong magic", FACADE_LAYER_WORD_MAGIC);
    const struct {
        const char* name;
        uint32_t offset_word, count_word, entry_words;
    } parts[] = {
        {"placements", FACADE_LAYER_WORD_PLACEMENTS, FACADE_LAYER_WORD_PLACEMENT_COUNT, FACADE_PLACEMENT_WORDS},
        {"palettes", FACADE_LAYER_WORD_PALETTES, FACADE_LAYER_WORD_PALETTE_COUNT, FACADE_PALETTE_WORDS},
    };
    for (const auto& part : parts) {
        const uint64_t begin = words[part.offset_word];
        if (begin < FACADE_LAYER_HEADER_WORDS || begin > words.size() ||
            words[part.count_word] > (words.size() - begin) / part.entry_words) {
            return error_at(std::string(part.name) + " reach outside the layer", part.offset_word);
        }
    }
    return Done{};
}

}  // namespace

LayerSteps encode_facades(const FacadeTile& tile) {
    const size_t palettes_begin = FACADE_LAYER_HEADER_WORDS;
    const size_t placements_begin = palettes_begin + tile.palettes.size() * FACADE_PALETTE_WORDS;
    LayerSteps steps(1);
    std::vector<uint32_t>& words = steps[0].words;
    words.reserve(placements_begin + tile.placements.size() * FACADE_PLACEMENT_WORDS);
    words.resize(FACADE_LAYER_HEADER_WORDS, 0);
    words[FACADE_LAYER_WORD_MAGIC] = FACADE_LAYER_MAGIC;
    words[FACADE_LAYER_WORD_PLACEMENT_COUNT] = static_cast<uint32_t>(tile.placements.size());
    words[FACADE_LAYER_WORD_PALETTE_COUNT] = static_cast<uint32_t>(tile.palettes.size());
    words[FACADE_LAYER_WORD_PLACEMENTS] = static_cast<uint32_t>(placements_begin);
    words[FACADE_LAYER_WORD_PALETTES] = static_cast<uint32_t>(palettes_begin);
    for (const Palette& palette : tile.palettes) {
        for (const PaletteEntry& entry : palette.slots) {
            words.insert(words.end(), {entry.chart_word, std::bit_cast<uint32_t>(entry.metres_per_repeat)});
        }
    }
    for (const Placement& placement : tile.placements) {
        for (const int32_t coordinate : placement.origin) words.push_back(static_cast<uint32_t>(coordinate));
        for (const int32_t coordinate : placement.along) words.push_back(static_cast<uint32_t>(coordinate));
        words.insert(words.end(), {placement.height, placement.map, placement.palette});
    }
    return steps;
}

Result<FacadeTile> decode_facades(std::span<const uint32_t> words, uint32_t dictionary_size,
                                  uint32_t atlas_chart_count) {
    if (const Status status = check_header(words); !status) return status.error();
    FacadeTile tile;
    tile.palettes.reserve(words[FACADE_LAYER_WORD_PALETTE_COUNT]);
    for (uint64_t i = 0; i < words[FACADE_LAYER_WORD_PALETTE_COUNT]; ++i) {
        const uint64_t word = words[FACADE_LAYER_WORD_PALETTES] + i * FACADE_PALETTE_WORDS;
        const Result<Palette> palette = read_palette(words, word, atlas_chart_count);
        if (!palette) return palette.error();
        tile.palettes.push_back(*palette);
    }
    tile.placements.reserve(words[FACADE_LAYER_WORD_PLACEMENT_COUNT]);
    for (uint64_t i = 0; i < words[FACADE_LAYER_WORD_PLACEMENT_COUNT]; ++i) {
        const uint64_t word = words[FACADE_LAYER_WORD_PLACEMENTS] + i * FACADE_PLACEMENT_WORDS;
        const Placement placement = read_placement(words.subspan(word, FACADE_PLACEMENT_WORDS));
        if (const Status status = check_placement(placement, word, dictionary_size, tile.palettes.size()); !status)
            return status.error();
        tile.placements.push_back(placement);
    }
    return tile;
}

}  // namespace citystream::codec::facade
