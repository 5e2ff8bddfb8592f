// Claim: the thesis's Tables 7 to 13 on a generated city with as many periodic textures and buildings as its own.
#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>
#include <thread>

#include "codec/atlas/bc1.h"
#include "codec/atlas/chart_search.h"
#include "codec/atlas/coverage.h"
#include "codec/atlas/level_law.h"
#include "codec/bits/zstd_frame.h"
#include "tests/bench/bench_program.h"
#include "tiles/city/generator.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::codec::atlas;
using tiles::city::CityCatalog;
using tiles::city::CityObject;

constexpr const char* kClaim =
    "Tables 7 to 13 of \"Space-Optimized Texture Atlases\" beside a generated city: how much smaller the textures of "
    "each\ntree level (0.05, 0.4, 3.2 m a texel) are than the photographs, by view matching and by each metric and "
    "tolerance.\nFirst the 24 view sizes of section 10.1.4, which must be the thesis's. Then one line of facts: what "
    "is "
    "sampled, and\nwhat the walls' texels would be without repeats (unrolled). Then a line for each setting and level, "
    "and one for all\nlevels. mb: 10^6 bytes of RGB, summed over every building and texture that it shows (the "
    "thesis's "
    "622,131 MB are 35\ntimes its 18 GB of photographs, so it must have counted uses, too). once_mb: each texture "
    "counted once. ratio: photographs\n(one level, or three of them) / mb. to_view: view-matched / mb. error_of_ratio: "
    "one standard error of the sample, as a share of\nratio. dxt1_ratio, dxt1_zstd_ratio: photographs as RGB / the "
    "same "
    "in BC1, and after zstd -19 (32 charts a frame). thesis_...:\nits figures, recomputed from its own columns, "
    "because "
    "every total ratio that it prints is ten times too high;\nthesis_printed: as printed. --sample textures are drawn "
    "with probabilities in proportion to their uses.";

constexpr size_t kLevels = 3, kChartsOfAFrame = 32;
constexpr double kThesisPhotographs = 622130.85;  // MB a level
constexpr double kThesisTexel = 0.56e-4;          // m^2: 234.4 km^2 are 4.2 Ttexel

struct Setting {
    const char* metric;
    std::array<double, kLevels> thesis_mb;  // zeros: not in the thesis
    double thesis_printed;
};

/// RMSE 5 % at level 0 is printed as 1732016.76; its total says 173188.65.
constexpr std::array<Setting, 11> kSettings = {{{"none", {437460.93, 3860.91, 16.41}, 42.28},
                                                {"rmse:0.05", {173188.65, 3811.55, 15.87}, 105},
                                                {"rmse:0.1", {13079.76, 3337.20, 15.87}, 1135},
                                                {"rmse:0.2", {90.02, 220.42, 15.87}, 57192},
                                                {"hvse:0.1", {243120.43, 3642.16, 15.56}, 75},
                                                {"hvse:0.3", {56194.18, 1449.67, 15.56}, 323},
                                                {"hvse:0.5", {17174.39, 805.83, 15.56}, 1037},
                                                {"ssim:0.98", {}, 0},
                                                {"ssim:0.95", {}, 0},
                                                {"flip:0.05", {}, 0},
                                                {"flip:0.1", {}, 0}}};

struct ViewCase {
    const char* image;
    ChartSize size;
    std::array<double, kLevels> thesis_ratio;
};

/// Section 10.1.4; a patch of 20 x 15 m.
constexpr std::array<ViewCase, 8> kViewCases = {{{"Window", {512, 512}, {2.18, 141.69, 10922.7}},
                                                 {"Rocktile", {500, 375}, {1.56, 101.35, 7812.5}},
                                                 {"Bricktile", {499, 366}, {1.52, 98.72, 7609.75}},
                                                 {"Fabriktile", {400, 300}, {1, 64.86, 5000}},
                                                 {"Textureatlas", {400, 400}, {1.33, 86.48, 6666}},
                                                 {"Crayons", {516, 341}, {1.46, 95.11, 7331}},
                                                 {"Boat", {500, 336}, {1.4, 90.81, 7000}},
                                                 {"Aerialphoto", {512, 512}, {2.18, 141.69, 10922}}}};

struct Request {
    uint32_t textures = 23939, sample = 300;
};

std::function<bool(const std::string&)> number_into(uint32_t& value) {
    return [&value](const std::string& text) {
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        return error == std::errc() && end == text.data() + text.size() && value > 0;
    };
}

/// What the city says of one texture.
struct Texture {
    uint32_t image = 0;
    uint64_t uses = 0;  // buildings that show it
    double area = 0;    // m^2 that show it
    Coverage coverage;
};

class TextureCensus {
  public:
    TextureCensus(const BenchOptions& options, uint32_t textures) {
        tiles::city::GeneratorOptions generator;
        generator.buildings = options.buildings;
        generator.seed = options.seed;
        generator.textures = textures;
        tiles::city::CityHeader header;
        tiles::city::CityReport report;
        tiles::city::generate_city(generator, header, catalog_, report, [this](CityObject&& object) {
            add(object);
            return true;
        });
        std::erase_if(textures_, [](const Texture& texture) { return texture.uses == 0; });
        for (const Texture& texture : textures_) uses_ += texture.uses;
    }

    const std::vector<Texture>& textures() const { return textures_; }
    uint64_t uses() const { return uses_; }
    tiles::city::Image draw(const Texture& texture) const { return *catalog_.images[texture.image].drawn(); }

    /// `count` textures at even steps of the running sum of uses; one with many uses is in it more than once.
    std::vector<Texture> sample(uint32_t count) const {
        std::vector<Texture> chosen;
        uint64_t sum = 0;
        for (const Texture& texture : textures_) {
            sum += texture.uses;
            while (chosen.size() < count && (2 * chosen.size() + 1) * uses_ < 2 * sum * count)
                chosen.push_back(texture);
        }
        return chosen;
    }

  private:
    void add(const CityObject& object) {
        if (object.kind != tiles::city::ObjectKind::kBuilding) return;
        std::vector<uint32_t> shown;
        for (const auto& triangle : object.triangles) {
            const int32_t image = catalog_.materials[triangle.material].image;
            if (image < 0 || !catalog_.images[static_cast<size_t>(image)].make) continue;
            const auto index = static_cast<uint32_t>(image);
            if (index >= textures_.size()) textures_.resize(index + size_t{1});
            std::array<CoverageVertex, 3> corners;
            for (size_t k = 0; k < 3; ++k) {
                const auto& at = object.vertices[triangle.vertex[k]];
                corners[k] = {{at.x, at.y, at.z}, {triangle.texcoord[k].x, triangle.texcoord[k].y}};
            }
            textures_[index].image = index;
            textures_[index].area += area_of(corners);
            add_polygon(textures_[index].coverage, corners);
            if (std::find(shown.begin(), shown.end(), index) == shown.end()) shown.push_back(index);
        }
        for (const uint32_t image : shown) ++textures_[image].uses;
    }

    static double area_of(const std::array<CoverageVertex, 3>& corners) {
        const auto& [a, b, c] = corners;
        std::array<double, 3> u{}, v{};
        for (size_t k = 0; k < 3; ++k) {
            u[k] = b.position[k] - a.position[k];
            v[k] = c.position[k] - a.position[k];
        }
        return 0.5 * std::hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
    }

    CityCatalog catalog_;
    std::vector<Texture> textures_;
    uint64_t uses_ = 0;
};

/// A texture at one level and setting.
struct Chart {
    uint64_t texels = 0;
    std::vector<uint32_t> blocks;
};

/// A texture of the sample, measured.
struct Measured {
    uint64_t uses = 0, photograph_texels = 0;
    double repeats = 0;
    std::array<std::array<Chart, kSettings.size()>, kLevels> charts;
    bool within_tolerance = true;
};

Chart chart_of(const SearchResult& found) {
    const ChartImage chart = chart_image(found.image);
    return {found.image.area(), encode_bc1_image(chart.rgb, chart.width, chart.height)};
}

Measured measure(const TextureCensus& census, const Texture& texture) {
    tiles::city::Image pixels = census.draw(texture);
    ChartImage photograph;
    photograph.width = pixels.width;
    photograph.height = pixels.height;
    photograph.rgb = std::move(pixels.rgb);
    Measured measured;
    measured.uses = texture.uses;
    measured.repeats = texture.coverage.repeats;
    measured.photograph_texels = uint64_t{photograph.width} * photograph.height;
    SearchSettings search;
    search.edges = {true, true};
    for (size_t level = 0; level < kLevels; ++level) {
        const double texel = thesis_law().metres_per_texel(static_cast<uint32_t>(level));
        const ChartSize size = view_size({photograph.width, photograph.height}, texture.coverage, texel);
        Image view = resample(photograph, size.width, size.height, search.filter, search.edges);
        quantise(view);
        for (size_t setting = 0; setting < kSettings.size(); ++setting) {
            search.metric = parse_metric(kSettings[setting].metric).value();
            const SearchResult found = search_chart(view, search);
            measured.within_tolerance &= found.error <= search.metric.largest_error();
            measured.charts[level][setting] = chart_of(found);
        }
    }
    return measured;
}

/// All of the sample, on all cores.
std::vector<Measured> measure_all(const TextureCensus& census, const std::vector<Texture>& sample) {
    std::vector<Measured> measured(sample.size());
    std::atomic<size_t> next = 0;
    std::vector<std::jthread> threads;
    for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i) {
        threads.emplace_back([&] {
            for (size_t at = next++; at < sample.size(); at = next++) measured[at] = measure(census, sample[at]);
        });
    }
    threads.clear();
    return measured;
}

/// Sums over the sample; the city's are `uses of the city / size of the sample` times as much.
struct Sums {
    double texels = 0, once = 0, dxt1 = 0, dxt1_zstd = 0;
    std::vector<double> each;  // texels of every sampled texture
    void add(const Sums& other) {
        texels += other.texels;
        once += other.once;
        dxt1 += other.dxt1;
        dxt1_zstd += other.dxt1_zstd;
        each.resize(other.each.size());
        for (size_t i = 0; i < each.size(); ++i) each[i] += other.each[i];
    }
};

Sums sums_of(const std::vector<Measured>& sample, size_t level, size_t setting) {
    Sums sums;
    for (size_t first = 0; first < sample.size(); first += kChartsOfAFrame) {
        std::vector<uint32_t> words;
        for (size_t i = first; i < std::min(first + kChartsOfAFrame, sample.size()); ++i) {
            const Chart& chart = sample[i].charts[level][setting];
            sums.texels += static_cast<double>(chart.texels);
            sums.once += static_cast<double>(chart.texels) / static_cast<double>(sample[i].uses);
            sums.each.push_back(static_cast<double>(chart.texels));
            words.insert(words.end(), chart.blocks.begin(), chart.blocks.end());
        }
        sums.dxt1 += static_cast<double>(4 * words.size());
        sums.dxt1_zstd += static_cast<double>(codec::bits::compress_frame(std::as_bytes(std::span(words))).size());
    }
    return sums;
}

/// Standard error of sum(a) / sum(b) as a share of it, the textures taken as drawn independently.
double error_of_ratio(const std::vector<double>& a, const std::vector<double>& b) {
    double sum_a = 0, sum_b = 0, squares = 0;
    for (size_t i = 0; i < a.size(); ++i) {
        sum_a += a[i];
        sum_b += b[i];
    }
    for (size_t i = 0; i < a.size(); ++i) squares += std::pow(a[i] / sum_a - b[i] / sum_b, 2);
    return std::sqrt(squares);
}

/// Prints lines of one setting: its levels and their sum.
class TablePrinter {
  public:
    TablePrinter(BenchProgram& program, const std::vector<Measured>& sample, uint64_t uses)
        : program_(program), sample_(sample) {
        scale_ = static_cast<double>(uses) / static_cast<double>(sample.size());
        for (const Measured& measured : sample) photographs_.push_back(static_cast<double>(measured.photograph_texels));
        for (size_t level = 0; level < kLevels; ++level) views_[level] = sums_of(sample, level, 0).texels;
    }

    void print(size_t setting) const {
        Sums all;
        double thesis_all = 0;
        for (size_t level = 0; level < kLevels; ++level) {
            const Sums sums = sums_of(sample_, level, setting);
            const double thesis = kSettings[setting].thesis_mb[level];
            line(setting, std::to_string(level), 1, sums, views_[level], thesis, kSettings[0].thesis_mb[level], 0);
            all.add(sums);
            thesis_all += thesis;
        }
        const auto& view = kSettings[0].thesis_mb;
        line(setting, "all", kLevels, all, views_[0] + views_[1] + views_[2], thesis_all, view[0] + view[1] + view[2],
             kSettings[setting].thesis_printed);
    }

  private:
    void line(size_t setting, const std::string& level, size_t levels, const Sums& sums, double view, double thesis,
              double thesis_view, double thesis_printed) const {
        double photographs = 0;
        for (const double texels : photographs_) photographs += texels * static_cast<double>(levels);
        Json fields = {{"setting", setting == 0 ? "view only" : kSettings[setting].metric}, {"level", level}};
        fields["mb"] = rounded(3e-6 * scale_ * sums.texels);
        fields["once_mb"] = rounded(3e-6 * scale_ * sums.once);
        fields["ratio"] = rounded(photographs / sums.texels);
        fields["error_of_ratio"] = rounded(error_of_ratio(photographs_, sums.each));
        if (thesis > 0) fields["thesis_ratio"] = rounded(kThesisPhotographs * static_cast<double>(levels) / thesis);
        fields["to_view"] = rounded(view / sums.texels);
        if (thesis > 0) fields["thesis_to_view"] = rounded(thesis_view / thesis);
        fields["dxt1_ratio"] = rounded(3 * photographs / sums.dxt1);
        fields["dxt1_zstd_ratio"] = rounded(3 * photographs / sums.dxt1_zstd);
        if (thesis_printed > 0) fields["thesis_printed"] = thesis_printed;
        program_.print(fields);
    }

    BenchProgram& program_;
    const std::vector<Measured>& sample_;
    double scale_ = 0;
    std::vector<double> photographs_;
    std::array<double, kLevels> views_{};
};

void print_view_sizes(BenchProgram& program) {
    const Coverage patch{20, 15, 1, 1, 1, 1, 0};
    for (const ViewCase& test : kViewCases) {
        for (size_t level = 0; level < kLevels; ++level) {
            const double texel = thesis_law().metres_per_texel(static_cast<uint32_t>(level));
            const ChartSize size = view_size(test.size, patch, texel);
            const double ratio = 1.0 * test.size.width * test.size.height / (1.0 * size.width * size.height);
            const double thesis = test.thesis_ratio[level];
            program.check(std::abs(ratio - thesis) <= 0.01 * thesis, std::string(test.image) + ": the thesis's ratio");
            program.print({{"image", test.image},
                           {"metres_per_texel", rounded(texel)},
                           {"in", {test.size.width, test.size.height}},
                           {"view_size", {size.width, size.height}},
                           {"ratio", std::round(100 * ratio) / 100},
                           {"thesis_ratio", thesis}});
        }
    }
}

void print_facts(BenchProgram& program, const BenchOptions& options, const TextureCensus& census,
                 const std::vector<Texture>& sample, const std::vector<Measured>& measured) {
    double area = 0, unrolled = 0, photographs = 0;
    for (const Texture& texture : census.textures()) area += texture.area;
    const double scale = static_cast<double>(census.uses()) / static_cast<double>(sample.size());
    for (const Measured& one : measured) {
        const double texels = static_cast<double>(one.photograph_texels) / static_cast<double>(one.uses);
        unrolled += scale * one.repeats * texels;
        photographs += scale * texels;
    }
    size_t distinct = sample.empty() ? 0 : 1;
    for (size_t i = 1; i < sample.size(); ++i) distinct += sample[i].image != sample[i - 1].image;
    program.print({{"buildings", options.buildings},
                   {"textures", census.textures().size()},
                   {"uses", census.uses()},
                   {"sampled", sample.size()},
                   {"sampled_distinct", distinct},
                   {"photographs_gb", rounded(3e-9 * photographs)},
                   {"thesis_photographs_gb", 18},
                   {"textured_km2", rounded(1e-6 * area)},
                   {"thesis_textured_km2", 234.4},
                   {"cm2_a_texel", rounded(1e4 * area / unrolled)},
                   {"thesis_cm2_a_texel", 1e4 * kThesisTexel},
                   {"unrolled_raw_tb", rounded(3e-12 * unrolled)},
                   {"thesis_unrolled_raw_tb", 12.6},
                   {"unrolled_raw_tb_at_thesis_texel", rounded(3e-12 * area / kThesisTexel)},
                   {"unrolled_dxt1_tb", rounded(0.5e-12 * unrolled)},
                   {"thesis_unrolled_dxt1_tb", 2.1}});
}

}  // namespace

int main(int argc, char** argv) {
    Request request;
    BenchProgram program({"bench_atlas_city",
                          kClaim,
                          "",
                          true,
                          {},
                          {{"--textures", "distinct textures of the city (23939)", number_into(request.textures)},
                           {"--sample", "textures that are measured (300)", number_into(request.sample)}}});
    BenchOptions options;
    options.buildings = 93111;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    print_view_sizes(program);
    const TextureCensus census(options, request.textures);
    program.check(census.textures().size() <= request.textures, "no more textures than were asked for");
    const std::vector<Texture> sample = census.sample(request.sample);
    if (!program.check(!sample.empty(), "the city has textures")) return program.exit_code();
    const std::vector<Measured> measured = measure_all(census, sample);
    program.check(std::all_of(measured.begin(), measured.end(), [](const Measured& m) { return m.within_tolerance; }),
                  "every chart keeps its tolerance");
    print_facts(program, options, census, sample, measured);
    const TablePrinter table(program, measured, census.uses());
    for (size_t setting = 0; setting < kSettings.size(); ++setting) table.print(setting);
    return program.exit_code();
}
