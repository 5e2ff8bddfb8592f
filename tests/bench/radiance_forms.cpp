#include "tests/bench/radiance_forms.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <utility>

#include "codec/bits/zstd_frame.h"
#include "codec/radiance/bicluster_wire.h"
#include "codec/radiance/csr_wire.h"
#include "codec/radiance/radiance_layer.h"
#include "codec/radiance/radiance_resident.h"
#include "codec/radiance/row_wire.h"
#include "codec/radiance/source_light.h"
#include "codec/radiance/transfer_product.h"
#include "codec/radiance/visibility_wire.h"
#include "tests/bench/measure.h"

namespace citystream::bench {

namespace {

using namespace codec::radiance;
using Whole = Channels<uint32_t>;
using Exact = Channels<double>;

/// Receivers whose rows are expanded at a time.
constexpr uint32_t kDenseReceivers = 16;
constexpr int kDenseLevel = 3;
constexpr RadianceLimits kLimits = {.receivers = kMostReceivers, .entries = ~uint64_t{0}};

/// Bright above, a glow around one direction, dark below.
WholeLight made_up_sky(uint32_t texels_across) {
    std::vector<Rgb> radiance(texel_count(texels_across));
    for (uint32_t k = 0; k < radiance.size(); ++k) {
        const GridDirection d = cell_direction(texels_across, k);
        const double x = d[0], y = d[1], z = d[2], length = std::sqrt(x * x + y * y + z * z);
        const double glow = std::exp(8 * ((0.48 * x - 0.64 * y + 0.6 * z) / length - 1));
        const double up = std::max(0.0, z / length);
        radiance[k] = {static_cast<float>(0.1 + 0.4 * up + 3 * glow), static_cast<float>(0.1 + 0.6 * up + 2 * glow),
                       static_cast<float>(0.1 + 0.9 * up + glow)};
    }
    return whole_light(weighted_light(radiance, texels_across));
}

double median_seconds(int repetitions, const std::function<void()>& work) {
    std::vector<double> seconds;
    work();  // warms caches
    for (int i = 0; i < repetitions; ++i) seconds.push_back(processor_seconds_of(work));
    return spread_of(seconds).median;
}

uint64_t csr_bytes(const Transfer& transfer) {
    return 3 * transfer.nonzeros() + 4 * (uint64_t{transfer.rows()} + 1);
}

uint64_t differing_entries(const Transfer& a, const Transfer& b) {
    if (a == b) return 0;
    if (a.rows() != b.rows() || a.columns != b.columns) return std::max(a.nonzeros(), b.nonzeros());
    uint64_t differ = 0;
    for (uint32_t j = 0; j < a.rows(); ++j) {
        const SparseRow one = row_of(a, j), other = row_of(b, j);
        differ += one.columns == other.columns && one.values == other.values ? 0 : one.columns.size() + 1;
    }
    return differ;
}

/// What a decoder knows of receivers: everything but what they see.
VisibilityTile frames_of(const VisibilityTile& tile) {
    return {tile.side, tile.frames, tile.frame_of, {}};
}

/// One sample: its matrix, the light, and what the light must become.
class Case {
  public:
    Case(const RadianceSample& sample, const LocalDirections& local, const FormOptions& options)
        : sample_(sample), tile_(sample.visibility), local_(local), options_(options), light_(made_up_sky(tile_.side)) {
        transfer_seconds_ = processor_seconds_of([&] { transfer_ = make_transfer(tile_, local_); });
        for (const uint32_t code : tile_.frames)
            tables_.push_back(local_of_samples(unpack_frame(code), tile_.side, local_));
        std::vector<Exact> exact;
        for (const Whole& v : light_.values)
            exact.push_back({static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])});
        for (const Whole& v : light_.values) brightest_ = std::max({brightest_, v[0], v[1], v[2]});
        truth_ = product_by_bits<double>(tile_, local_.count(), tables_, exact);
    }

    const Transfer& transfer() const { return transfer_; }
    double transfer_seconds() const { return transfer_seconds_; }
    FormFigures dense() const;
    FormFigures csr() const;
    FormFigures rowdedupe() const;
    FormFigures bicluster() const;
    FormFigures bits() const;
    FormFigures layer_default() const;

  private:
    std::span<const Whole> light() const { return light_.values; }
    /// Rows that are off by more than `errors` quarters of the brightest texel allow; empty: by anything.
    uint64_t wrong_rows(std::span<const Whole> product, std::span<const uint32_t> errors = {}) const {
        uint64_t wrong = product.size() == truth_.size() ? 0 : truth_.size();
        for (size_t j = 0; j < std::min(product.size(), truth_.size()); ++j) {
            const double allowed = errors.empty() ? 0 : static_cast<double>(errors[j]) * brightest_;
            double off = 0;
            for (size_t c = 0; c < 3; ++c)
                off = std::max(off, std::abs(static_cast<int32_t>(product[j][c]) - truth_[j][c]));
            wrong += off <= allowed ? 0 : 1;
        }
        return wrong;
    }
    template <typename Work>
    void time(FormFigures& figures, const Work& product) const {
        figures.transfer_seconds = median_seconds(options_.repetitions, [&] { keep(product()); });
        figures.mismatches += wrong_rows(product());
    }

    const RadianceSample& sample_;
    const VisibilityTile& tile_;
    const LocalDirections& local_;
    const FormOptions& options_;
    WholeLight light_;
    uint32_t brightest_ = 0;
    Transfer transfer_;
    double transfer_seconds_ = 0;
    std::vector<std::vector<uint16_t>> tables_;
    std::vector<Exact> truth_;
};

/// Rows begin..end of a matrix.
Transfer part_of(const Transfer& transfer, uint32_t begin, uint32_t end) {
    const auto first = static_cast<std::ptrdiff_t>(transfer.row_begin[begin]);
    const auto last = static_cast<std::ptrdiff_t>(transfer.row_begin[end]);
    Transfer part{transfer.columns, {}, {}, {}};
    for (uint32_t j = begin; j <= end; ++j) part.row_begin.push_back(transfer.row_begin[j] - transfer.row_begin[begin]);
    part.column.assign(transfer.column.begin() + first, transfer.column.begin() + last);
    part.quarters.assign(transfer.quarters.begin() + first, transfer.quarters.begin() + last);
    return part;
}

FormFigures Case::dense() const {
    const uint64_t entries = uint64_t{transfer_.rows()} * transfer_.columns;
    FormFigures figures{"dense", entries, 0, 2 * entries};
    std::vector<Whole> product;
    for (uint32_t begin = 0; begin < transfer_.rows(); begin += kDenseReceivers * local_.count()) {
        const uint32_t end = std::min(transfer_.rows(), begin + kDenseReceivers * local_.count());
        const std::vector<int8_t> quarters = dense_quarters(part_of(transfer_, begin, end));
        std::vector<Whole> part;
        std::vector<double> seconds;
        for (int i = 0; i < std::min(options_.repetitions, 3); ++i)
            seconds.push_back(processor_seconds_of([&] { part = product_by_dense<uint32_t>(quarters, light()); }));
        figures.transfer_seconds += spread_of(seconds).median;
        product.insert(product.end(), part.begin(), part.end());
        std::vector<std::byte> frame;
        const std::span raw = std::as_bytes(std::span(quarters));
        figures.encode_seconds += processor_seconds_of([&] { frame = codec::bits::compress_frame(raw, kDenseLevel); });
        figures.wire_bytes += frame.size();
        figures.decode_seconds += processor_seconds_of([&] {
            const auto back = codec::bits::decompress_frame(frame, raw.size());
            figures.mismatches += back && std::ranges::equal(*back, raw) ? 0 : raw.size();
        });
    }
    figures.mismatches += wrong_rows(product);
    return figures;
}

FormFigures Case::csr() const {
    FormFigures figures{"csr", csr_bytes(transfer_), 0, transfer_.flops()};
    std::vector<std::byte> wire;
    figures.encode_seconds = processor_seconds_of([&] { wire = encode_rows(transfer_, local_.count()); });
    figures.wire_bytes = wire.size();
    Result<Transfer> back = Error{};
    figures.decode_seconds = processor_seconds_of([&] { back = decode_rows(wire, kLimits); });
    figures.mismatches += back ? differing_entries(*back, transfer_) : transfer_.nonzeros();
    time(figures, [&] { return product_by_entries<uint32_t>(transfer_, light()); });
    return figures;
}

FormFigures Case::rowdedupe() const {
    FormFigures figures{"rowdedupe"};
    DistinctRows distinct;
    figures.search_seconds = processor_seconds_of([&] { distinct = distinct_rows(transfer_); });
    figures.resident_bytes = csr_bytes(distinct.rows) + 4 * uint64_t{transfer_.rows()};
    figures.flops = distinct.rows.flops();
    std::vector<std::byte> wire;
    figures.encode_seconds = processor_seconds_of([&] { wire = encode_distinct_rows(distinct, local_.count()); });
    figures.wire_bytes = wire.size();
    Result<DistinctRows> back = Error{};
    figures.decode_seconds = processor_seconds_of([&] { back = decode_distinct_rows(wire, kLimits); });
    figures.mismatches += back ? differing_entries(all_rows(*back), transfer_) : transfer_.nonzeros();
    time(figures,
         [&] { return spread_rows<uint32_t>(distinct.row_of, product_by_entries<uint32_t>(distinct.rows, light())); });
    return figures;
}

FormFigures Case::bicluster() const {
    FormFigures figures{"bicluster"};
    Biclusters clusters;
    figures.search_seconds =
        processor_seconds_of([&] { clusters = search_biclusters(transfer_, options_.seeding, options_.row_budget); });
    figures.resident_bytes = 4 * (clusters.row.size() + 2 * clusters.column.size());
    figures.flops = clusters.flops();
    std::vector<std::byte> wire;
    figures.encode_seconds = processor_seconds_of([&] { wire = encode_biclusters(clusters, local_.count()); });
    figures.wire_bytes = wire.size();
    Result<DecodedBiclusters> back = Error{};
    figures.decode_seconds = processor_seconds_of([&] { back = decode_biclusters(wire, kLimits); });
    if (!back || back->clusters != clusters) figures.mismatches += transfer_.nonzeros();
    const std::vector<uint32_t> errors = row_errors(transfer_, clusters);
    for (const uint32_t error : errors) figures.mismatches += error > options_.row_budget ? error : 0;
    const auto product = [&] { return product_by_clusters<uint32_t>(clusters, light()); };
    figures.transfer_seconds = median_seconds(options_.repetitions, [&] { keep(product()); });
    figures.mismatches += wrong_rows(product(), errors);
    return figures;
}

FormFigures Case::bits() const {
    FormFigures figures{"bits"};
    figures.resident_bytes = 4 * tile_.words.size() + uint64_t{2} * tile_.frames.size() * sample_count(tile_.side);
    for (const uint32_t word : tile_.words) figures.flops += static_cast<uint64_t>(std::popcount(word));
    std::vector<VisibilityStep> steps;
    figures.encode_seconds = processor_seconds_of([&] { steps = encode_visibility(tile_); });
    std::vector<std::span<const std::byte>> wire;
    for (const VisibilityStep& step : steps) {
        figures.wire_bytes += step.bytes.size();
        wire.emplace_back(step.bytes);
    }
    Result<VisibilityTile> back = Error{};
    figures.decode_seconds = processor_seconds_of([&] { back = decode_visibility(frames_of(tile_), wire, kLimits); });
    figures.mismatches += back ? differing_entries(make_transfer(*back, local_), transfer_) : transfer_.nonzeros();
    time(figures, [&] { return product_by_bits<uint32_t>(tile_, local_.count(), tables_, light()); });
    return figures;
}

/// The words of a tile's layer by way of the wire, figures of which come out; empty where something fails.
std::vector<uint32_t> layer_words(const RadianceSample& sample, uint32_t local_side, FormFigures& figures) {
    const RadianceTile tile{sample.spacing_log2, sample.places, sample.visibility};
    Result<std::vector<RadianceLayerStep>> steps = Error{};
    figures.encode_seconds = processor_seconds_of([&] { steps = encode_radiance_layer(tile, local_side, 0); });
    if (!steps) return {};
    std::vector<std::span<const std::byte>> wire;
    uint64_t decoded_bytes = 0;
    for (const RadianceLayerStep& step : *steps) {
        figures.wire_bytes += step.wire.size();
        decoded_bytes += step.decoded_bytes;
        wire.emplace_back(step.wire);
    }
    Result<std::vector<uint32_t>> words = Error{};
    figures.decode_seconds =
        processor_seconds_of([&] { words = decode_radiance_layer(wire, decoded_bytes, MatrixForm::kRows); });
    const double all =
        processor_seconds_of([&] { words = decode_radiance_layer(wire, decoded_bytes, MatrixForm::kBiclusters); });
    figures.search_seconds = std::max(0.0, all - figures.decode_seconds);
    if (!words) return {};
    return std::move(*words);
}

/// The same of a mesh, whose vertices and normals travel with it: the matrix alone.
std::vector<uint32_t> matrix_words(const RadianceSample& sample, const LocalDirections& local, SeedingChoice seeding,
                                   FormFigures& figures) {
    std::vector<VisibilityStep> steps;
    figures.encode_seconds = processor_seconds_of([&] { steps = encode_visibility(sample.visibility); });
    std::vector<std::span<const std::byte>> wire;
    for (const VisibilityStep& step : steps) {
        figures.wire_bytes += step.bytes.size();
        wire.emplace_back(step.bytes);
    }
    DistinctRows distinct;
    bool decoded = false;
    figures.decode_seconds = processor_seconds_of([&] {
        const auto back = decode_visibility(frames_of(sample.visibility), wire, kLimits);
        decoded = back.ok();
        if (back) distinct = distinct_rows(make_transfer(*back, local));
    });
    if (!decoded) return {};
    std::vector<uint32_t> words;
    figures.search_seconds = processor_seconds_of([&] {
        words = make_resident_radiance(search_biclusters(distinct.rows, seeding, 0), distinct.row_of, local.count());
    });
    return words;
}

FormFigures Case::layer_default() const {
    FormFigures figures{"default"};
    const bool is_tile = !sample_.places.empty();
    const std::vector<uint32_t> words = is_tile ? layer_words(sample_, options_.local_side, figures)
                                                : matrix_words(sample_, local_, options_.seeding, figures);
    figures.resident_bytes = 4 * words.size();
    std::span<const uint32_t> matrix = words;
    if (is_tile) {
        const auto layer = RadianceLayerView::create(words);
        matrix = layer ? layer->matrix() : std::span<const uint32_t>{};
    }
    const auto view = ResidentRadianceView::create(matrix);
    if (!view) {
        figures.mismatches = transfer_.nonzeros();
        return figures;
    }
    // Sum of W(B) = r + 2l - 1.
    figures.flops =
        view->link_start(view->rows()) + 2 * uint64_t{view->term_start(view->clusters())} - view->clusters();
    figures.transfer_seconds = median_seconds(options_.repetitions, [&] { keep(view->product<uint32_t>(light())); });
    const std::vector<Whole> rows = view->product<uint32_t>(light());
    std::vector<Whole> all;
    for (uint32_t r = 0; r < view->receivers(); ++r) {
        for (uint32_t j = 0; j < local_.count(); ++j) all.push_back(rows[view->row_of(r, j)]);
    }
    figures.mismatches += wrong_rows(all);
    return figures;
}

void add(FormFigures& sum, const FormFigures& more) {
    sum.name = more.name;
    sum.resident_bytes += more.resident_bytes;
    sum.wire_bytes += more.wire_bytes;
    sum.flops += more.flops;
    sum.search_seconds += more.search_seconds;
    sum.encode_seconds += more.encode_seconds;
    sum.decode_seconds += more.decode_seconds;
    sum.transfer_seconds += more.transfer_seconds;
    sum.mismatches += more.mismatches;
}

}  // namespace

codec::radiance::Biclusters search_biclusters(const codec::radiance::Transfer& transfer, SeedingChoice seeding,
                                              uint32_t row_budget) {
    if (seeding == SeedingChoice::kBest) {
        Biclusters entry = search_biclusters(transfer, SeedingChoice::kEntry, row_budget);
        Biclusters row = search_biclusters(transfer, SeedingChoice::kRow, row_budget);
        return row.flops() < entry.flops() ? std::move(row) : std::move(entry);
    }
    BiclusterOptions options;
    options.seeding = seeding == SeedingChoice::kRow ? Seeding::kRow : Seeding::kEntry;
    options.row_budget = row_budget;
    return find_biclusters(transfer, options);
}

TransferFigures measure_forms(std::span<const RadianceSample> samples, const FormOptions& options) {
    const LocalDirections local(options.local_side);
    using Measure = FormFigures (Case::*)() const;
    constexpr std::array<Measure, kFormNames.size()> kMeasures = {&Case::dense,     &Case::csr,  &Case::rowdedupe,
                                                                  &Case::bicluster, &Case::bits, &Case::layer_default};
    TransferFigures figures;
    std::array<FormFigures, kFormNames.size()> sums;
    const auto is_wanted = [&](std::string_view name) {
        return std::find(options.forms.begin(), options.forms.end(), name) != options.forms.end();
    };
    for (const RadianceSample& sample : samples) {
        const Case one(sample, local, options);
        figures.receivers += sample.visibility.receivers();
        figures.nonzeros += one.transfer().nonzeros();
        figures.transfer_seconds += one.transfer_seconds();
        for (size_t i = 0; i < kMeasures.size(); ++i) {
            if (is_wanted(kFormNames[i])) add(sums[i], (one.*kMeasures[i])());
        }
    }
    for (size_t i = 0; i < sums.size(); ++i) {
        if (is_wanted(kFormNames[i])) figures.forms.push_back(std::move(sums[i]));
    }
    return figures;
}

}  // namespace citystream::bench
