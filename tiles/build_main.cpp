// citystream-build: a city model to one archive; see README.md for its calls.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "codec/atlas/page_layout.h"
#include "command_line/command_line.h"
#include "tiles/city/city_input.h"
#include "tiles/city/generator.h"
#include "tiles/city/generator_walls.h"
#include "tiles/layers/build_city.h"
#include "tiles/layers/inspect_city.h"
#include "tiles/layers/memory_plan.h"

namespace {

using namespace citystream;
using namespace citystream::tiles;

using command_line::kFailed, command_line::kWrongUsage;
constexpr size_t kDefectsShown = 20;

std::atomic<bool> interrupted = false;

extern "C" void on_signal(int /*signal*/) {
    interrupted = true;
}

struct Arguments {
    std::vector<std::string> inputs;
    std::string output, reference, report, lod, ground = "auto", memory = "2GiB", layers = "mesh,facade,atlas", archive;
    uint32_t jobs = 0;
    city::GeneratorOptions generator;
    std::string origin = "0,0", texture_law = layers::to_string(layers::BuildOptions().texture_law),
                saliency = codec::atlas::to_string(layers::BuildOptions().saliency);
    std::vector<std::string> aerial;
    std::optional<uint64_t> dress_seed;
    bool no_extract_relief = false;
    std::string atlas_form = "charts";
    std::optional<std::string> shared_charts;  ///< not given: what goes with the form
    uint32_t merge_tolerance_mm = 0, rate_distortion = layers::BuildOptions().rate_distortion;
    std::string mesh_transport{layers::kMeshTransportNames[0]}, mesh_topology{layers::kMeshTopologyNames[0]},
        precision{layers::kPositionPrecisionNames[0]};
    uint32_t normal_bits = layers::MeshForm().normal_bits;
    std::string mesh_steps = "auto";
    std::optional<std::string> page_mips, page_shape;               ///< of pages; not given: what BuildOptions has
    std::optional<uint32_t> lattice, directions, local_directions;  ///< of radiance; not given: what BuildOptions has
    std::optional<double> radiance_error;
    std::optional<std::string> radiance_transport;
    bool rebake = false;
    bool json = false;
};

/// An error about a file, which its text may or may not name.
std::string about(const std::string& path, const Error& error) {
    const std::string text = error.text();
    return text.starts_with(path) ? text : path + ": " + text;
}

int fail(const std::string& what, int code = kFailed) {
    fmt::print(stderr, "citystream-build: {}\n", what);
    return code;
}

/// "2GiB", "512MiB", "1000000" to bytes.
std::optional<uint64_t> parse_bytes(const std::string& text) {
    size_t used = 0;
    double value = 0;
    try {
        value = std::stod(text, &used);
    } catch (const std::exception&) {
        return std::nullopt;
    }
    const std::string unit = text.substr(used);
    double scale = 0;
    if (unit.empty() || unit == "B") scale = 1;
    if (unit == "KiB" || unit == "K") scale = 1024.0;
    if (unit == "MiB" || unit == "M") scale = 1024.0 * 1024;
    if (unit == "GiB" || unit == "G") scale = 1024.0 * 1024 * 1024;
    if (scale == 0 || !(value > 0) || value * scale > 1e18) return std::nullopt;
    return static_cast<uint64_t>(value * scale);
}

std::optional<std::array<bool, tileset::kLayerCount>> parse_layers(const std::string& text) {
    std::array<bool, tileset::kLayerCount> layers{};
    std::istringstream list(text);
    for (std::string name; std::getline(list, name, ',');) {
        const auto found = std::find(tileset::kLayerNames.begin(), tileset::kLayerNames.end(), name);
        if (found == tileset::kLayerNames.end()) return std::nullopt;
        layers[static_cast<size_t>(found - tileset::kLayerNames.begin())] = true;
    }
    return layers[0] ? std::optional(layers) : std::nullopt;
}

std::optional<city::Vec2> parse_origin(const std::string& text) {
    city::Vec2 origin;
    char comma = 0, rest = 0;
    std::istringstream in(text);
    if (!(in >> origin.x >> comma >> origin.y) || comma != ',' || in >> rest) return std::nullopt;
    return origin;
}

/// "law" gives nothing.
Result<std::optional<uint32_t>> parse_page_mips(const std::string& text) {
    if (text == "law") return std::optional<uint32_t>();
    uint32_t mips = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), mips);
    if (error != std::errc() || end != text.data() + text.size() || mips > PAGES_MOST_MIPS)
        return Error{fmt::format("{} is neither law nor 0 to {}", text, PAGES_MOST_MIPS)};
    return std::optional(mips);
}

/// Draws one line on a terminal, nothing elsewhere.
class ProgressBar {
  public:
    void show(std::string_view stage, uint64_t done, uint64_t total) {
        const uint64_t percent = total == 0 ? 0 : 100 * done / total;
        if (!terminal_ || (stage == stage_ && percent == percent_)) return;
        stage_ = stage;
        percent_ = percent;
        const std::string bar(percent * 40 / 100, '#');
        fmt::print(stderr, "\r{:<8} [{:<40}] {:3}%", stage, bar, percent);
        shown_ = true;
    }
    void clear() {
        if (shown_) fmt::print(stderr, "\r{:60}\r", "");
        shown_ = false;
    }

  private:
    bool terminal_ = isatty(STDERR_FILENO) != 0, shown_ = false;
    std::string stage_;
    uint64_t percent_ = 101;
};

nlohmann::json report_json(const city::CityReport& report) {
    nlohmann::json defects = nlohmann::json::array();
    for (const city::Defect& defect : report.defects) {
        defects.push_back({{"feature", defect.feature},
                           {"what", defect.what},
                           {"where", defect.where},
                           {"dropped", defect.dropped_feature}});
    }
    return {{"features_read", report.features_read},      {"objects", report.objects_emitted},
            {"buildings", report.buildings_emitted},      {"triangles", report.triangles_emitted},
            {"defect_count", report.defect_count},        {"defects", std::move(defects)},
            {"dropped_features", report.dropped_features}};
}

bool write_report(const std::string& path, const city::CityReport& report) {
    std::ofstream file(path);
    // Ids come from the input and need not be valid UTF-8.
    file << report_json(report).dump(1, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
    return static_cast<bool>(file.flush());
}

void print_defects(const city::CityReport& report) {
    if (report.defect_count == 0) return;
    for (size_t i = 0; i < std::min(kDefectsShown, report.defects.size()); ++i) {
        const city::Defect& d = report.defects[i];
        fmt::print(stderr, "{}: {} ({}){}\n", d.dropped_feature ? "skipped" : "defect", d.what, d.feature,
                   d.where.empty() ? "" : " at " + d.where);
    }
    fmt::print(stderr, "{} defects, {} features skipped{}\n", report.defect_count, report.dropped_features.size(),
               report.defect_count > kDefectsShown ? " (all of them: --report FILE.json)" : "");
}

/// What was done to images, facades that were added or found, and light, as JSON; empty where there was nothing to do.
nlohmann::json work_json(const layers::BuildSummary& summary) {
    nlohmann::json out = nlohmann::json::object();
    if (summary.images) {
        const layers::ImagePreparationReport& r = *summary.images;
        out["images"] = {
            {"count", r.images},
            {"used", r.used},
            {"failed", r.failed},
            {"not_searched", r.not_searched},
            {"decoded_pixels", r.decoded_pixels},
            {"matched_pixels", r.matched_pixels},
            {"prepared_pixels", r.prepared_pixels},
            {"metric_calls", r.metric_calls},
            {"stored_bytes", r.stored_bytes},
            {"seconds", r.seconds},
            {"thread_seconds",
             {{"decode", r.decode_seconds},
              {"match", r.match_seconds},
              {"search", r.search_seconds},
              {"store", r.store_seconds}}},
            {"mpixel_per_second", r.seconds > 0 ? static_cast<double>(r.decoded_pixels) / 1e6 / r.seconds : 0},
            {"peak_bytes", r.peak_bytes}};
    }
    if (summary.dressing) {
        const layers::DressReport& r = *summary.dressing;
        out["dressing"] = {{"buildings", r.buildings},
                           {"dressed_buildings", r.dressed_buildings},
                           {"facades", r.facades},
                           {"facade_area", r.facade_area},
                           {"wall_area", r.wall_area},
                           {"walls", r.walls},
                           {"walls_small", r.walls_small},
                           {"walls_curved", r.walls_curved},
                           {"walls_shared", r.walls_shared},
                           {"walls_degenerate", r.walls_degenerate},
                           {"hidden_by_neighbours", r.hidden_by_neighbours},
                           {"pictures_covered", r.pictures_covered},
                           {"maps", r.maps}};
    }
    if (summary.relief) {
        const layers::ReliefExtractionReport& r = *summary.relief;
        out["relief"] = {{"buildings", r.buildings},
                         {"buildings_with_relief", r.buildings_with_relief},
                         {"candidate_planes", r.candidate_planes},
                         {"facades", r.facades},
                         {"facades_given_back", r.facades_given_back},
                         {"rays", r.rays},
                         {"rays_wrong", r.rays_wrong},
                         {"facade_area", r.facade_area},
                         {"triangles_before", r.triangles_before},
                         {"triangles_after", r.triangles_after},
                         {"triangles_hidden", r.triangles_hidden},
                         {"materials_merged", r.materials_merged},
                         {"textures_flattened", r.textures_flattened},
                         {"largest_error_metres", r.largest_error},
                         {"mean_error_metres", r.mean_error}};
    }
    if (summary.radiance) {
        const layers::RadianceReport& r = *summary.radiance;
        out["radiance"] = {{"tiles", r.tiles},
                           {"baked", r.baked},
                           {"reused", r.reused},
                           {"recoded", r.recoded},
                           {"transport", codec::radiance::name_of(r.transport)},
                           {"widened", r.widened},
                           {"left_out", r.left_out},
                           {"receivers_baked", r.receivers},
                           {"rays", r.rays},
                           {"seconds", r.seconds},
                           {"thread_seconds", {{"bake", r.bake_seconds}, {"encode", r.encode_seconds}}},
                           {"horizon_bytes", r.horizon_bytes}};
    }
    return out;
}

void print_radiance(const layers::BuildSummary& summary) {
    if (!summary.radiance) return;
    const layers::RadianceReport& r = *summary.radiance;
    fmt::print(
        "  lit      {:>12} tiles{}; {} receivers and {:.1f} million rays in {} that were baked, {} unchanged; "
        "{:.1f} s\n",
        r.tiles, r.left_out > 0 ? fmt::format(", {} left out", r.left_out) : "", r.receivers,
        static_cast<double>(r.rays) / 1e6, r.baked, r.reused, r.seconds);
}

void print_images(const layers::BuildSummary& summary) {
    if (!summary.images || summary.images->used == 0) return;
    const layers::ImagePreparationReport& r = *summary.images;
    const auto mega = [](uint64_t pixels) { return static_cast<double>(pixels) / 1e6; };
    fmt::print("  images   {:>12} of {} shown{}; {:.1f} Mpixel read, {:.1f} as fine as seen, {:.1f} kept; {:.1f} s\n",
               r.used - r.failed, r.images, r.failed > 0 ? fmt::format(", {} could not be read", r.failed) : "",
               mega(r.decoded_pixels), mega(r.matched_pixels), mega(r.prepared_pixels), r.seconds);
}

void print_facade_work(const layers::BuildSummary& summary) {
    if (summary.dressing) {
        const layers::DressReport& r = *summary.dressing;
        fmt::print("  dressed  {:>12} facades (made up) on {} of {} buildings, {:.0f} % of the area of their walls\n",
                   r.facades, r.dressed_buildings, r.buildings,
                   r.wall_area > 0 ? 100 * r.facade_area / r.wall_area : 0.0);
    }
    if (summary.relief && summary.relief->facades > 0) {
        const layers::ReliefExtractionReport& r = *summary.relief;
        fmt::print("  relief   {:>12} facades of {} buildings; {} of their {} triangles stay; error {:.3f} m at most\n",
                   r.facades, r.buildings_with_relief, r.triangles_after, r.triangles_before, r.largest_error);
    }
}

void print_summary(const layers::BuildSummary& summary, const Arguments& arguments) {
    const tileset::Manifest& m = summary.manifest;
    if (arguments.json) {
        nlohmann::json out = layers::manifest_json(m);
        out["archive_bytes"] = summary.archive_bytes;
        out["reference_bytes"] = summary.reference_bytes;
        out["seconds"] = summary.seconds;
        for (const layers::StageTime& time : summary.stages) {
            out["stages"].push_back(
                {{"stage", time.stage}, {"seconds", time.seconds}, {"processor_seconds", time.processor_seconds}});
        }
        out["peak_memory_bytes"] = summary.peak_memory_bytes;
        out["tiles_kept_in_charts"] = summary.tiles_kept_in_charts;
        out["defect_count"] = summary.report.defect_count;
        out["dropped_features"] = summary.report.dropped_features.size();
        out.update(work_json(summary));
        fmt::print("{}\n", out.dump(1, ' ', false, nlohmann::json::error_handler_t::replace));
        return;
    }
    fmt::print("{}: {} buildings, {} triangles, {} facades, {} tiles in {} levels\n", arguments.output, m.buildings,
               m.triangles, m.facades, m.tiles, m.levels);
    for (size_t layer = 0; layer < tileset::kLayerCount; ++layer) {
        if (!m.has_layer[layer]) continue;
        fmt::print("  {:<8} {:>12} bytes on the wire, {:>12} decoded\n", tileset::kLayerNames[layer],
                   m.wire_bytes[layer], m.decoded_bytes[layer]);
    }
    print_images(summary);
    print_facade_work(summary);
    print_radiance(summary);
    if (m.shared_chart_count > 0) {
        fmt::print("  charts   {:>12} bytes of {} that tiles share\n", m.chart_index_bytes + m.chart_levels_bytes,
                   m.shared_chart_count);
    }
    if (summary.tiles_kept_in_charts > 0) {
        fmt::print("  pages    {:>12} of {} tiles keep their pictures in charts of their own: pages hold no alpha\n",
                   summary.tiles_kept_in_charts, m.tiles);
    }
    fmt::print("  archive  {:>12} bytes; {:.1f} s; peak memory {} MiB\n", summary.archive_bytes, summary.seconds,
               summary.peak_memory_bytes >> 20);
    if (summary.report.defect_count == 0) fmt::print("  nothing was skipped\n");
}

Error wrong_value(std::string_view option, const std::string& why) {
    return Error{fmt::format("wrong value of {}: {}", option, why)};
}

/// Values that are texts on the command line.
Status read_values(Arguments& arguments, layers::BuildOptions& options) {
    const auto memory = parse_bytes(arguments.memory);
    if (!memory) return wrong_value("--memory-limit", arguments.memory + " is not a size such as 2GiB");
    const auto layer_set = parse_layers(arguments.layers);
    if (!layer_set)
        return wrong_value("--layers", arguments.layers + " is not of mesh, facade, atlas, radiance; mesh is needed");
    const auto origin = parse_origin(arguments.origin);
    if (!origin) return wrong_value("--origin", arguments.origin + " is not X,Y");
    const auto saliency = codec::atlas::parse_metric(arguments.saliency);
    if (!saliency) return wrong_value("--saliency", saliency.error().text());
    const auto texture_law = layers::parse_texture_law(arguments.texture_law);
    if (!texture_law) return wrong_value("--texture-law", texture_law.error().text());
    for (const std::string& text : arguments.aerial) {
        if (const auto request = layers::parse_aerial(text); !request)
            return wrong_value("--aerial", request.error().text());
    }
    options.memory_limit = *memory;
    options.layers = *layer_set;
    options.saliency = *saliency;
    options.texture_law = *texture_law;
    arguments.generator.origin = *origin;
    return Done{};
}

/// Charts or pages, and what only one of them has.
Status read_atlas_form(const Arguments& arguments, layers::BuildOptions& options) {
    const bool pages = arguments.atlas_form == "pages";
    if (pages) options.atlas_form = codec::atlas::AtlasForm::kPages;
    if (!pages && arguments.page_mips) return Error{"--page-mips is of pages: add --atlas-form pages"};
    if (!pages && arguments.page_shape) return Error{"--page-shape is of pages: add --atlas-form pages"};
    options.shared_charts = arguments.shared_charts.value_or(pages ? "off" : "on") == "on";
    if (pages && options.shared_charts) return Error{"--shared-charts on is of charts: pages share nothing"};
    if (arguments.page_mips) {
        const auto mips = parse_page_mips(*arguments.page_mips);
        if (!mips) return wrong_value("--page-mips", mips.error().text());
        options.page_mips = *mips;
    }
    if (!options.page_mips && !options.texture_law.levels)
        return Error{"--page-mips law: --texture-law " + arguments.texture_law + " has no levels"};
    if (arguments.page_shape == "power-of-two") options.page_shape = codec::atlas::PageShape::kPowerOfTwo;
    return Done{};
}

/// Which of the names it is; they are checked when the command line is read.
template <typename Value, size_t kNames>
Value named(const std::array<std::string_view, kNames>& names, const std::string& name) {
    return static_cast<Value>(std::find(names.begin(), names.end(), name) - names.begin());
}

Status read_mesh_form(const Arguments& arguments, layers::MeshForm& form) {
    form.transport = named<layers::MeshTransport>(layers::kMeshTransportNames, arguments.mesh_transport);
    form.topology = named<codec::mesh::MeshTopology>(layers::kMeshTopologyNames, arguments.mesh_topology);
    form.precision = named<layers::PositionPrecision>(layers::kPositionPrecisionNames, arguments.precision);
    form.normal_bits = arguments.normal_bits;
    if (arguments.mesh_steps != "auto")
        form.steps = static_cast<uint32_t>(std::stoul(arguments.mesh_steps, nullptr, 0));
    if (Status good = layers::check_mesh_form(form); !good) return wrong_value("--normal-bits", good.error().text());
    return Done{};
}

/// What only the layer radiance has.
Status read_radiance_form(const Arguments& arguments, layers::BuildOptions& options) {
    const bool asked = options.layers[static_cast<size_t>(tileset::Layer::kRadiance)];
    layers::RadianceForm& form = options.radiance;
    form.lattice_metres = arguments.lattice.value_or(form.lattice_metres);
    form.texels_across = arguments.directions.value_or(form.texels_across);
    form.local_across = arguments.local_directions.value_or(form.local_across);
    form.error = arguments.radiance_error.value_or(form.error);
    if (arguments.radiance_transport)
        form.transport = named<codec::radiance::RadianceTransport>(codec::radiance::kRadianceTransportNames,
                                                                   *arguments.radiance_transport);
    form.reuse = !arguments.rebake;
    if (!asked) {
        const char* given = arguments.lattice              ? "--lattice"
                            : arguments.directions         ? "--directions"
                            : arguments.local_directions   ? "--local-directions"
                            : arguments.radiance_error     ? "--radiance-error"
                            : arguments.radiance_transport ? "--radiance-transport"
                            : arguments.rebake             ? "--rebake"
                                                           : nullptr;
        if (given == nullptr) return Done{};
        return Error{fmt::format("{} is of the layer radiance: add it to --layers", given)};
    }
    if (!layers::radiance_can_be_built())
        return wrong_value("--layers", layers::check_radiance_form(form).error().text() + "; leave it out");
    return layers::check_radiance_form(form);
}

/// All but the aerial photographs. Error: wrong usage, one line.
Result<layers::BuildOptions> options_of(Arguments& arguments, ProgressBar& bar) {
    layers::BuildOptions options;
    if (const Status read = read_values(arguments, options); !read) return read.error();
    if (const Status read = read_atlas_form(arguments, options); !read) return read.error();
    if (const Status read = read_mesh_form(arguments, options.mesh); !read) return read.error();
    if (const Status read = read_radiance_form(arguments, options); !read) return read.error();
    options.output = arguments.output;
    options.reference = arguments.reference;
    options.jobs = arguments.jobs;
    options.auto_ground = arguments.ground == "auto";
    options.dress_seed = arguments.dress_seed;
    options.extract_relief = !arguments.no_extract_relief && arguments.generator.textures == 0;
    options.merge_tolerance_mm = arguments.merge_tolerance_mm;
    options.rate_distortion = arguments.rate_distortion;
    options.description = fmt::format(
        "layers={}{} ground={}{}{}", arguments.layers, arguments.lod.empty() ? "" : " lod=" + arguments.lod,
        arguments.ground, arguments.dress_seed ? fmt::format(" dress={}", *arguments.dress_seed) : std::string(),
        arguments.no_extract_relief ? " extract-relief=no" : "");
    options.cancel = &interrupted;
    options.progress = [&bar](std::string_view stage, uint64_t done, uint64_t total) { bar.show(stage, done, total); };
    return options;
}

/// The generator's city, or that of the input files.
layers::CitySource source_of(const Arguments& arguments, bool generate, ProgressBar& bar) {
    return [&arguments, &bar, generate](city::CityHeader& header, city::CityCatalog& catalog, city::CityReport& report,
                                        const city::CitySink& sink) -> Status {
        if (generate) {
            city::GeneratorOptions generator = arguments.generator;
            generator.progress = [&bar](uint64_t done, uint64_t total) { bar.show("generate", done, total); };
            city::generate_city(generator, header, catalog, report, sink);
            return Done{};
        }
        city::InputOptions input;
        if (!arguments.lod.empty()) input.lod = arguments.lod;
        input.progress = [&bar](uint64_t done, uint64_t total) { bar.show("read", done, total); };
        return city::read_city(arguments.inputs, input, header, catalog, report, sink);
    };
}

int build(Arguments& arguments, bool generate, ProgressBar& bar) {
    auto options = options_of(arguments, bar);
    if (!options) return fail(options.error().text(), kWrongUsage);
    for (const std::string& text : arguments.aerial) {
        auto image = layers::open_aerial(text);
        if (!image) return fail(image.error().text());
        options->aerial.push_back(std::move(image).value());
    }
    city::CityReport report;
    const auto summary = layers::build_city(*options, source_of(arguments, generate, bar), report);
    bar.clear();
    if (summary) report = summary->report;
    if (!arguments.report.empty() && !write_report(arguments.report, report))
        return fail("cannot write report " + arguments.report);
    if (!summary) {
        // The last defect of a failed reading is the failure itself.
        return fail(report.defect_count <= 1
                        ? summary.error().text()
                        : fmt::format("{}; {} more defects before it (--report FILE.json lists them)",
                                      summary.error().text(), report.defect_count - 1));
    }
    print_defects(report);
    print_summary(*summary, arguments);
    return 0;
}

int info(const Arguments& arguments) {
    const auto city = layers::read_city_info(arguments.archive);
    if (!city) return fail(about(arguments.archive, city.error()));
    if (arguments.json) {
        fmt::print("{}\n", city->dump(1, ' ', false, nlohmann::json::error_handler_t::replace));
    } else {
        for (const auto& [key, value] : city->items()) fmt::print("{:<22} {}\n", key, value.dump());
    }
    return 0;
}

int verify(const Arguments& arguments, ProgressBar& bar) {
    const auto damages = layers::verify_city(
        arguments.archive, [&bar](uint64_t done, uint64_t total) { bar.show("verify", done, total); });
    bar.clear();
    if (!damages) return fail(about(arguments.archive, damages.error()));
    if (arguments.json) {
        fmt::print("{}\n", nlohmann::json{{"ok", damages->empty()}, {"damages", *damages}}.dump(1));
    } else {
        for (const std::string& damage : *damages) fmt::print("{}\n", damage);
        if (damages->empty()) fmt::print("{}: every byte is as it was written\n", arguments.archive);
    }
    return damages->empty() ? 0
                            : fail(fmt::format("{}: {} damages; build it again or fetch it again", arguments.archive,
                                               damages->size()));
}

template <size_t kNames>
CLI::Validator one_of(const std::array<std::string_view, kNames>& names) {
    return CLI::IsMember(std::vector<std::string>(names.begin(), names.end()));
}

void add_mesh_options(CLI::App& app, Arguments& arguments) {
    app.add_option("--mesh-transport", arguments.mesh_transport,
                   "how meshes travel: default (positions in steps), draco (one step, decoded by libdraco)")
        ->check(one_of(layers::kMeshTransportNames))
        ->capture_default_str();
    app.add_option("--normal-bits", arguments.normal_bits,
                   fmt::format("bits of a normal, an even number from {} to {}", layers::kLeastNormalBits,
                               layers::kMostNormalBits))
        ->capture_default_str();
    app.add_option("--mesh-topology", arguments.mesh_topology,
                   "how triangles lie in GPU memory: indices; local-strips (drawn as they are); strip-code (smallest, "
                   "decoded by the GPU before drawing)")
        ->check(one_of(layers::kMeshTopologyNames))
        ->capture_default_str();
    app.add_option("--precision", arguments.precision,
                   "bits of positions: ap (by distance), cap (and as many as pictures and bent normals ask for)")
        ->check(one_of(layers::kPositionPrecisionNames))
        ->capture_default_str();
    app.add_option("--mesh-steps", arguments.mesh_steps,
                   "steps of positions: more make the first one smaller and all of them larger; auto: of each tile as "
                   "many as pay")
        ->check(command_line::word_or("auto", command_line::number_from(1U, codec::mesh::kMostMeshSteps)))
        ->capture_default_str();
}

void add_radiance_options(CLI::App& app, Arguments& arguments) {
    const layers::RadianceForm usual;
    app.add_option("--lattice", arguments.lattice,
                   fmt::format("metres between the places where light is gathered, in leaves: 1, 2, 4, 8 or {} "
                               "[default: {}]; of the layer radiance, as all that follows",
                               layers::kMostLatticeMetres, usual.lattice_metres))
        ->check(CLI::IsMember({1U, 2U, 4U, 8U, layers::kMostLatticeMetres}));
    app.add_option("--directions", arguments.directions,
                   fmt::format("directions that light comes from: 6 N^2, on a cube N across, 1 to {} [default: {}]",
                               codec::radiance::kMostCubeSide, usual.texels_across))
        ->check(command_line::number_from(1U, codec::radiance::kMostCubeSide));
    app.add_option("--local-directions", arguments.local_directions,
                   fmt::format("directions of a place's own hemisphere: M^2, 1 to {} across [default: {}]",
                               codec::radiance::kMostLocalSide, usual.local_across))
        ->check(command_line::number_from(1U, codec::radiance::kMostLocalSide));
    app.add_option(
           "--radiance-error", arguments.radiance_error,
           "part of an even sky's light that each place may get wrong, for fewer bytes: what a lone ray sees is "
           "taken for what those around it see [default: 0]")
        ->check(command_line::number_from(0.0, 1.0));
    app.add_option(
           "--radiance-transport", arguments.radiance_transport,
           "how what places see travels: visibility (smallest, refined in steps), or as the matrix that clients "
           "make of it: biclusters (no search at arrival), distinct-rows, rows [default: visibility]")
        ->check(one_of(codec::radiance::kRadianceTransportNames));
    app.add_flag("--rebake", arguments.rebake,
                 "take nothing from the archive that is replaced (tiles whose surroundings did not change are copied "
                 "from it; the bytes are the same)");
}

void add_build_options(CLI::App& app, Arguments& arguments) {
    app.add_option("-o,--output", arguments.output, "archive to write (.3tz)");
    app.add_option("--layers", arguments.layers, "layers to build, of mesh,facade,atlas,radiance")
        ->capture_default_str();
    app.add_option("--jobs", arguments.jobs, "threads (0: all cores); the bytes do not depend on it")
        ->capture_default_str();
    app.add_option("--memory-limit", arguments.memory, "working memory, such as 2GiB")->capture_default_str();
    app.add_option("--reference", arguments.reference, "also write the uncompressed city as glTF (.glb)");
    app.add_option("--report", arguments.report, "write every defect of the input to this JSON file");
    app.add_option("--ground", arguments.ground, "auto: a flat ground where the input has none")
        ->check(CLI::IsMember({"auto", "none"}))
        ->capture_default_str();
    app.add_option("--aerial", arguments.aerial,
                   "IMAGE with a world file beside it, or IMAGE,XMIN,YMIN,XMAX,YMAX: an aerial photograph over ground "
                   "without texture; repeatable")
        ->allow_extra_args(false);
    app.add_option("--dress", arguments.dress_seed,
                   "put made-up facades on plain walls of buildings, from this seed (says so in the archive)");
    app.add_flag("--no-extract-relief", arguments.no_extract_relief,
                 "keep windows, doors and balconies of detailed walls as triangles");
    app.add_option("--merge-tolerance", arguments.merge_tolerance_mm,
                   "facade maps whose displacements differ by at most this many millimetres become one")
        ->check(command_line::number_from(0, 1000))
        ->capture_default_str();
    app.add_option("--rate-distortion", arguments.rate_distortion,
                   "squared error of pictures that a bit on the wire is worth: more for fewer bytes, 0 for none")
        ->check(command_line::number_from(0, 1 << 20))
        ->capture_default_str();
    app.add_option("--shared-charts", arguments.shared_charts,
                   "on: pictures that several tiles show are stored once where that is smaller; of charts only "
                   "[default: on for charts, off for pages]")
        ->check(CLI::IsMember({"on", "off"}));
    app.add_option("--atlas-form", arguments.atlas_form,
                   "charts: every picture of a tile has mips of its own; pages: they are packed into common images "
                   "with borders")
        ->check(CLI::IsMember({"charts", "pages"}))
        ->capture_default_str();
    app.add_option("--page-mips", arguments.page_mips,
                   fmt::format("coarser levels of pages, which are all that distance has; law: as many as "
                               "--texture-law keeps at each level of the tree [default: {}]",
                               *layers::BuildOptions().page_mips));
    app.add_option("--page-shape", arguments.page_shape,
                   "tight: pages as small as their charts allow; power-of-two: as the paper predicts them, with charts "
                   "stretched and space filled until every texel is a chart's [default: tight]")
        ->check(CLI::IsMember({"tight", "power-of-two"}));
    app.add_option("--texture-law", arguments.texture_law,
                   "metres a texel of images: METRES,FACTOR,LEVELS (FACTOR times as long at each level above the "
                   "leaves), thesis (0.05,8,3), or METRES (of leaves; above them half of what the geometry errs by)")
        ->capture_default_str();
    app.add_option("--saliency", arguments.saliency,
                   "how much images may lose to become smaller, METRIC:TOLERANCE or none: rmse, nrmse, tm, mannos, "
                   "daly, ahumada, hvse, flip (largest error) or ssim (least similarity)")
        ->capture_default_str();
    add_mesh_options(app, arguments);
    add_radiance_options(app, arguments);
    app.add_flag("--json", arguments.json, "print the summary as JSON");
}

}  // namespace

int main(int argc, char** argv) {
    layers::return_freed_memory();
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
    Arguments arguments;
    ProgressBar bar;
    CLI::App app{
        "Builds a city model (CityJSON, CityJSONSeq, CityGML) into one archive that citystream-serve can stream."};
    app.set_version_flag("--version", CITYSTREAM_VERSION);
    app.footer(
        "Examples:\n"
        "  citystream-build city.city.jsonl -o city.3tz\n"
        "  citystream-build tiles/*.gml -o city.3tz --reference city.glb --report skipped.json\n"
        "  citystream-build generate --buildings 1000 --seed 1 -o city.3tz\n"
        "  citystream-build plain.city.jsonl --dress 1 -o city.3tz\n"
        "  citystream-build city.city.jsonl --layers mesh,facade,atlas,radiance --lattice 4 -o city.3tz\n"
        "  citystream-build info city.3tz --json\n"
        "  citystream-build verify city.3tz");
    app.add_option("INPUT", arguments.inputs, "city models; several make one city");
    app.add_option("--lod", arguments.lod,
                   "take this level of detail only (2.2, 3); default: the highest of each object");
    add_build_options(app, arguments);
    CLI::App* generate = app.add_subcommand("generate", "build a procedural city from a seed");
    generate->add_option("--buildings", arguments.generator.buildings, "how many")->capture_default_str();
    generate->add_option("--seed", arguments.generator.seed, "same seed, same city")->capture_default_str();
    generate
        ->add_option("--textures", arguments.generator.textures,
                     "flat walls with this many distinct textures instead of facades with relief; 0 or 56 and more")
        ->check(command_line::word_or("0", command_line::number_from(city::procedural::kLeastTextures, 100'000'000U)))
        ->capture_default_str();
    generate->add_option("--origin", arguments.origin, "X,Y: metres added to every position")->capture_default_str();
    add_build_options(*generate, arguments);
    CLI::App* show = app.add_subcommand("info", "what an archive holds");
    show->add_option("ARCHIVE", arguments.archive, "archive (.3tz)")->required();
    show->add_flag("--json", arguments.json, "as JSON");
    CLI::App* check = app.add_subcommand("verify", "check every byte of an archive; exit code 1 names each damage");
    check->add_option("ARCHIVE", arguments.archive, "archive (.3tz)")->required();
    check->add_flag("--json", arguments.json, "as JSON");
    if (const auto ended = command_line::read_arguments(app, argc, argv)) return *ended;
    if (show->parsed()) return info(arguments);
    if (check->parsed()) return verify(arguments, bar);
    if (arguments.output.empty()) return fail("-o CITY.3tz is missing; see --help", kWrongUsage);
    if (!generate->parsed() && arguments.inputs.empty()) return fail("INPUT is missing; see --help", kWrongUsage);
    return build(arguments, generate->parsed(), bar);
}
