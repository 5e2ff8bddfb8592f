#include "tiles/layers/chart_dictionary.h"

#include <algorithm>
#include <cstring>

#include "codec/atlas/atlas_layout.h"
#include "codec/atlas/chart_content.h"
#include "codec/atlas/shared_chart.h"
#include "tiles/layers/build_stage.h"
#include "tiles/layers/memory_pass.h"
#include "tiles/tileset/chart_index.h"

namespace citystream::tiles::layers {
namespace {

using codec::atlas::ContentHash;
using tileset::ChartRecord;

constexpr size_t kCopiedBytes = size_t{4} << 20;
constexpr uint64_t kIndexBytes = 8, kIndexLevelBytes = 4;  // of charts/index, before it is compressed
constexpr uint64_t kFrameBytes = 16;                       // about what a frame of few bytes has beside its contents
// What a chart has to save: each is an entry of the index, which comes whole, a slot of a client's memory and a part of
// its requests. Chiyoda, dressed, with 64, 256 and 1024 bytes here: 8,162, 2,831 and 239 charts; a street flight moves
// 4.39, 4.15 and 4.00 MB and holds 22.4, 18.9 and 17.1 MB on the GPU, of an archive of 14.4, 14.9 and 15.5 MB. A
// generated city of 1,000 buildings: no difference beyond 0.2 %.
constexpr double kLeastGain = 1024;
constexpr uint64_t kBytesPerTexel = 16;  // estimate of what encoding takes

/// An encoded candidate.
struct CodedChart {
    bool usable = false;
    ChartRecord record;
    double metres_per_texel = 0;
    ContentHash hash;
    quadtree::SpoolRange payloads;  // all levels, coarse to fine
    uint64_t texels() const { return uint64_t{record.width} * record.height; }
};

std::shared_ptr<const ChartImage> image_of(const ChartKey& key, double coarseness, const ChartSources& sources) {
    if (key.is_image()) return sources.images.mip(key.name[0], static_cast<uint32_t>(coarseness));
    return sources.facades.picture(key.name[0], key.name[1], coarseness);
}

/// Of the payloads, size and flags.
ContentHash hash_of(const ChartRecord& record, std::span<const std::byte> payloads) {
    std::vector<uint32_t> words((payloads.size() + 3) / 4, 0);
    std::memcpy(words.data(), payloads.data(), payloads.size());
    return codec::atlas::content_hash({{uint32_t{record.width} | uint32_t{record.height} << 16, record.flags}, words});
}

/// Not of one colour, and of as many levels as the dictionary has places for.
bool is_worth_sharing(const ChartImage& image) {
    if (image.alpha.empty()) return !codec::atlas::flat_colour(image.rgb);
    return codec::atlas::atlas_step_count(image.width, image.height, ATLAS_CHART_ALPHA) <=
           codec::atlas::kMostChartLevels;
}

/// The chart and its payloads, one behind the other.
std::pair<CodedChart, std::vector<std::byte>> code_chart(ChartImage image, codec::atlas::AtlasOptions options) {
    CodedChart chart;
    chart.usable = true;
    chart.metres_per_texel = static_cast<double>(image.metres_per_texel);
    ChartRecord& record = chart.record;
    record.width = static_cast<uint16_t>(image.width);
    record.height = static_cast<uint16_t>(image.height);
    const uint32_t repeats = image.repeat_u ? ATLAS_CHART_REPEAT_U | ATLAS_CHART_REPEAT_V : 0;
    record.flags = static_cast<uint8_t>(repeats | (image.alpha.empty() ? 0 : ATLAS_CHART_ALPHA));
    record.colour = mean_of(image);
    std::vector<std::byte> bytes;
    const auto levels = codec::atlas::encode_chart_levels(codec::atlas::encode_atlas(std::span(&image, 1), options));
    for (const std::vector<std::byte>& level : levels) {
        record.level[record.level_count++].bytes = static_cast<uint32_t>(level.size());
        bytes.insert(bytes.end(), level.begin(), level.end());
    }
    chart.hash = hash_of(record, bytes);
    return {std::move(chart), std::move(bytes)};
}

/// Bytes of a chart in the dictionary, and those of them that grow with its texels.
struct ChartCost {
    uint64_t all = 0, of_texels = 0;
};

ChartCost cost_of(const ChartRecord& record) {
    uint64_t payloads = 0;
    for (const tileset::ChartLevelRecord& level : record.levels()) payloads += level.bytes;
    const uint64_t levels = record.level_count;
    const uint64_t fixed = std::min(payloads, levels * (kFrameBytes + codec::atlas::kChartChecksumBytes));
    return {payloads + kIndexBytes + kIndexLevelBytes * levels, payloads - fixed};
}

/// Candidates that look equal, and what the tiles that show any of them would store.
struct EqualCharts {
    size_t first = 0;
    double local_bytes = 0;
};

class Choice {
  public:
    Choice(std::span<const CityWishes::Candidate> candidates, std::span<const CodedChart> coded,
           quadtree::SpoolFile& spool)
        : candidates_(candidates), coded_(coded), spool_(spool) {}

    /// For every candidate the first one that is equal to it. Error: the disk.
    Status find_equal() {
        std::multimap<ContentHash, size_t> by_hash;
        for (size_t i = 0; i < coded_.size(); ++i) {
            first_.push_back(i);
            if (!coded_[i].usable) continue;
            const auto [begin, end] = by_hash.equal_range(coded_[i].hash);
            for (auto entry = begin; entry != end && first_[i] == i; ++entry) {
                const auto equal = are_equal(coded_[entry->second], coded_[i]);
                if (!equal) return equal.error();
                if (*equal) first_[i] = entry->second;
            }
            if (first_[i] == i) by_hash.emplace(coded_[i].hash, i);
        }
        return Done{};
    }

    /// Calls keep(candidate) for those that pay, by first use, and name(candidate, the kept one that shows it) for all
    /// that it stands for.
    template <typename Keep, typename Name>
    void run(Keep keep, Name name) const {
        std::vector<double> local_bytes(coded_.size(), 0);
        for (size_t i = 0; i < coded_.size(); ++i) {
            if (!coded_[i].usable) continue;
            const auto bytes = static_cast<double>(cost_of(coded_[i].record).of_texels);
            local_bytes[first_[i]] +=
                bytes * static_cast<double>(candidates_[i].demand.texels) / static_cast<double>(coded_[i].texels());
        }
        std::vector<bool> kept(coded_.size(), false);
        uint64_t sum = 0, count = 0;
        for (size_t i = 0; i < coded_.size(); ++i) {
            if (!coded_[i].usable) continue;
            const uint64_t cost = cost_of(coded_[i].record).all;
            if (first_[i] == i && local_bytes[i] > static_cast<double>(cost) + kLeastGain && sum + cost < UINT32_MAX &&
                count < tileset::kMaxSharedCharts) {
                kept[i] = true;
                sum += cost;
                ++count;
                keep(i);
            }
            if (kept[first_[i]]) name(i, first_[i]);
        }
    }

  private:
    Result<bool> are_equal(const CodedChart& a, const CodedChart& b) {
        if (a.record != b.record) return false;
        std::vector<std::byte> bytes_a, bytes_b;
        if (Status status = spool_.read(a.payloads, bytes_a); !status) return status.error();
        if (Status status = spool_.read(b.payloads, bytes_b); !status) return status.error();
        return bytes_a == bytes_b;
    }

    std::span<const CityWishes::Candidate> candidates_;
    std::span<const CodedChart> coded_;
    quadtree::SpoolFile& spool_;
    std::vector<size_t> first_;
};

Result<std::vector<CodedChart>> code_all(std::span<const CityWishes::Candidate> candidates, const ChartSources& sources,
                                         const BuildOptions& options, MemoryGate& gate, quadtree::SpoolFile& spool) {
    std::vector<CodedChart> coded(candidates.size());
    BuildStage stage(options, "charts", candidates.size());
    const Status status = stage.run(candidates.size(), [&](size_t i) -> Status {
        const CityWishes::Candidate& candidate = candidates[i];
        const auto image = image_of(candidate.key, candidate.demand.coarseness, sources);
        if (!image || !is_worth_sharing(*image)) return Done{};
        const MemoryPass pass(gate, kBytesPerTexel * image->width * image->height);
        ChartImage chart = *image;
        chart.repeat_u = chart.repeat_v = candidate.key.repeats();
        auto [own, bytes] = code_chart(std::move(chart), sources.atlas);
        const auto range = spool.append(bytes);
        if (!range) return range.error();
        own.payloads = *range;
        coded[i] = own;
        return Done{};
    });
    if (!status) return status.error();
    return coded;
}

}  // namespace

Result<ChartDictionary> ChartDictionary::make(CityWishes& wishes, const ChartSources& sources,
                                              const BuildOptions& options, MemoryGate& gate,
                                              quadtree::SpoolFile& spool) {
    const std::vector<CityWishes::Candidate> candidates = wishes.take_candidates();
    const auto coded = code_all(candidates, sources, options, gate, spool);
    if (!coded) return coded.error();
    Choice choice(candidates, *coded, spool);
    if (Status status = choice.find_equal(); !status) return status.error();
    ChartDictionary dictionary;
    std::vector<uint32_t> number(candidates.size(), 0);
    choice.run(
        [&](size_t kept) {
            number[kept] = static_cast<uint32_t>(dictionary.records_.size());
            dictionary.records_.push_back((*coded)[kept].record);
            dictionary.offsets_.push_back((*coded)[kept].payloads.offset);
        },
        [&](size_t candidate, size_t kept) {
            dictionary.charts_[candidates[candidate].key] = {number[kept], candidates[candidate].demand.coarseness,
                                                             (*coded)[candidate].metres_per_texel};
        });
    return dictionary;
}

std::optional<SharedChart> ChartDictionary::take(const ChartKey& key, double, uint64_t) {
    const auto found = charts_.find(key);
    if (found == charts_.end()) return std::nullopt;
    return found->second;
}

Status ChartDictionary::write_entry(archive::ArchiveWriter& writer, quadtree::SpoolFile& spool) const {
    if (records_.empty()) return Done{};
    struct Level {
        uint64_t begin;
        quadtree::SpoolRange payload;
    };
    std::vector<Level> levels;
    for (size_t i = 0; i < records_.size(); ++i) {
        uint64_t offset = offsets_[i];
        for (const tileset::ChartLevelRecord& level : records_[i].levels()) {
            levels.push_back({level.begin, {offset, level.bytes}});
            offset += level.bytes;
        }
    }
    std::sort(levels.begin(), levels.end(), [](const Level& a, const Level& b) { return a.begin < b.begin; });
    if (Status status = writer.begin_entry(tileset::kChartLevelsPath); !status) return status;
    std::vector<std::byte> bytes;
    for (const Level& level : levels) {
        if (Status status = spool.read(level.payload, bytes); !status) return status;
        if (bytes.size() < kCopiedBytes) continue;
        if (Status status = writer.append(bytes); !status) return status;
        bytes.clear();
    }
    if (!bytes.empty()) {
        if (Status status = writer.append(bytes); !status) return status;
    }
    return writer.end_entry();
}

}  // namespace citystream::tiles::layers
