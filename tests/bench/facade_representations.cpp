#include "tests/bench/facade_representations.h"

#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>

#include "codec/bits/zstd_frame.h"
#include "codec/facade/binary_map.h"
#include "codec/facade/facade_form.h"
#include "codec/facade/facade_wire.h"
#include "codec/facade/free_boxes.h"
#include "codec/facade/raw_map.h"
#include "codec/facade/singular_value_map.h"
#include "tests/bench/facade_archivers.h"
#include "tests/bench/measure.h"
#include "tests/shaders/facade_on_cpu.h"

namespace citystream::bench {

namespace {

using codec::facade::FacadeForm;
using codec::facade::FacadeMatrices;
using codec::facade::FreeBox;
using codec::facade::RunGrid;
using Words = std::vector<uint32_t>;

constexpr double kDegrees[] = {0, 15, 30, 45, 60, 70, 80, 85};
constexpr int kRaysAnAngle = 2500;  // 20,000 a map
constexpr int kLookups = 20000;
constexpr const char* kArchivers[] = {"png", "zstd", "xz"};

/// What is compared with: the matrices, texel by texel, and the box of every cell.
struct Truth {
    explicit Truth(const BenchFacade& facade)
        : name(facade.name), grid(facade.grid), matrices(expand(facade.grid)), boxes(grow_free_boxes(facade.grid)) {}
    uint32_t label(uint64_t texel) const {
        return codec::facade::make_label(matrices.displacement_mm[texel], matrices.material[texel]);
    }
    std::string name;
    const RunGrid& grid;
    FacadeMatrices matrices;
    codec::facade::FreeBoxes boxes;
};

RepresentationRow row_of(const Truth& truth, const std::string& representation, const std::string& map = "") {
    RepresentationRow row;
    row.facade = truth.name;
    row.representation = row.form = representation;
    row.map = map;
    row.rows = truth.matrices.height;
    row.columns = truth.matrices.width;
    return row;
}

/// Texels whose decoded displacement or material is another.
uint64_t differing_texels(const Truth& truth, const Words& words) {
    const auto grid = codec::facade::decode_form(words);
    if (!grid) return truth.matrices.material.size();
    const FacadeMatrices back = expand(*grid);
    if (back.width != truth.matrices.width || back.height != truth.matrices.height)
        return truth.matrices.material.size();
    uint64_t differing = 0;
    for (size_t i = 0; i < back.material.size(); ++i) {
        differing += back.displacement_mm[i] != truth.matrices.displacement_mm[i] ||
                             back.material[i] != truth.matrices.material[i]
                         ? 1
                         : 0;
    }
    return differing;
}

/// Texels whose free box is another, of forms that have boxes. A is constant on cells; all texels of a cell are looked
/// up.
uint64_t differing_boxes(const Truth& truth, const Words& words) {
    FreeBox (*box)(std::span<const uint32_t>, uint32_t, uint32_t) = nullptr;
    const FacadeForm form = codec::facade::read_form_head(words)->form;
    if (form == FacadeForm::kRaw) box = codec::facade::raw_box;
    if (form == FacadeForm::kSvd) box = codec::facade::singular_value_box;
    if (form == FacadeForm::kBinary) box = codec::facade::binary_box;
    uint64_t differing = 0;
    for (uint32_t row = 0; box != nullptr && row < truth.grid.rows(); ++row) {
        for (uint32_t column = 0; column < truth.grid.columns(); ++column) {
            const uint32_t index = truth.boxes.box_index[size_t{row} * truth.grid.columns() + column];
            const FreeBox& right = truth.boxes.boxes[index];
            for (uint32_t y = truth.grid.y_breaks[row]; y < truth.grid.y_breaks[row + 1]; ++y) {
                for (uint32_t x = truth.grid.x_breaks[column]; x < truth.grid.x_breaks[column + 1]; ++x)
                    differing += box(words, x, y) == right ? 0 : 1;
            }
        }
    }
    return differing;
}

/// Loads of a lookup, over random texels; their labels are compared, too.
void count_lookups(const Truth& truth, const Words& words, RepresentationRow& row) {
    shaders_test::ShaderCost cost;
    std::mt19937 random(1);
    for (int i = 0; i < kLookups; ++i) {
        const auto x = static_cast<uint32_t>(random() % row.columns), y = static_cast<uint32_t>(random() % row.rows);
        const uint32_t label = shaders_test::lookup_on_cpu(words, x, y, &cost);
        row.mismatches += label == truth.label(uint64_t{y} * row.columns + x) ? 0 : 1;
    }
    row.loads_per_lookup = static_cast<double>(cost.loads) / kLookups;
}

void count_rays(const Truth& truth, const Words& words, RepresentationRow& row) {
    const auto renderer = shaders_test::exact_renderer_of(codec::facade::read_form_head(words)->form);
    shaders_test::ShaderCost cost;
    std::mt19937 random(1);
    const auto part = [&] { return static_cast<double>(random()) / 4294967296.0; };
    const double top = truth.grid.depths().max_mm;
    for (const double degrees : kDegrees) {
        const double tilt = degrees * std::numbers::pi / 180;
        for (int i = 0; i < kRaysAnAngle; ++i) {
            const double turn = 2 * std::numbers::pi * part();
            const double x = part() * row.columns, y = part() * row.rows;
            const float origin[3] = {static_cast<float>(x), static_cast<float>(y), static_cast<float>(top)};
            // A texel is 10 mm: u and v go in texels, w in millimetres.
            const float direction[3] = {static_cast<float>(std::sin(tilt) * std::cos(turn) / 10),
                                        static_cast<float>(std::sin(tilt) * std::sin(turn) / 10),
                                        static_cast<float>(-std::cos(tilt))};
            shaders_test::cast_on_cpu(renderer, words, origin, direction, 0, 0, &cost);
        }
    }
    row.loads_per_ray = static_cast<double>(cost.loads) / (kRaysAnAngle * static_cast<double>(std::size(kDegrees)));
}

void measure_words(const Truth& truth, const Words& words, RepresentationRow& row) {
    row.form = codec::facade::form_name(codec::facade::read_form_head(words)->form);
    row.resident_bytes = 4 * words.size();
    row.mismatches += differing_texels(truth, words);
    count_lookups(truth, words, row);
}

/// Words that the wire expands to, or zstd where there is no wire form.
void measure_wire(const Words& words, RepresentationRow& row) {
    const FacadeForm form = codec::facade::read_form_head(words)->form;
    if (form != FacadeForm::kPatch && form != FacadeForm::kQuotient && form != FacadeForm::kTiled) {
        row.wire_bytes = codec::bits::compress_frame(std::as_bytes(std::span(words))).size();
        return;
    }
    const std::vector<std::byte> wire = codec::facade::encode_wire(words);
    const auto back = codec::facade::expand_wire(wire, 4 * words.size());
    row.wire_bytes = wire.size();
    if (!back || *back != words) row.mismatches += uint64_t{row.rows} * row.columns;
}

uint64_t terms_of(const Words& words) {
    codec::facade::FactorTerms terms;
    const FacadeForm form = codec::facade::read_form_head(words)->form;
    if (form == FacadeForm::kSvd) terms = codec::facade::singular_value_terms(words);
    if (form == FacadeForm::kBinary) terms = codec::facade::binary_terms(words);
    return uint64_t{terms.displacement} + terms.material + terms.box_index;
}

using Encode = std::function<Result<Words>(const RunGrid&)>;

/// A row of a form; of a form that refuses the facade, what it falls back to.
RepresentationRow form_row(const Truth& truth, const std::string& name, const Encode& encode, bool casts = true,
                           const std::string& map = "") {
    RepresentationRow row = row_of(truth, name, map);
    Result<Words> words = Words();
    row.encode_s = seconds_of([&] { words = encode(truth.grid); });
    if (!words) words = codec::facade::encode_raw_map(truth.grid);
    measure_words(truth, *words, row);
    measure_wire(*words, row);
    row.terms = terms_of(*words);
    if (!casts) return row;
    row.mismatches += differing_boxes(truth, *words);
    count_rays(truth, *words, row);
    return row;
}

RepresentationRow default_row(const Truth& truth) {
    RepresentationRow row = row_of(truth, "default");
    codec::facade::ShippedMap shipped;
    row.encode_s = seconds_of([&] { shipped = codec::facade::encode_shipped_map(truth.grid); });
    measure_words(truth, shipped.words, row);
    row.wire_bytes = shipped.wire.size();
    const auto back = codec::facade::expand_wire(shipped.wire, row.resident_bytes);
    if (!back || *back != shipped.words) row.mismatches += truth.matrices.material.size();
    count_rays(truth, shipped.words, row);
    return row;
}

PlainMatrix box_matrix(const Truth& truth) {
    std::vector<uint32_t> entries;
    for (uint32_t row = 0; row < truth.grid.rows(); ++row) {
        const size_t begin = entries.size();
        for (uint32_t column = 0; column < truth.grid.columns(); ++column)
            entries.insert(entries.end(), truth.grid.x_breaks[column + 1] - truth.grid.x_breaks[column],
                           truth.boxes.box_index[size_t{row} * truth.grid.columns() + column]);
        const std::vector<uint32_t> line(entries.begin() + static_cast<std::ptrdiff_t>(begin), entries.end());
        for (uint32_t y = truth.grid.y_breaks[row] + 1; y < truth.grid.y_breaks[row + 1]; ++y)
            entries.insert(entries.end(), line.begin(), line.end());
    }
    return index_matrix(truth.matrices.width, truth.matrices.height, entries);
}

void add_archived(RepresentationRow& row, const std::string& archiver, const PlainMatrix& matrix) {
    const Archived archived = archive(archiver, matrix);
    row.wire_bytes += archived.bytes;
    row.resident_bytes += matrix.bytes.size();
    row.mismatches += archived.mismatches;
    row.encode_s += archived.seconds;
}

struct NamedForm {
    const char* name;
    Encode encode;
};

std::vector<NamedForm> forms() {
    using codec::facade::BinaryVariant;
    const auto of = [](FacadeForm form) { return [form](const RunGrid& g) { return encode_form(form, g); }; };
    return {{"svd", of(FacadeForm::kSvd)},
            {"binary", of(FacadeForm::kBinary)},
            {"binary-shared", [](const RunGrid& g) { return encode_binary_map(g, BinaryVariant::kShared); }},
            {"max-mip", of(FacadeForm::kMaxMip)},
            {"quotient", of(FacadeForm::kQuotient)},
            {"tiled", of(FacadeForm::kTiled)},
            {"patch", of(FacadeForm::kPatch)}};
}

/// A facade of which only one matrix is left; of A, its index as a label.
BenchFacade only(const Truth& truth, char map) {
    BenchFacade facade{truth.name, truth.grid};
    for (size_t i = 0; i < facade.grid.labels.size(); ++i) {
        uint32_t& label = facade.grid.labels[i];
        const int32_t depth = codec::facade::displacement_of(label);
        const uint32_t material = codec::facade::material_of(label), box = truth.boxes.box_index[i];
        if (map == 'D') label = codec::facade::make_label(depth, 0);
        if (map == 'M') label = codec::facade::make_label(0, material);
        if (map == 'A') label = codec::facade::make_label(static_cast<int32_t>(box >> 16), box & 0xffffu);
    }
    facade.grid = merge_equal_runs(facade.grid);
    return facade;
}

/// Bytes of one matrix's factors, as the layouts place them: rows of X and Y, sigma.
uint64_t factor_bytes(const Truth& truth, const std::string& name, uint64_t terms) {
    const uint64_t lines = uint64_t{truth.matrices.width} + truth.matrices.height;
    if (name == "svd") return lines * 16 * ((terms + 3) / 4);
    return lines * 4 * ((terms + 31) / 32) + 4 * terms;
}

/// D, M and A of the paper's factors, from their terms; boxes are counted to A. They are verified together.
void add_split_factors(const Truth& truth, const std::string& name, const Encode& encode,
                       std::vector<RepresentationRow>& rows) {
    const auto words = encode(truth.grid);
    if (!words) return;
    const auto terms =
        name == "svd" ? codec::facade::singular_value_terms(*words) : codec::facade::binary_terms(*words);
    const uint64_t boxes = 8 * truth.boxes.boxes.size();
    const std::pair<const char*, uint64_t> maps[] = {
        {"D", terms.displacement}, {"M", terms.material}, {"A", terms.box_index}};
    for (const auto& [map, count] : maps) {
        RepresentationRow row = row_of(truth, name, map);
        row.terms = count;
        row.resident_bytes = row.wire_bytes = factor_bytes(truth, name, count) + (*map == 'A' ? boxes : 0);
        rows.push_back(row);
    }
}

void add_split_rows(const Truth& truth, std::vector<RepresentationRow>& rows) {
    const std::pair<const char*, PlainMatrix> matrices[] = {
        {"D", displacement_matrix(truth.matrices)}, {"M", material_matrix(truth.matrices)}, {"A", box_matrix(truth)}};
    for (const auto& [map, matrix] : matrices) {
        RepresentationRow raw = row_of(truth, "raw", map);
        raw.resident_bytes = raw.wire_bytes = matrix.bytes.size();
        rows.push_back(raw);
        for (const char* archiver : kArchivers) {
            rows.push_back(row_of(truth, archiver, map));
            add_archived(rows.back(), archiver, matrix);
        }
        const BenchFacade part = only(truth, *map);
        const Truth part_truth(part);
        for (const NamedForm& form : forms()) {
            const std::string name = form.name;
            if (name == "quotient" || name == "tiled" || name == "patch")
                rows.push_back(form_row(part_truth, name, form.encode, false, map));
        }
    }
    for (const NamedForm& form : forms()) {
        const std::string name = form.name;
        if (name == "svd" || name == "binary") add_split_factors(truth, name, form.encode, rows);
    }
}

}  // namespace

std::vector<RepresentationRow> measure_representations(const BenchFacade& facade, bool split) {
    const Truth truth(facade);
    std::vector<RepresentationRow> rows;
    rows.push_back(form_row(truth, "raw", [](const RunGrid& grid) { return codec::facade::encode_raw_map(grid); }));
    rows.back().wire_bytes = rows.back().resident_bytes;
    for (const char* archiver : kArchivers) {
        rows.push_back(row_of(truth, archiver));
        add_archived(rows.back(), archiver, displacement_matrix(truth.matrices));
        add_archived(rows.back(), archiver, material_matrix(truth.matrices));
    }
    for (const NamedForm& form : forms()) rows.push_back(form_row(truth, form.name, form.encode));
    rows.push_back(default_row(truth));
    if (split) add_split_rows(truth, rows);
    return rows;
}

ArchiveBytes archive_bytes(const BenchFacade& facade) {
    const Truth truth(facade);
    ArchiveBytes bytes;
    for (const PlainMatrix& matrix :
         {displacement_matrix(truth.matrices), material_matrix(truth.matrices), box_matrix(truth)})
        bytes.xz_all += archive("xz", matrix).bytes;
    const PlainMatrix joint = joint_matrix(truth.matrices);
    bytes.best_joint = std::min(archive("xz", joint).bytes, archive("zstd", joint).bytes);
    return bytes;
}

}  // namespace citystream::bench
