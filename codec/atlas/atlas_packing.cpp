#include "codec/atlas/atlas_packing.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "codec/atlas/atlas_layout.h"
#include "codec/atlas/block_planes.h"
#include "codec/atlas/mip_plan.h"
#include "codec/atlas/page_layer.h"

namespace citystream::codec::atlas {

namespace {

constexpr uint32_t kMagic = 0x50415343, kAlphaMagic = 0x51415343;  // "CSAP", "CSAQ": with BC3 blocks
constexpr size_t kHeadWords = 2;                                   // magic, count of runs

/// Words of a table, and the blocks that follow them: BC1, then BC3.
struct Run {
    uint64_t table = 0, blocks = 0, alpha_blocks = 0;
    uint64_t block_words() const { return kBc1BlockWords * blocks; }
    uint64_t alpha_words() const { return kBc3BlockWords * alpha_blocks; }
    uint64_t words() const { return table + block_words() + alpha_words(); }
};

bool have_alpha(std::span<const Run> runs) {
    return std::any_of(runs.begin(), runs.end(), [](const Run& run) { return run.alpha_blocks > 0; });
}

/// Numbers that packed words list of a run.
size_t numbers_of_run(bool alpha) {
    return alpha ? 3 : 2;
}

/// The runs of a step whose parts begin at `parts` (ascending word numbers in it): what is before the first part and
/// each part's `charts` offsets are tables. Nothing where that does not come out even.
std::optional<std::vector<Run>> runs_of(std::span<const uint64_t> parts, uint64_t charts, uint64_t word_count) {
    std::vector<Run> runs;
    uint64_t begin = 0;
    for (size_t i = 0; i < parts.size(); ++i) {
        const uint64_t end = i + 1 < parts.size() ? parts[i + 1] : word_count;
        if (parts[i] < begin || charts > word_count - parts[i] || parts[i] + charts > end) return std::nullopt;
        const uint64_t table = parts[i] + charts - begin, blocks = end - parts[i] - charts;
        if (blocks % kBc1BlockWords != 0) return std::nullopt;
        runs.push_back({table, blocks / kBc1BlockWords});
        begin = end;
    }
    return runs;
}

/// Of pages: tables only in step 0, before all blocks.
std::optional<std::vector<Run>> runs_of_pages(std::span<const uint32_t> step0, uint32_t step, uint64_t word_count) {
    uint64_t table = 0;
    if (step == 0) {
        if (step0.size() < PAGES_HEADER_WORDS) return std::nullopt;
        table = PAGES_HEADER_WORDS + uint64_t{step0[PAGES_WORD_PAGE_COUNT]} * PAGES_PAGE_WORDS +
                uint64_t{step0[PAGES_WORD_CHART_COUNT]} * PAGES_CHART_WORDS;
    }
    if (table > word_count || (word_count - table) % kBc1BlockWords != 0) return std::nullopt;
    return std::vector<Run>{{table, (word_count - table) / kBc1BlockWords}};
}

/// Splits the blocks of a mip's run, of which encode_atlas puts those of charts with alpha last. False where it did
/// not.
bool split_alpha(std::span<const uint32_t> step0, uint32_t mip, Run& run) {
    uint64_t alpha_words = 0;
    for (uint64_t chart = 0; chart < step0[ATLAS_WORD_CHART_COUNT]; ++chart) {
        const uint32_t* entry = &step0[ATLAS_HEADER_WORDS + chart * ATLAS_CHART_WORDS];
        const uint32_t flags = entry[ATLAS_CHART_FLAGS];
        if ((flags & ATLAS_CHART_SHARED) != 0 || (flags & ATLAS_CHART_ALPHA) == 0 || mip >= (flags >> 8 & 0xffU))
            continue;
        alpha_words += block_words(chart_shape(entry[ATLAS_CHART_SIZE], flags), mip);
    }
    if (alpha_words > run.block_words()) return false;
    run = {run.table, (run.block_words() - alpha_words) / kBc1BlockWords, alpha_words / kBc3BlockWords};
    return true;
}

std::optional<std::vector<Run>> runs_of_step(std::span<const uint32_t> step0, uint32_t step, uint64_t word_count) {
    if (is_page_layer(step0)) return runs_of_pages(step0, step, word_count);
    if (step0.size() < ATLAS_HEADER_WORDS || step0[ATLAS_WORD_MAGIC] != ATLAS_MAGIC) return std::nullopt;
    const uint64_t charts = step0[ATLAS_WORD_CHART_COUNT], table = step0[ATLAS_WORD_MIP_TABLE];
    const uint32_t mips = step0[ATLAS_WORD_MIP_COUNT], finest = step0[ATLAS_WORD_STEP0_MIP];
    if (charts > (step0.size() - ATLAS_HEADER_WORDS) / ATLAS_CHART_WORDS) return std::nullopt;
    if (mips == 0 || mips > ATLAS_MAX_MIPS || finest >= mips || table + ATLAS_MAX_MIPS > step0.size() || step > finest)
        return std::nullopt;
    std::vector<uint64_t> parts;
    if (step > 0) {
        parts.push_back(0);
    } else {
        for (uint32_t mip = mips; mip-- > finest;) parts.push_back(step0[table + mip]);
        for (const uint64_t part : parts) {
            if (part > word_count) return std::nullopt;
        }
    }
    auto runs = runs_of(parts, charts, word_count);
    uint32_t mip = step > 0 ? finest - step : mips - 1;
    for (size_t i = 0; runs && i < runs->size(); ++i, --mip) {
        if (!split_alpha(step0, mip, (*runs)[i])) return std::nullopt;
    }
    return runs;
}

/// Calls copy(table, BC1 blocks, BC3 blocks) for every run of a step's words.
template <typename Words, typename Copy>
void walk(std::span<const Run> runs, Words words, Copy copy) {
    for (const Run& run : runs) {
        copy(words.first(run.table), words.subspan(run.table, run.block_words()),
             words.subspan(run.table + run.block_words(), run.alpha_words()));
        words = words.subspan(run.words());
    }
}

/// Words of what all runs hold together.
struct Sums {
    uint64_t tables = 0, blocks = 0, alpha = 0;
};

Sums sums_of(std::span<const Run> runs) {
    Sums sums;
    for (const Run& run : runs) {
        sums.tables += run.table;
        sums.blocks += run.block_words();
        sums.alpha += run.alpha_words();
    }
    return sums;
}

Error error_at(const char* what, uint64_t byte) {
    return Error{std::string("packed atlas step: ") + what, byte};
}

/// The runs that packed bytes name, which have to add up to `word_count` words and to all the bytes.
Result<std::vector<Run>> read_runs(std::span<const std::byte> bytes, uint64_t word_count) {
    uint32_t head[kHeadWords];
    if (!is_packed_atlas(bytes) || bytes.size() < sizeof(head)) return error_at("wrong magic", 0);
    std::memcpy(head, bytes.data(), sizeof(head));
    const uint64_t count = head[1];
    const size_t numbers = numbers_of_run(head[0] == kAlphaMagic);
    if (count > ATLAS_MAX_MIPS || bytes.size() < 4 * (kHeadWords + numbers * count))
        return error_at("wrong count of runs", 4);
    std::vector<Run> runs(count);
    uint64_t sum = 0;
    for (size_t i = 0; i < count; ++i) {
        uint32_t sizes[3] = {};
        std::memcpy(sizes, bytes.data() + 4 * (kHeadWords + numbers * i), 4 * numbers);
        runs[i] = {sizes[0], sizes[1], sizes[2]};
        sum += runs[i].words();
    }
    if (sum != word_count) return error_at("runs of another size than the step", 4 * kHeadWords);
    if (bytes.size() != 4 * (kHeadWords + numbers * count + word_count)) return error_at("wrong size", bytes.size());
    return runs;
}

}  // namespace

std::optional<std::vector<std::byte>> pack_atlas_step(std::span<const uint32_t> step0, uint32_t step,
                                                      std::span<const uint32_t> words) {
    const auto runs = runs_of_step(step0, step, words.size());
    if (!runs) return std::nullopt;
    const bool alpha = have_alpha(*runs);
    std::vector<uint32_t> packed = {alpha ? kAlphaMagic : kMagic, static_cast<uint32_t>(runs->size())};
    packed.reserve(kHeadWords + numbers_of_run(alpha) * runs->size() + words.size());
    for (const Run& run : *runs) {
        packed.insert(packed.end(), {static_cast<uint32_t>(run.table), static_cast<uint32_t>(run.blocks)});
        if (alpha) packed.push_back(static_cast<uint32_t>(run.alpha_blocks));
    }
    std::vector<uint32_t> blocks, alpha_blocks;
    blocks.reserve(words.size());
    walk(std::span(*runs), words, [&](auto table, auto own, auto own_alpha) {
        packed.insert(packed.end(), table.begin(), table.end());
        blocks.insert(blocks.end(), own.begin(), own.end());
        alpha_blocks.insert(alpha_blocks.end(), own_alpha.begin(), own_alpha.end());
    });
    const size_t tables_end = packed.size();
    packed.resize(tables_end + blocks.size() + alpha_blocks.size());
    const auto planes = std::span(packed).subspan(tables_end);
    split_block_planes(blocks, kBc1BlockWords, planes.first(blocks.size()));
    split_block_planes(alpha_blocks, kBc3BlockWords, planes.subspan(blocks.size()));
    const auto bytes = std::as_bytes(std::span(packed));
    return std::vector<std::byte>(bytes.begin(), bytes.end());
}

bool is_packed_atlas(std::span<const std::byte> bytes) {
    uint32_t magic = 0;
    if (bytes.size() < sizeof(magic)) return false;
    std::memcpy(&magic, bytes.data(), sizeof(magic));
    return magic == kMagic || magic == kAlphaMagic;
}

uint64_t most_packed_atlas_bytes(uint64_t words) {
    return 4 * (kHeadWords + numbers_of_run(true) * ATLAS_MAX_MIPS + words);
}

Result<std::vector<uint32_t>> unpack_atlas_step(std::span<const std::byte> bytes, uint64_t word_count) {
    const auto runs = read_runs(bytes, word_count);
    if (!runs) return runs.error();
    std::vector<uint32_t> packed(word_count), words(word_count);
    const size_t head = bytes.size() - 4 * word_count;
    if (word_count > 0) std::memcpy(packed.data(), bytes.data() + head, 4 * word_count);
    const Sums sums = sums_of(*runs);
    std::vector<uint32_t> blocks(sums.blocks), alpha_blocks(sums.alpha);
    join_block_planes(std::span(packed).subspan(sums.tables, sums.blocks), kBc1BlockWords, blocks);
    join_block_planes(std::span(packed).subspan(sums.tables + sums.blocks), kBc3BlockWords, alpha_blocks);
    std::span<const uint32_t> next_table = packed, next_blocks = blocks, next_alpha = alpha_blocks;
    const auto take = [](std::span<const uint32_t>& from, std::span<uint32_t> to) {
        std::copy_n(from.begin(), to.size(), to.begin());
        from = from.subspan(to.size());
    };
    walk(std::span(*runs), std::span(words), [&](auto table, auto own, auto own_alpha) {
        take(next_table, table);
        take(next_blocks, own);
        take(next_alpha, own_alpha);
    });
    return words;
}

}  // namespace citystream::codec::atlas
