// Claim: what the radiance layer costs in each form that it can be kept and sent in, that all of them give the same
// light, and what cheaper approximations of it are worth.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <sstream>

#include "tests/bench/bench_program.h"
#include "tests/bench/number_option.h"
#include "tests/bench/radiance_forms.h"
#include "tests/bench/radiance_pictures.h"
#include "tests/bench/radiance_quality.h"
#include "tests/bench/radiance_samples.h"

namespace {

using namespace citystream;
using namespace citystream::bench;

constexpr const char* kClaim =
    "Each FILE, or spheres and the box city, as a radiance layer in each of its forms: a line each of {file, "
    "representation, receivers,\n"
    "directions, nnz, flop_ratio, resident_bytes, wire_bytes, precompute_s, transfer_ms, mismatches, ...}. Meshes "
    "(OBJ, "
    "PLY, STL) have\n"
    "receivers at their vertices and hide from themselves; cities have a lattice on surfaces, by tiles of 128 m.\n"
    "dense: a byte an entry; wire: zstd -3. csr: 3 bytes an entry; wire: rows by the range coder. rowdedupe: the same "
    "of "
    "distinct rows.\n"
    "bicluster: of all rows, 4 (r + 2l) bytes each as the paper's sizes imply; wire: the range coder. bits: "
    "visibility, "
    "a bit a sample.\n"
    "default: the layer, bits on the wire and biclusters of distinct rows in memory; of tiles with receivers' places "
    "and "
    "irradiance.\n"
    "directions: source texels; nnz: entries of the whole matrix; flop_ratio: over 2 nnz; precompute_s: rays, matrix "
    "and "
    "search, all cores\n"
    "for the rays, one thread's processor time for the rest; transfer_ms: processor time of one change of light, three "
    "channels, one thread; "
    "mismatches: entries\n"
    "that come back as others, and rows whose light is not that of the bits in fp64.\n"
    "--table paper: spheres beside Tables 1 and 2 of Sun et al. 2011; directions: its test of direction resolution; "
    "quality: irradiance\n"
    "at the receivers by the layer and by approximations, bytes (16-bit floats, zstd -19) and errors under several "
    "skies; with\n"
    "--pictures also of a tile's picture under the area light, against 24,576 sample directions from each pixel's "
    "place.";

struct Options {
    SampleOptions sample;
    FormOptions form;
    std::string table;
    std::string pictures;   ///< folder; empty: none are made
    uint32_t vertices = 0;  ///< 0: not said
};

constexpr uint32_t kVertices = 4000, kPaperVertices = 13000;

void print_line(const Json& line) {
    fmt::print("{}\n", line.dump(-1, ' ', false, Json::error_handler_t::replace));
    std::fflush(stdout);
}

/// Rows of a matrix have 24 bits.
bool fits(const RadianceSet& set, uint32_t local_side) {
    for (const RadianceSample& sample : set.samples) {
        if (uint64_t{sample.visibility.receivers()} * local_side * local_side >= 1U << 24) return false;
    }
    return true;
}

double precompute_seconds(const RadianceSet& set, const TransferFigures& transfer, const FormFigures& form) {
    const double matrix = form.name == "bits" ? 0 : transfer.transfer_seconds;
    return set.bake_seconds() + matrix + form.search_seconds;
}

double flop_ratio(const FormFigures& form, const TransferFigures& transfer) {
    return static_cast<double>(form.flops) / (2 * static_cast<double>(transfer.nonzeros));
}

Json json_of(const RadianceSet& set, const Options& options, const TransferFigures& transfer, const FormFigures& form) {
    const auto receivers = static_cast<double>(transfer.receivers);
    return {{"file", set.name},
            {"representation", form.name},
            {"receivers", transfer.receivers},
            {"directions", codec::radiance::texel_count(options.sample.texels_across)},
            {"nnz", transfer.nonzeros},
            {"flop_ratio", rounded(flop_ratio(form, transfer))},
            {"resident_bytes", form.resident_bytes},
            {"wire_bytes", form.wire_bytes},
            {"precompute_s", rounded(precompute_seconds(set, transfer, form))},
            {"transfer_ms", rounded(1e3 * form.transfer_seconds)},
            {"mismatches", form.mismatches},
            {"local_directions", options.form.local_side * options.form.local_side},
            {"tiles", set.samples.size()},
            {"resident_bytes_per_receiver", rounded(static_cast<double>(form.resident_bytes) / receivers)},
            {"wire_bytes_per_receiver", rounded(static_cast<double>(form.wire_bytes) / receivers)},
            {"bake_s", rounded(set.bake_seconds())},
            {"search_s", rounded(form.search_seconds)},
            {"encode_s", rounded(form.encode_seconds)},
            {"decode_s", rounded(form.decode_seconds)}};
}

void check_form(const RadianceSet& set, const FormFigures& form, BenchProgram& program) {
    program.check(form.mismatches == 0,
                  fmt::format("{}: {} gives what the bits give ({} mismatches)", set.name, form.name, form.mismatches));
}

bool check_set(const RadianceSet& set, const Options& options, BenchProgram& program) {
    return program.check(set.receivers() > 0, set.name + ": has a place for a receiver") &&
           program.check(fits(set, options.form.local_side),
                         set.name + ": has fewer than 2^24 rows a tile (less --vertices or a wider --lattice)");
}

void measure_set(const RadianceSet& set, const Options& options, BenchProgram& program) {
    if (!check_set(set, options, program)) return;
    const TransferFigures transfer = measure_forms(set.samples, options.form);
    for (const FormFigures& form : transfer.forms) {
        print_line(json_of(set, options, transfer, form));
        check_form(set, form, program);
    }
}

/// What a table is made of.
using Measure = std::function<void(const RadianceSet&, const Options&, BenchProgram&)>;

void measure_sample(const std::string& name, Result<RadianceSample>&& sample, const Options& options,
                    const Measure& measure, BenchProgram& program) {
    if (!program.check(sample.ok(), sample.ok() ? "" : name + ": " + sample.error().text())) return;
    RadianceSet set{name, {}};
    set.samples.push_back(std::move(*sample));
    measure(set, options, program);
}

void measure_file(const std::string& path, const Options& options, const Measure& measure, BenchProgram& program) {
    const std::string name = std::filesystem::path(path).filename().string();
    const auto source = read_mesh_file(path);
    if (!program.check(source.ok(), source.ok() ? "" : source.error().text())) return;
    if (source->buildings == 0) {
        measure_sample(name, bake_vertices(*source, options.sample), options, measure, program);
        return;
    }
    auto samples = bake_city_tiles(*source, options.sample);
    if (!program.check(samples.ok(), samples.ok() ? "" : name + ": " + samples.error().text())) return;
    measure({name, std::move(*samples)}, options, program);
}

void measure_made_up(const Options& options, const Measure& measure, BenchProgram& program) {
    constexpr uint32_t kFew = 500;
    measure({"sphere", {open_sphere(kFew, options.sample.texels_across)}}, options, program);
    measure_sample("bumpy-sphere", bake_vertices(bumpy_sphere(kFew), options.sample), options, measure, program);
    measure_sample("box-city", bake_box_city(false, options.sample), options, measure, program);
    measure_sample("box-city-turned", bake_box_city(true, options.sample), options, measure, program);
}

/// A model of the paper's Tables 1 and 2.
struct PaperModel {
    const char* name;
    uint32_t vertices;
    double nnz_millions, flop_percent, megabytes, precompute_minutes, transfer_ms;
};
constexpr std::array<PaperModel, 3> kPaperModels = {{{"Bunny", 3286, 10.6, 27.4, 24.2, 12, 7.5},
                                                     {"Bunny 12k", 12380, 39.2, 27.0, 84.1, 49, 22.3},
                                                     {"Bunny 48k", 47960, 151.3, 26.7, 316.9, 279, 63.4}}};

/// Biclusters of one shape with more and more vertices.
class VertexScaling {
  public:
    void add(const std::string& shape, const FormFigures& form, const TransferFigures& transfer) {
        if (form.name != "bicluster") return;
        costs_[shape].ratios.push_back(flop_ratio(form, transfer));
        costs_[shape].bytes.push_back(static_cast<double>(form.resident_bytes) /
                                      static_cast<double>(transfer.receivers));
    }
    /// Work and bytes a vertex differ by less than 15 %; an open sphere's work is below the prototype's.
    void check(BenchProgram& program) const {
        for (const auto& [shape, cost] : costs_) {
            for (const auto* values : {&cost.ratios, &cost.bytes}) {
                const Spread spread = spread_of(*values);
                program.check(spread.max < 1.15 * spread.min, shape + ": costs a vertex grow evenly");
            }
            program.check(shape != "sphere" || spread_of(cost.ratios).max <= 0.29, shape + ": 29 % of the operations");
        }
    }

  private:
    struct Costs {
        std::vector<double> ratios, bytes;
    };
    std::map<std::string, Costs> costs_;
};

void print_paper_row(const RadianceSet& set, const PaperModel& paper, const Options& options, VertexScaling& scaling,
                     BenchProgram& program) {
    if (!check_set(set, options, program)) return;
    const TransferFigures transfer = measure_forms(set.samples, options.form);
    const auto receivers = static_cast<double>(transfer.receivers);
    for (const FormFigures& form : transfer.forms) {
        const double bytes = static_cast<double>(form.resident_bytes);
        const double minutes = precompute_seconds(set, transfer, form) / 60;
        program.print({{"table", "paper"},
                       {"paper_model", paper.name},
                       {"file", set.name},
                       {"representation", form.name},
                       {"vertices", transfer.receivers},
                       {"paper_vertices", paper.vertices},
                       {"nnz_millions", rounded(static_cast<double>(transfer.nonzeros) / 1e6)},
                       {"paper_nnz_millions", paper.nnz_millions},
                       {"flop_percent", rounded(100 * flop_ratio(form, transfer))},
                       {"paper_flop_percent", paper.flop_percent},
                       {"megabytes", rounded(bytes / 1e6)},
                       {"paper_megabytes", paper.megabytes},
                       {"bytes_per_vertex", rounded(bytes / receivers)},
                       {"paper_bytes_per_vertex", rounded(1e6 * paper.megabytes / paper.vertices)},
                       {"wire_bytes_per_vertex", rounded(static_cast<double>(form.wire_bytes) / receivers)},
                       {"precompute_minutes", rounded(minutes)},
                       {"paper_precompute_minutes", paper.precompute_minutes},
                       {"paper_over_our_minutes", rounded(paper.precompute_minutes / minutes)},
                       {"transfer_cpu_ms", rounded(1e3 * form.transfer_seconds)},
                       {"paper_transfer_gpu_ms", paper.transfer_ms}});
        check_form(set, form, program);
        scaling.add(set.name, form, transfer);
    }
}

void print_paper_table(Options options, BenchProgram& program) {
    if (options.form.forms.size() == kFormNames.size()) options.form.forms = {"bicluster", "bits", "default"};
    VertexScaling scaling;
    for (const PaperModel& paper : kPaperModels) {
        if (paper.vertices > options.sample.most_receivers) {
            program.print_skipped(fmt::format("{}: {} vertices, --vertices allows {}", paper.name, paper.vertices,
                                              options.sample.most_receivers));
            continue;
        }
        print_paper_row({"sphere", {open_sphere(paper.vertices, options.sample.texels_across)}}, paper, options,
                        scaling, program);
        const Measure measure = [&](const RadianceSet& set, const Options& o, BenchProgram& p) {
            print_paper_row(set, paper, o, scaling, p);
        };
        measure_sample("bumpy-sphere", bake_vertices(bumpy_sphere(paper.vertices), options.sample), options, measure,
                       program);
    }
    scaling.check(program);
}

/// The paper's figures of its test of direction resolution: megabytes and minutes.
struct PaperDirections {
    uint32_t local_side;
    double megabytes, minutes, transfer_ms;
};
constexpr std::array<PaperDirections, 3> kPaperDirections = {
    {{8, 24.2, 12, 7.9}, {16, 38.3, 32, 22.4}, {32, 58.5, 93, 37.0}}};

void print_directions(const RadianceSet& set, const Options& given, BenchProgram& program) {
    Options options = given;
    options.form.forms = {"bicluster"};
    double first_bytes = 0, first_minutes = 0;
    for (const PaperDirections& paper : kPaperDirections) {
        options.form.local_side = paper.local_side;
        if (!check_set(set, options, program)) return;
        const TransferFigures transfer = measure_forms(set.samples, options.form);
        const FormFigures& form = transfer.forms.front();
        const auto bytes = static_cast<double>(form.resident_bytes);
        const double minutes = precompute_seconds(set, transfer, form) / 60;
        if (first_bytes == 0) {
            first_bytes = bytes;
            first_minutes = minutes;
        }
        program.print({{"table", "directions"},
                       {"file", set.name},
                       {"local_directions", paper.local_side * paper.local_side},
                       {"receivers", transfer.receivers},
                       {"nnz", transfer.nonzeros},
                       {"megabytes", rounded(bytes / 1e6)},
                       {"wire_bytes", form.wire_bytes},
                       {"bytes_to_first", rounded(bytes / first_bytes)},
                       {"paper_bytes_to_first", rounded(paper.megabytes / kPaperDirections[0].megabytes)},
                       {"precompute_minutes", rounded(minutes)},
                       {"minutes_to_first", rounded(minutes / first_minutes)},
                       {"paper_minutes_to_first", rounded(paper.minutes / kPaperDirections[0].minutes)},
                       {"transfer_cpu_ms", rounded(1e3 * form.transfer_seconds)},
                       {"paper_transfer_gpu_ms", paper.transfer_ms}});
        check_form(set, form, program);
    }
}

constexpr uint32_t kPictureWidth = 480, kPictureHeight = 270;

/// Pictures of a set's first tile, and how far they are off: by representation.
class QualityPictures {
  public:
    QualityPictures(const RadianceSet& set, const Options& options, BenchProgram& program)
        : prefix_(options.pictures + "/" + set.name), program_(program) {
        if (options.pictures.empty() || set.samples.front().places.empty()) return;
        std::filesystem::create_directories(options.pictures);
        auto picture = TilePicture::create(set.samples.front(), kPictureWidth, kPictureHeight);
        if (!program.check(picture.ok(), picture.ok() ? "" : set.name + ": " + picture.error().text())) return;
        picture->cast_rays(area_light(options.sample.texels_across));
        picture_ = std::move(*picture);
        keep_picture(picture_->by_rays(), "rays");
    }

    AreaLightListener listener() {
        if (!picture_) return {};
        return [this](const QualityLine& line, std::span<const client::LightSum> irradiance) {
            const PixelLight light = picture_->between_receivers(irradiance);
            differences_[line.representation] = picture_->difference(light);
            keep_picture(light, fmt::format("{}_{}_bytes", line.representation, line.bytes));
        };
    }

    void add_fields(const QualityLine& line, Json& fields) const {
        const auto found = differences_.find(line.representation);
        if (found == differences_.end()) return;
        fields["picture_rmse"] = rounded(found->second.rmse);
        fields["picture_psnr_db"] = rounded(found->second.psnr_db);
    }

    /// Those of the paper, and whatever takes as many bytes as the layer, are further from the truth.
    void check_ranks(std::span<const QualityLine> lines) {
        const auto layer = differences_.find("layer-3");
        if (layer == differences_.end()) return;
        for (const QualityLine& line : lines) {
            const std::string& name = line.representation;
            const bool is_paper = name == "sh-25" || name == "haar-12" || name == "cpca-32x8";
            const bool is_other = name != "bits" && !name.starts_with("layer") && !name.starts_with("bicluster");
            if (!is_paper && !(is_other && line.beside == "equal bytes")) continue;
            program_.check(differences_[name].rmse > layer->second.rmse,
                           prefix_ + ": the layer's picture is nearer to the truth than that of " + name);
        }
    }

  private:
    void keep_picture(const PixelLight& light, const std::string& name) {
        const Status written = picture_->write_png(light, prefix_ + "_" + name + ".png");
        program_.check(written.ok(), written.ok() ? "" : written.error().text());
    }

    std::string prefix_;
    BenchProgram& program_;
    std::optional<TilePicture> picture_;
    std::map<std::string, TilePicture::Difference> differences_;
};

void print_quality(const RadianceSet& set, const Options& options, BenchProgram& program) {
    if (!check_set(set, options, program)) return;
    const auto skies = quality_skies(options.sample.texels_across);
    if (!program.check(skies.ok(), skies.ok() ? "" : skies.error().text())) return;
    QualityPictures pictures(set, options, program);
    const auto lines = measure_quality(set, *skies, options.form.local_side, pictures.listener());
    pictures.check_ranks(lines);
    for (const QualityLine& line : lines) {
        Json fields{
            {"table", "quality"},
            {"file", set.name},
            {"representation", line.representation},
            {"bytes", line.bytes},
            {"bytes_per_receiver", rounded(static_cast<double>(line.bytes) / static_cast<double>(set.receivers()))}};
        for (const auto& [sky, error] : line.errors) fields["rmse_" + sky] = rounded(error);
        pictures.add_fields(line, fields);
        if (!line.beside.empty()) fields["compared"] = line.beside;
        program.print(fields);
        program.check(std::isfinite(line.worst_error()), set.name + ": " + line.representation + " is finite");
    }
}

bool take_forms(const std::string& text, std::vector<std::string>& forms) {
    forms.clear();
    std::istringstream names(text);
    for (std::string name; std::getline(names, name, ',');) {
        if (std::find(kFormNames.begin(), kFormNames.end(), name) == kFormNames.end()) return false;
        forms.push_back(name);
    }
    return !forms.empty();
}

bool take_seeding(const std::string& text, SeedingChoice& seeding) {
    seeding = text == "entry" ? SeedingChoice::kEntry : text == "row" ? SeedingChoice::kRow : SeedingChoice::kBest;
    return text == "entry" || text == "row" || text == "best";
}

std::vector<BenchOption> options_of(Options& options) {
    SampleOptions& sample = options.sample;
    FormOptions& form = options.form;
    return {{"--lattice", "metres between the receivers of a city, a power of two from 0.0625 to 64 (default 4)",
             [&](const std::string& text) {
                 int exponent = 0;
                 return take_number(text, 0.0625, 64.0, sample.lattice_metres) &&
                        std::frexp(sample.lattice_metres, &exponent) == 0.5;
             }},
            {"--directions", "texels on a side of the source's cube, 1 to 64 (default 32)",
             [&](const std::string& text) {
                 return take_number(text, 1U, codec::radiance::kMostCubeSide, sample.texels_across);
             }},
            {"--local-directions", "on a side of a receiver's square of directions, 1 to 32 (default 8)",
             [&](const std::string& text) {
                 return take_number(text, 1U, codec::radiance::kMostLocalSide, form.local_side);
             }},
            {"--lossy", "quarters that `bicluster` may miss of a row (default 0: exact)",
             [&](const std::string& text) { return take_number(text, 0U, 1U << 20, form.row_budget); }},
            {"--tiles", "of a city, 1 to 10000 (default 4)",
             [&](const std::string& text) { return take_number(text, 1U, 10000U, sample.tiles); }},
            {"--vertices", "of a mesh that are receivers at most, 1 to 200000 (default 4000; --table paper 13000)",
             [&](const std::string& text) { return take_number(text, 1U, 200000U, options.vertices); }},
            {"--seeding", "of biclusters: entry, row or best (default best)",
             [&](const std::string& text) { return take_seeding(text, form.seeding); }},
            {"--representations", "names with commas between them (default all)",
             [&](const std::string& text) { return take_forms(text, form.forms); }},
            {"--table", "paper, directions or quality",
             [&](const std::string& text) {
                 options.table = text;
                 return text == "paper" || text == "directions" || text == "quality";
             }},
            {"--pictures", "folder for pictures of --table quality: a tile by each approximation, and by rays",
             [&](const std::string& text) {
                 options.pictures = text;
                 return !text.empty();
             }}};
}

void measure_all(const BenchOptions& given, const Options& options, const Measure& measure, BenchProgram& program) {
    if (given.files.empty()) measure_made_up(options, measure, program);
    for (const auto& file : given.files) measure_file(file, options, measure, program);
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    BenchDescription description{"bench_radiance", kClaim, "mesh.ply city.city.jsonl"};
    description.generates = false;
    description.options = options_of(options);
    BenchProgram program(description);
    BenchOptions given;
    given.repetitions = 5;
    if (!program.read_arguments(argc, argv, given)) return program.exit_code();
    options.form.repetitions = given.repetitions;
    options.sample.most_receivers = options.vertices > 0       ? options.vertices
                                    : options.table == "paper" ? kPaperVertices
                                                               : kVertices;
    if (options.table == "paper")
        print_paper_table(options, program);
    else if (options.table == "directions")
        measure_all(given, options, print_directions, program);
    else if (options.table == "quality")
        measure_all(given, options, print_quality, program);
    else
        measure_all(given, options, measure_set, program);
    return program.exit_code();
}
