#include "codec/facade/patch_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <unordered_map>

#include "codec/bits/bit_stream.h"
#include "codec/facade/patch_band.h"
#include "codec/facade/patch_structure.h"

namespace citystream::codec::facade {

namespace {

constexpr float kNever = std::numeric_limits<float>::infinity();
// Bytes of the words of a band, a stripe and a patch.
constexpr float kBandBytes = 4.5f, kStripeBytes = 4, kPatchBytes = 7;
/// Most cells that the search for bands looks at, for each texel; the bands of noise have fewer rows.
constexpr uint64_t kBandStepsPerTexel = 24;
constexpr uint32_t kLeastBandRows = 8;
/// Most patches that the search for stripes tries.
constexpr uint64_t kCandidatesPerTexel = 1, kFreeCandidates = 200000, kLeastCandidates = 2;
constexpr size_t kMostCounted = size_t{1} << 18;
/// A band does not grow on when it has so often in a row cost so many times what smaller bands would.
constexpr float kHopeless = 1.3f;
constexpr uint32_t kMostHopeless = 12;

/// How often each thing was used in the last pass: things used n times cost each user 1/n of their bytes.
using Uses = std::unordered_map<uint64_t, uint32_t>;

float shared_cost(const Uses& uses, uint64_t hash, float bytes) {
    const auto place = uses.find(hash);
    return place == uses.end() ? bytes : bytes / static_cast<float>(place->second);
}

float list_bytes(uint32_t count, uint32_t last) {
    return 1.0f + static_cast<float>((count * break_width(last) + 7) / 8);
}

/// Hash of the places of a patch's row breaks.
uint64_t hash_rows(const NumberedCells& cells, uint32_t first_row, uint64_t changes) {
    uint64_t hash = 1;
    for (uint64_t rest = changes; rest != 0; rest &= rest - 1) {
        const uint32_t row = first_row + 1 + static_cast<uint32_t>(std::countr_zero(rest));
        hash = mix_hash(hash, cells.ys[row] - cells.ys[first_row]);
    }
    return hash;
}

/// A patch while columns are added to it on the right.
struct GrowingPatch {
    uint32_t x0 = 0, last = 0, columns = 0;
    uint64_t changes = 0, hash = 1, column_hash = 1;
    LabelSet labels;

    explicit GrowingPatch(uint32_t x) : x0(x) {}
    void add(const BandColumn& column) {
        if (columns > 0) {
            last = column.x - x0;
            column_hash = mix_hash(column_hash, last);
        }
        hash = mix_hash(mix_hash(hash, column.x - x0), column.hash);
        changes |= column.changes;
        labels.add(column.labels);
        ++columns;
    }
    uint32_t rows() const { return static_cast<uint32_t>(std::popcount(changes)) + 1; }
    float grid_bytes() const {
        const uint32_t bits = bits::bits_for(std::max(labels.size(), 2u) - 1);
        return static_cast<float>((rows() * columns * bits + 7) / 8);
    }
    float palette_bytes(uint32_t label_bits) const { return static_cast<float>((labels.size() * label_bits + 7) / 8); }
};

class Search {
  public:
    Search(const NumberedCells& cells, PatchStructure head)
        : cells_(cells), head_(std::move(head)), label_bits_(bits::bits_for(cells.words.size() - 1)) {
        count_equal_bands();
    }

    /// One pass over bands and stripes; learns the uses of what it finds.
    PatchStructure pass() {
        const std::vector<uint32_t> cuts = cut_bands();
        const std::vector<size_t> band_of_cut = find_bands(cuts);
        PatchBuilder builder(head_);
        Uses parts;
        std::vector<uint32_t> list_of_band;
        for (size_t i = 0; i < band_of_cut.size(); ++i) {
            const size_t band = band_of_cut[i];
            if (band == list_of_band.size()) {
                const Band& different = bands_[band];
                list_of_band.push_back(builder.list(cut_stripes(different.rows, different.columns, builder, parts)));
            }
            builder.band(cells_.ys[cuts[i]], list_of_band[band]);
        }
        uses_ = std::move(parts);
        knows_pools_ = true;
        return builder.take();
    }

  private:
    using Stripes = std::vector<PatchStripe>;
    struct Band {
        BandRows rows;
        std::vector<BandColumn> columns;
    };

    // --- bands
    /// Of the rows' labels and heights.
    uint64_t band_key(BandRows rows) const {
        uint64_t hash = 7;
        for (uint32_t r = rows.first; r < rows.last; ++r) hash = mix_hash(hash, row_keys_[r]);
        return hash;
    }

    void count_equal_bands() {
        const uint64_t cells = uint64_t{cells_.rows()} * cells_.columns();
        const uint64_t texels = uint64_t{cells_.xs.back()} * cells_.ys.back();
        most_rows_ = static_cast<uint32_t>(
            std::clamp<uint64_t>(kBandStepsPerTexel * texels / cells, kLeastBandRows, kMostBandRows));
        for (uint32_t r = 0; r < cells_.rows(); ++r) {
            uint64_t hash = cells_.ys[r + 1] - cells_.ys[r];
            for (uint32_t c = 0; c < cells_.columns(); ++c) hash = mix_hash(hash, cells_.id(c, r));
            row_keys_.push_back(hash);
        }
        equal_bands_.reserve(size_t{cells_.rows()} * most_rows_);
        for (uint32_t r = 0; r < cells_.rows(); ++r) {
            uint64_t hash = 7;
            for (uint32_t last = r; last < cells_.rows() && last < r + most_rows_; ++last) {
                hash = mix_hash(hash, row_keys_[last]);
                ++equal_bands_[hash];
            }
        }
    }

    /// A column of texels while the foot of the band goes down the facade.
    struct SlidingColumn {
        uint64_t changes = 0;    ///< as BandColumn, over the next 64 rows
        uint32_t differs = ~0u;  ///< next row that differs from the column on the left
    };
    /// One of the columns of the bands that begin at a row, while their top goes up.
    struct RisingColumn {
        uint32_t column, x, differs;
        uint64_t changes, hash;
        LabelSet labels;
    };

    std::vector<uint32_t> cut_bands() {
        const uint32_t rows = cells_.rows(), columns = cells_.columns();
        std::vector<SlidingColumn> sliding(columns);
        std::vector<float> best(rows + 1, kNever);
        std::vector<uint32_t> next(rows + 1, 0);
        best[rows] = 0;
        for (uint32_t first = rows; first-- > 0;) {
            const uint16_t* row = cells_.row(first);
            const uint16_t* above = first + 1 < rows ? cells_.row(first + 1) : row;
            for (uint32_t c = 0; c < columns; ++c) {
                SlidingColumn& column = sliding[c];
                column.changes = column.changes << 1 | uint64_t{row[c] != above[c]};
                if (c > 0 && row[c] != row[c - 1]) column.differs = first;
            }
            bands_from(first, sliding, best, next);
        }
        std::vector<uint32_t> cuts = {0};
        while (cuts.back() < rows) cuts.push_back(next[cuts.back()]);
        return cuts;
    }

    void bands_from(uint32_t first, const std::vector<SlidingColumn>& sliding, std::vector<float>& best,
                    std::vector<uint32_t>& next) {
        const uint32_t end = std::min(cells_.rows(), first + most_rows_);
        std::vector<RisingColumn>& rising = rising_;
        rising.clear();
        for (uint32_t c = 0; c < cells_.columns(); ++c) {
            if (c > 0 && sliding[c].differs >= end) continue;
            rising.push_back({c, cells_.xs[c], c == 0 ? first : sliding[c].differs, sliding[c].changes, 0, {}});
        }
        uint64_t key = 7;
        uint32_t hopeless = 0;
        for (uint32_t last = first + 1; last <= end; ++last) {
            const uint32_t r = last - 1;
            const uint16_t* row = cells_.row(r);
            for (RisingColumn& column : rising) {
                if (r > first && (column.changes >> (r - first - 1) & 1) == 0) continue;
                const uint32_t id = row[column.column];
                column.hash = mix_hash(column.hash, uint64_t{cells_.ys[r] - cells_.ys[first]} << 16 | id);
                column.labels.add(id);
            }
            key = mix_hash(key, row_keys_[r]);
            const float list = estimate({first, last}, rising);
            if (list == kNever) break;  // more rows never fit again
            const float own = kBandBytes + list / static_cast<float>(equal_bands_[key]);
            if (own > kHopeless * (best[first] - best[last])) {
                if (++hopeless == kMostHopeless) break;
            } else {
                hopeless = 0;
            }
            const float cost = own + best[last];
            if (cost < best[first]) {
                best[first] = cost;
                next[first] = last;
            }
        }
    }

    /// Bytes of the stripe list of a band that is cut at every column of one label.
    float estimate(BandRows rows, const std::vector<RisingColumn>& rising) {
        const uint64_t in_band = rows.last - rows.first > kMostBandRows - 1
                                     ? ~uint64_t{0} >> 1
                                     : (uint64_t{1} << (rows.last - rows.first - 1)) - 1;
        float cost = 0;
        ++stamp_;
        GrowingPatch patch(0);
        for (const RisingColumn& rise : rising) {
            if (rise.differs >= rows.last) continue;
            const BandColumn column{rise.column, rise.x, rise.changes & in_band, rise.hash, rise.labels};
            if (column.changes == 0) {
                cost += kStripeBytes + patch_cost_once(patch, rows);
                patch = GrowingPatch(0);
                continue;
            }
            if (patch.columns > 0 && (!columns_fit(patch.columns, column.x - patch.x0) ||
                                      !rows_fit(cells_, rows.first, patch.changes | column.changes))) {
                cost += patch_cost_once(patch, rows);
                patch = GrowingPatch(0);
            }
            if (patch.columns == 0) {
                if (!rows_fit(cells_, rows.first, column.changes)) return kNever;
                patch = GrowingPatch(column.x);
            }
            patch.add(column);
        }
        return cost + patch_cost_once(patch, rows);
    }

    /// Parts that the band has already paid for cost nothing.
    float patch_cost_once(const GrowingPatch& patch, BandRows rows) {
        if (patch.columns == 0) return 0;
        float cost = kStripeBytes;
        if (!first_time(patch.hash)) return cost;
        const uint64_t row_hash = mix_hash(patch.changes, 3);
        float own = kPatchBytes + patch.grid_bytes() + patch.palette_bytes(label_bits_);
        if (first_time(row_hash)) {
            const uint32_t last = rows.first + static_cast<uint32_t>(std::bit_width(patch.changes));
            own += list_bytes(patch.rows() - 1, cells_.ys[last] - cells_.ys[rows.first]);
        }
        if (first_time(mix_hash(patch.column_hash, 5))) own += list_bytes(patch.columns - 1, patch.last);
        return cost + (knows_pools_ ? shared_cost(uses_, patch.hash, own) : own);
    }

    /// Whether the hash is new in this estimate.
    bool first_time(uint64_t hash) {
        for (uint32_t probe = 0; probe < 8; ++probe) {
            Seen& seen = seen_[(hash + probe) % kSeen];
            if (seen.stamp == stamp_ && seen.hash == hash) return false;
            if (seen.stamp != stamp_) {
                seen = {hash, stamp_};
                return true;
            }
        }
        return true;
    }

    // --- stripes
    bool are_equal(BandRows a, BandRows b) const {
        if (a.last - a.first != b.last - b.first) return false;
        for (uint32_t i = 0; i < a.last - a.first; ++i) {
            const uint16_t* row = cells_.row(a.first + i);
            if (cells_.ys[a.first + i + 1] - cells_.ys[a.first + i] !=
                    cells_.ys[b.first + i + 1] - cells_.ys[b.first + i] ||
                !std::equal(row, row + cells_.columns(), cells_.row(b.first + i)))
                return false;
        }
        return true;
    }

    /// The different bands, in the order in which they occur, and which of them each band is. In the first pass counts
    /// how often each candidate patch occurs in them.
    std::vector<size_t> find_bands(const std::vector<uint32_t>& cuts) {
        bands_.clear();
        std::unordered_map<uint64_t, size_t> band_of_key;
        std::vector<size_t> band_of_cut;
        for (size_t i = 0; i + 1 < cuts.size(); ++i) {
            const BandRows rows{cuts[i], cuts[i + 1]};
            const auto [place, is_new] = band_of_key.try_emplace(band_key(rows), bands_.size());
            if (!is_new && are_equal(rows, bands_[place->second].rows)) {
                band_of_cut.push_back(place->second);
                continue;
            }
            band_of_cut.push_back(bands_.size());
            bands_.push_back({rows, band_columns(cells_, rows)});
        }
        limit_candidates();
        if (!knows_pools_) count_candidates();
        return band_of_cut;
    }

    template <typename Visit>
    void for_each_patch(BandRows rows, const std::vector<BandColumn>& columns, size_t i, Visit visit) {
        GrowingPatch patch(columns[i].x);
        for (size_t j = i; j < columns.size() && j < i + most_columns_; ++j) {
            if (j > i && !columns_fit(static_cast<uint32_t>(j - i), columns[j].x - columns[i].x)) break;
            patch.add(columns[j]);
            if (!rows_fit(cells_, rows.first, patch.changes)) break;
            visit(patch, j + 1);
        }
    }

    /// Narrower patches in noise, where there would be too many to try.
    void limit_candidates() {
        uint64_t columns = 0;
        for (const Band& band : bands_) columns += band.columns.size();
        const uint64_t texels = uint64_t{cells_.xs.back()} * cells_.ys.back();
        const uint64_t most = (kCandidatesPerTexel * texels + kFreeCandidates) / std::max<uint64_t>(1, columns);
        most_columns_ = std::clamp<uint64_t>(most, kLeastCandidates, PATCH_MOST_BREAKS + 1);
    }

    void count_candidates() {
        for (const Band& band : bands_) {
            for (size_t i = 0; i < band.columns.size(); ++i) {
                for_each_patch(band.rows, band.columns, i, [&](const GrowingPatch& patch, size_t) {
                    if (uses_.size() < kMostCounted) ++uses_[patch.hash];
                });
            }
        }
    }

    struct Step {
        float cost = kNever;
        uint32_t from = 0;
        bool is_patch = false;
    };

    Stripes cut_stripes(BandRows rows, const std::vector<BandColumn>& columns, PatchBuilder& builder, Uses& parts) {
        std::vector<Step> steps(columns.size() + 1);
        steps[0].cost = 0;
        const auto relax = [&](size_t from, size_t to, float cost, bool is_patch) {
            if (cost < steps[to].cost) steps[to] = {cost, static_cast<uint32_t>(from), is_patch};
        };
        for (size_t i = 0; i < columns.size(); ++i) {
            const float before = steps[i].cost + kStripeBytes;
            if (columns[i].changes == 0) relax(i, i + 1, before, false);
            for_each_patch(rows, columns, i, [&](const GrowingPatch& patch, size_t j) {
                const bool is_flat = patch.columns == 1 && patch.changes == 0;
                if (!is_flat)
                    relax(i, j, before + patch_cost(patch, rows, columns, i, j, steps[j].cost - before), true);
            });
        }
        Stripes stripes;
        for (size_t j = columns.size(); j > 0; j = steps[j].from) {
            const size_t i = steps[j].from;
            stripes.push_back({columns[i].x, steps[j].is_patch, static_cast<uint32_t>(j)});
        }
        std::reverse(stripes.begin(), stripes.end());
        return finish_stripes(rows, columns, stripes, builder, parts);
    }

    /// The patches of the stripes found, whose content is the end column until now.
    Stripes finish_stripes(BandRows rows, const std::vector<BandColumn>& columns, const Stripes& found,
                           PatchBuilder& builder, Uses& parts) {
        Stripes stripes;
        size_t i = 0;
        for (const PatchStripe& stripe : found) {
            const size_t j = stripe.content;
            if (stripe.is_patch) {
                add_patch(rows, columns, i, j, builder, parts, stripes);
            } else {
                const uint32_t word = cells_.words[cells_.id(columns[i].column, rows.first)];
                stripes.push_back({columns[i].x, false, builder.label(word)});
            }
            i = j;
        }
        return stripes;
    }

    void add_patch(BandRows rows, const std::vector<BandColumn>& columns, size_t i, size_t j, PatchBuilder& builder,
                   Uses& parts, Stripes& stripes) {
        GrowingPatch patch(columns[i].x);
        for (size_t c = i; c < j; ++c) patch.add(columns[c]);
        const PatchGridKeys keys = grid_keys(patch.changes, rows, columns, i, j);
        if (keys.labels > size_t{1} << PATCH_MOST_CELL_BITS) {  // only among more than 128 labels
            const size_t middle = (i + j) / 2;
            add_patch(rows, columns, i, middle, builder, parts, stripes);
            add_patch(rows, columns, middle, j, builder, parts, stripes);
            return;
        }
        if (parts[patch.hash]++ == 0) {
            ++parts[hash_rows(cells_, rows.first, patch.changes)];
            ++parts[patch.column_hash];
            ++parts[keys.grid];
            ++parts[keys.palette];
        }
        PatchBreaks row_breaks, column_breaks;
        std::vector<uint32_t> grid_rows = {rows.first};
        for (uint64_t rest = patch.changes; rest != 0; rest &= rest - 1) {
            grid_rows.push_back(rows.first + 1 + static_cast<uint32_t>(std::countr_zero(rest)));
            row_breaks.push_back(static_cast<uint16_t>(cells_.ys[grid_rows.back()] - cells_.ys[rows.first]));
        }
        for (size_t c = i + 1; c < j; ++c) column_breaks.push_back(static_cast<uint16_t>(columns[c].x - columns[i].x));
        std::vector<uint32_t> labels;
        for (const uint32_t r : grid_rows) {
            for (size_t c = i; c < j; ++c) labels.push_back(cells_.words[cells_.id(columns[c].column, r)]);
        }
        if (keys.labels == 1) {
            stripes.push_back({columns[i].x, false, builder.label(labels[0])});
            return;
        }
        stripes.push_back({columns[i].x, true, builder.patch(row_breaks, column_breaks, labels)});
    }

    struct PatchGridKeys {
        uint64_t grid = 0, palette = 0;
        size_t labels = 0;
        float bytes = 0;  ///< of the grid, folded or not
    };

    /// Different ones among the first `count` hashes.
    static uint32_t different(const std::array<uint64_t, kMostBandRows>& hashes, size_t count) {
        uint32_t found = 0;
        for (size_t i = 0; i < count; ++i) {
            const auto place = hashes.begin() + static_cast<std::ptrdiff_t>(i);
            if (std::find(hashes.begin(), place, *place) == place) ++found;
        }
        return found;
    }

    /// Hashes of the numbered grid and of its palette.
    PatchGridKeys grid_keys(uint64_t changes, BandRows rows, const std::vector<BandColumn>& columns, size_t i,
                            size_t j) {
        numbers_.resize(cells_.words.size());
        ++grid_stamp_;
        PatchGridKeys keys{11, 13, 0, 0};
        std::array<uint64_t, kMostBandRows> row_hashes, column_hashes;
        std::fill_n(column_hashes.begin(), j - i, columns[i].x);
        uint32_t grid_rows = 0;
        const auto add_row = [&](uint32_t r) {
            const uint16_t* row = cells_.row(r);
            uint64_t row_hash = 1;
            for (size_t c = i; c < j; ++c) {
                const uint16_t id = row[columns[c].column];
                Number& number = numbers_[id];
                if (number.stamp != grid_stamp_) {
                    number = {grid_stamp_, static_cast<uint32_t>(keys.labels++)};
                    keys.palette = mix_hash(keys.palette, id);
                }
                row_hash = mix_hash(row_hash, number.index);
                column_hashes[c - i] = mix_hash(column_hashes[c - i], number.index);
            }
            keys.grid = mix_hash(keys.grid, row_hash);
            row_hashes[grid_rows++] = row_hash;
        };
        add_row(rows.first);
        for (uint64_t rest = changes; rest != 0; rest &= rest - 1)
            add_row(rows.first + 1 + static_cast<uint32_t>(std::countr_zero(rest)));
        const auto across = static_cast<uint32_t>(j - i);
        const uint32_t bits = std::max(1u, bits::bits_for(keys.labels - 1));
        const uint32_t folded =
            folded_bits(grid_rows, across, different(row_hashes, grid_rows), different(column_hashes, across), bits);
        keys.bytes = static_cast<float>((std::min(grid_rows * across * bits, folded) + 7) / 8);
        return keys;
    }

    /// Bytes of a patch; anything where they are more than `most`.
    float patch_cost(const GrowingPatch& patch, BandRows rows, const std::vector<BandColumn>& columns, size_t i,
                     size_t j, float most) {
        const uint32_t last = rows.first + static_cast<uint32_t>(std::bit_width(patch.changes));
        const float row_bytes = list_bytes(patch.rows() - 1, cells_.ys[last] - cells_.ys[rows.first]);
        const float column_bytes = list_bytes(patch.columns - 1, patch.last);
        const float palette_bytes = patch.palette_bytes(label_bits_);
        if (!knows_pools_) {
            return shared_cost(uses_, patch.hash,
                               kPatchBytes + row_bytes / 2 + column_bytes + patch.grid_bytes() + palette_bytes);
        }
        const auto known = uses_.find(patch.hash);
        if (kPatchBytes / static_cast<float>(known == uses_.end() ? 1u : known->second) >= most) return most;
        const PatchGridKeys keys = grid_keys(patch.changes, rows, columns, i, j);
        const float own = kPatchBytes + shared_cost(uses_, hash_rows(cells_, rows.first, patch.changes), row_bytes) +
                          shared_cost(uses_, patch.column_hash, column_bytes) +
                          shared_cost(uses_, keys.grid, keys.bytes) + shared_cost(uses_, keys.palette, palette_bytes);
        return shared_cost(uses_, patch.hash, own);
    }

    struct Seen {
        uint64_t hash = 0;
        uint32_t stamp = 0;
    };
    struct Number {
        uint32_t stamp = 0, index = 0;
    };
    static constexpr size_t kSeen = 1024;

    const NumberedCells& cells_;
    PatchStructure head_;
    uint32_t label_bits_;
    uint32_t most_rows_ = 1;
    size_t most_columns_ = PATCH_MOST_BREAKS + 1;
    std::vector<uint64_t> row_keys_;
    Uses equal_bands_, uses_;
    bool knows_pools_ = false;
    std::vector<Band> bands_;  ///< all different
    std::vector<RisingColumn> rising_;
    std::vector<Seen> seen_ = std::vector<Seen>(kSeen);
    uint32_t stamp_ = 0;
    std::vector<Number> numbers_;
    uint32_t grid_stamp_ = 0;
};

}  // namespace

struct PatchSearch::State {
    NumberedCells cells;
    Search search;
    State(NumberedCells numbered, const PatchStructure& head) : cells(std::move(numbered)), search(cells, head) {}
};

PatchSearch::PatchSearch() = default;
PatchSearch::PatchSearch(PatchSearch&&) noexcept = default;
PatchSearch::~PatchSearch() = default;

Result<PatchSearch> PatchSearch::create(const RunGrid& grid, bool transposed) {
    auto cells = number_cells(grid, transposed);
    if (!cells) return cells.error();
    PatchStructure head;
    head.length = cells->xs.back();
    head.breadth = cells->ys.back();
    head.transposed = transposed;
    head.depths = grid.depths();
    PatchSearch search;
    search.state_ = std::make_unique<State>(std::move(*cells), head);
    return search;
}

Result<std::vector<uint32_t>> PatchSearch::pass() {
    return write_patch_words(state_->search.pass());
}

}  // namespace citystream::codec::facade
