#include "codec/facade/cut_wire.h"

#include <algorithm>
#include <map>
#include <set>

#include "codec/facade/facade_form.h"
#include "codec/facade/patch_map.h"
#include "codec/facade/quotient_wire.h"

namespace citystream::codec::facade {

namespace {

using bits::BitModel;

constexpr size_t kMostPatchLabels = 256, kMostLabels = 65535;

/// A facade as its bands see it: runs along them and across them, and which of these are alike.
struct BandView {
    BandView(const QuotientParts& quotient, bool transposed)
        : parts(quotient),
          turned(transposed),
          along(transposed ? quotient.y_breaks : quotient.x_breaks),
          across(transposed ? quotient.x_breaks : quotient.y_breaks),
          along_classes(transposed ? quotient.y_classes : quotient.x_classes),
          across_classes(transposed ? quotient.x_classes : quotient.y_classes) {}
    uint32_t label(size_t run_along, size_t run_across) const {
        const uint32_t a = along_classes[run_along], b = across_classes[run_across];
        return turned ? parts.label(b, a) : parts.label(a, b);
    }
    /// Whether two neighbouring runs along differ in the rows first..last - 1.
    bool differ_along(size_t run, size_t first, size_t last) const {
        for (size_t row = first; row < last; ++row) {
            if (label(run - 1, row) != label(run, row)) return true;
        }
        return false;
    }
    bool differ_across(size_t run, size_t first, size_t last) const {
        for (size_t column = first; column < last; ++column) {
            if (label(column, run - 1) != label(column, run)) return true;
        }
        return false;
    }

    const QuotientParts& parts;
    bool turned;
    const std::vector<uint32_t>&along, &across, &along_classes, &across_classes;
};

/// Decisions "cut here" along one line of breaks: what was decided between the same two kinds of runs last.
class CutMemory {
  public:
    uint32_t last(uint32_t left, uint32_t right) const {
        const auto known = last_.find({left, right});
        return known == last_.end() ? 0 : known->second;
    }
    void learn(uint32_t left, uint32_t right, uint32_t cut) { last_[{left, right}] = 1 + cut; }

  private:
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> last_;
};

/// Bands and stripes, as numbers of runs, in both directions.
class CutCoder {
  public:
    explicit CutCoder(const BandView& view) : view_(view) {}

    /// `starts`: first runs of the bands; `lists`: of each band's stripes. Given when writing, filled when reading,
    /// until the bytes run out.
    template <typename Coder>
    void code(Coder& coder, std::vector<size_t>& starts, std::vector<std::vector<size_t>>& lists) {
        code_bands(coder, starts);
        const std::vector<std::vector<size_t>> given = std::move(lists);
        lists = {};
        below_.assign(view_.along_classes.size(), 0);
        before_below_ = below_;
        for (size_t band = 0; band < starts.size(); ++band) {
            if constexpr (Coder::kDecodes) {
                if (!coder.ok()) return;
            }
            const size_t end = band + 1 < starts.size() ? starts[band + 1] : view_.across_classes.size();
            lists.push_back(code_list(coder, starts[band], end, Coder::kDecodes ? std::vector<size_t>() : given[band]));
        }
    }

  private:
    template <typename Coder>
    void code_bands(Coder& coder, std::vector<size_t>& starts) {
        const std::vector<size_t> given = std::move(starts);
        starts = {0};
        CutMemory memory;
        uint32_t last = 1;
        for (size_t run = 1, next = 1; run < view_.across_classes.size(); ++run) {
            const uint32_t left = view_.across_classes[run - 1], right = view_.across_classes[run];
            const bool here = next < given.size() && given[next] == run;
            const uint32_t cut = coder.bit(band_[memory.last(left, right)][last], here ? 1 : 0);
            next += here ? 1 : 0;
            memory.learn(left, right, cut);
            last = cut;
            if (cut != 0) starts.push_back(run);
        }
    }

    /// A band like an earlier one mostly has its list. Breaks at which the band does not differ are no cuts.
    template <typename Coder>
    std::vector<size_t> code_list(Coder& coder, size_t first, size_t end, const std::vector<size_t>& given) {
        std::vector<uint32_t> rows;
        for (size_t run = first; run < end; ++run) {
            rows.push_back(view_.across_classes[run]);
            rows.push_back(view_.across[run + 1] - view_.across[run]);
        }
        std::vector<size_t>& known = lists_[rows];
        if (!known.empty() && coder.bit(as_known_, given == known ? 1 : 0) != 0) {
            remember(known);
            return known;
        }
        std::vector<size_t> list = {0};
        CutMemory memory;
        uint32_t last = 0;
        for (size_t run = 1, next = 1; run < view_.along_classes.size(); ++run) {
            if (!view_.differ_along(run, first, end)) continue;
            const uint32_t left = view_.along_classes[run - 1], right = view_.along_classes[run];
            const bool here = next < given.size() && given[next] == run;
            BitModel& model = stripe_[memory.last(left, right)][below_[run] + 2 * before_below_[run]][last];
            const uint32_t cut = coder.bit(model, here ? 1 : 0);
            next += here ? 1 : 0;
            memory.learn(left, right, cut);
            last = cut;
            if (cut != 0) list.push_back(run);
        }
        known = list;
        remember(list);
        return list;
    }

    void remember(const std::vector<size_t>& list) {
        before_below_ = std::move(below_);
        below_.assign(view_.along_classes.size(), 0);
        for (const size_t run : list) below_[run] = 1;
    }

    const BandView& view_;
    std::map<std::vector<uint32_t>, std::vector<size_t>> lists_;  ///< of bands by what they show
    std::vector<uint32_t> below_, before_below_;
    BitModel band_[3][2], stripe_[3][4][2], as_known_ = BitModel(0.9);
};

/// The content of a stripe in a band, runs c0..c1 - 1 along and r0..r1 - 1 across; nothing where no patch can hold it.
std::optional<PatchStripe> make_stripe(const BandView& view, PatchBuilder& builder, size_t c0, size_t c1, size_t r0,
                                       size_t r1) {
    PatchBreaks rows, columns;
    std::vector<size_t> row_runs = {r0}, column_runs = {c0};
    for (size_t row = r0 + 1; row < r1; ++row) {
        if (!view.differ_across(row, c0, c1)) continue;
        row_runs.push_back(row);
        rows.push_back(static_cast<uint16_t>(view.across[row] - view.across[r0]));
    }
    for (size_t column = c0 + 1; column < c1; ++column) {
        if (!view.differ_along(column, r0, r1)) continue;
        column_runs.push_back(column);
        columns.push_back(static_cast<uint16_t>(view.along[column] - view.along[c0]));
    }
    PatchStripe stripe{view.along[c0], false, 0};
    if (rows.empty() && columns.empty()) {
        stripe.content = builder.label(view.label(c0, r0));
        return stripe;
    }
    if (!fits_break_list(rows) || !fits_break_list(columns)) return std::nullopt;
    std::vector<uint32_t> labels;
    for (const size_t row : row_runs) {
        for (const size_t column : column_runs) labels.push_back(view.label(column, row));
    }
    if (std::set<uint32_t>(labels.begin(), labels.end()).size() > kMostPatchLabels) return std::nullopt;
    stripe.is_patch = true;
    stripe.content = builder.patch(rows, columns, labels);
    return stripe;
}

Result<std::vector<uint32_t>> build_words(const BandView& view, const std::vector<size_t>& starts,
                                          const std::vector<std::vector<size_t>>& lists) {
    PatchStructure head;
    head.length = view.along.back();
    head.breadth = view.across.back();
    head.transposed = view.turned;
    head.depths = RunGrid{{}, {}, view.parts.labels}.depths();
    PatchBuilder builder(head);
    for (size_t band = 0; band < starts.size(); ++band) {
        const size_t end = band + 1 < starts.size() ? starts[band + 1] : view.across_classes.size();
        std::vector<PatchStripe> stripes;
        for (size_t s = 0; s < lists[band].size(); ++s) {
            const size_t last = s + 1 < lists[band].size() ? lists[band][s + 1] : view.along_classes.size();
            const auto stripe = make_stripe(view, builder, lists[band][s], last, starts[band], end);
            if (!stripe) return Error{"patch map: a stripe is too varied for a patch"};
            stripes.push_back(*stripe);
        }
        builder.band(view.across[starts[band]], builder.list(stripes));
    }
    return write_patch_words(builder.take());
}

/// Runs that begin at these texels; nothing where one is no break.
std::optional<std::vector<size_t>> runs_at(const std::vector<uint32_t>& breaks, const std::vector<uint32_t>& texels) {
    std::vector<size_t> runs;
    for (const uint32_t texel : texels) {
        const auto at = std::lower_bound(breaks.begin(), breaks.end(), texel);
        if (at == breaks.end() || *at != texel) return std::nullopt;
        runs.push_back(static_cast<size_t>(at - breaks.begin()));
    }
    return runs;
}

struct CutRuns {
    std::vector<size_t> starts;
    std::vector<std::vector<size_t>> lists;
};

std::optional<CutRuns> cut_runs(const BandView& view, const PatchCuts& cuts) {
    const auto starts = runs_at(view.across, cuts.bands);
    if (!starts) return std::nullopt;
    CutRuns runs{*starts, {}};
    for (size_t band = 0; band < cuts.stripes.size(); ++band) {
        const auto list = runs_at(view.along, cuts.stripes[band]);
        if (!list) return std::nullopt;
        runs.lists.push_back(*list);
    }
    return runs;
}

bool cuts_differ(const BandView& view, const CutRuns& runs) {
    for (size_t band = 0; band < runs.starts.size(); ++band) {
        const size_t end = band + 1 < runs.starts.size() ? runs.starts[band + 1] : view.across_classes.size();
        for (size_t s = 1; s < runs.lists[band].size(); ++s) {
            if (!view.differ_along(runs.lists[band][s], runs.starts[band], end)) return false;
        }
    }
    return true;
}

}  // namespace

std::optional<CutMap> cut_map_of(std::span<const uint32_t> words) {
    const auto structure = read_patch_words(words);
    const auto grid = decode_patch_map(words);
    if (!structure || !grid || grid->labels.size() > most_cut_cells(4 * words.size())) return std::nullopt;
    CutMap map{make_quotient(*grid), {structure->transposed, {}, {}}};
    for (const PatchBand& band : structure->bands) {
        map.cuts.bands.push_back(band.y0);
        map.cuts.stripes.emplace_back();
        for (const PatchStripe& stripe : structure->lists[band.list]) map.cuts.stripes.back().push_back(stripe.x0);
    }
    const BandView view(map.parts, map.cuts.transposed);
    const auto runs = cut_runs(view, map.cuts);
    if (!runs || !cuts_differ(view, *runs)) return std::nullopt;
    const auto again = build_words(view, runs->starts, runs->lists);
    if (!again || !std::equal(words.begin(), words.end(), again->begin(), again->end())) return std::nullopt;
    return map;
}

void put_cut_wire(const CutMap& map, bits::RangeEncoder& encoder) {
    put_quotient_wire(map.parts, encoder);
    BitModel transposed(0.5);
    encoder.bit(transposed, map.cuts.transposed ? 1 : 0);
    const BandView view(map.parts, map.cuts.transposed);
    CutRuns runs = cut_runs(view, map.cuts).value();
    CutCoder(view).code(encoder, runs.starts, runs.lists);
}

Result<std::vector<uint32_t>> get_cut_wire(bits::RangeDecoder& decoder, size_t resident_bytes) {
    const uint64_t cells = most_cut_cells(resident_bytes);
    const auto parts = get_quotient_wire(decoder, {cells, cells});
    if (!parts) return parts.error();
    BitModel transposed(0.5);
    const BandView view(*parts, decoder.bit(transposed) != 0);
    CutRuns runs;
    CutCoder(view).code(decoder, runs.starts, runs.lists);
    if (const Status finished = decoder.finish(); !finished) return finished.error();
    std::vector<uint32_t> labels = parts->labels;
    std::sort(labels.begin(), labels.end());
    if (std::unique(labels.begin(), labels.end()) - labels.begin() > static_cast<std::ptrdiff_t>(kMostLabels))
        return Error{"patch map: more than 65535 labels"};
    return build_words(view, runs.starts, runs.lists);
}

}  // namespace citystream::codec::facade
