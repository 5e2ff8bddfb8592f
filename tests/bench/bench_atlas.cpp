// Claim: how small charts become by view matching and by each metric and tolerance, and what they cost on the wire.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <optional>

#include "codec/atlas/chart_search.h"
#include "codec/atlas/coverage.h"
#include "codec/atlas/step_blocks.h"
#include "codec/bits/zstd_frame.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/jpeg_file.h"
#include "tests/bench/metric_option.h"
#include "tests/bench/usable_memory.h"
#include "tiles/city/generator.h"
#include "tiles/layers/image_decode.h"
#include "tiles/layers/image_preparation.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::codec::atlas;

constexpr const char* kClaim =
    "Charts after view matching and saliency search: size, error and bytes of every image, metric and tolerance.\n"
    "in: the image's size. view_size: after view matching by --metres and --texel (as it is without --metres). size,\n"
    "error: the chart's, by a search of --order that judges by the view-matched image. calls: of the metric,\n"
    "all of them. bc1_zstd_bytes: the chart's finest mip in BC1 (BC3 where it has alpha) after zstd -19. jpeg_bytes:\n"
    "the colours of the image as given, as JPEG of quality 85, which a plain viewer would fetch; view_jpeg_bytes: of\n"
    "the view-matched one. What would hold more memory than --memory-limit is passed over. mpixel_per_s: view-matched "
    "pixels a\n"
    "second of processor time of the search, one core. Without IMAGEs: the textures of a generated city, with the "
    "metres that its walls,\n"
    "roofs and streets give them.";
constexpr int kJpegQuality = 85;
/// Bytes a texel of an image as given that are held beside the search: itself, and while it becomes a JPEG.
constexpr uint64_t kHeldTexel = 8;
constexpr const char* kMetrics =
    "rmse:0.05,rmse:0.1,rmse:0.2,nrmse:0.1,hvse:0.1,hvse:0.2,hvse:0.3,hvse:0.4,hvse:0.5,ssim:0.98,ssim:0.95,ssim:0.9,"
    "flip:0.05,flip:0.1";

struct Request {
    double metres_u = 0, metres_v = 0;  // of one repeat; 0: no view matching
    double texel = 0.05;
    uint64_t memory_bytes = usable_memory();
    std::vector<Metric> metrics;
    SearchSettings search;
};

struct Picture {
    std::string name;
    ChartImage image;
    Coverage coverage;
};

std::optional<double> parse_metres(std::string_view text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !(value > 0) || value > 1e9) return std::nullopt;
    return value;
}

bool take_mebibytes(const std::string& text, uint64_t& bytes) {
    uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value == 0 || value > 1U << 30) return false;
    bytes = value << 20;
    return true;
}

bool take_size(const std::string& text, Request& request) {
    const size_t cross = text.find('x');
    if (cross == std::string::npos) return false;
    const auto width = parse_metres(std::string_view(text).substr(0, cross));
    const auto height = parse_metres(std::string_view(text).substr(cross + 1));
    if (!width || !height) return false;
    request.metres_u = *width;
    request.metres_v = *height;
    return true;
}

template <typename T>
bool take(const std::optional<T>& parsed, T& value) {
    if (parsed) value = *parsed;
    return parsed.has_value();
}

std::vector<BenchOption> options_of(Request& request) {
    return {{"--metres", "WxH, metres that one repeat of every image covers",
             [&request](const std::string& text) { return take_size(text, request); }},
            {"--texel", "M, metres a texel of the view (0.05)",
             [&request](const std::string& text) { return take(parse_metres(text), request.texel); }},
            {"--memory-limit", "MiB (three quarters of what the machine allows)",
             [&request](const std::string& text) { return take_mebibytes(text, request.memory_bytes); }},
            {"--metric", "metrics with tolerances, such as rmse:0.05,hvse:0.3,ssim:0.98,flip:0.05,none",
             [&request](const std::string& text) { return take_metrics(text, request.metrics); }},
            {"--order", "width, height, both, alternate or best",
             [&request](const std::string& text) { return take(parse_search_order(text), request.search.order); }},
            {"--filter", "area, lanczos or bilinear (the thesis's, without prefilter)",
             [&request](const std::string& text) { return take(parse_shrink(text), request.search.filter); }}};
}

/// As a file, whose first row is the top one.
uint64_t jpeg_bytes(const ChartImage& image) {
    const auto row = static_cast<ptrdiff_t>(3 * size_t{image.width});
    std::vector<uint8_t> upright;
    upright.reserve(image.rgb.size());
    for (auto end = image.rgb.end(); end != image.rgb.begin(); end -= row)
        upright.insert(upright.end(), end - row, end);
    return jpeg_file(upright, image.width, image.height, kJpegQuality).size();
}

uint64_t bc1_zstd_bytes(const ChartImage& chart) {
    std::vector<uint32_t> words;
    StepBlocks(words, 0).append(chart);
    return codec::bits::compress_frame(std::as_bytes(std::span(words))).size();
}

/// The error again, from the bytes that would be stored.
double error_of(const ChartImage& chart, const Image& original, const SearchSettings& search) {
    if (search.metric.kind == MetricKind::kNone) return 0;
    Image seen = original;
    test_alpha(seen);
    const MetricReference reference(seen, search.metric.kind, search.view);
    return reference.error(whole_image(shown_rows(linear_image(chart), original.width, original.height, search)));
}

ChartSize wanted_size(ChartSize in, const Coverage& coverage, const Request& request) {
    return coverage.used() ? view_size(in, coverage, request.texel) : in;
}

/// The image at the size that the view needs, as a build stores it.
ChartImage view_matched(const Picture& picture, const Request& request) {
    const ChartImage& image = picture.image;
    const ChartSize in{image.width, image.height}, wanted = wanted_size(in, picture.coverage, request);
    if (wanted == in) return image;
    const SearchSettings& search = request.search;
    ChartImage view = chart_image(resample(image, wanted.width, wanted.height, search.filter, search.edges));
    view.repeat_u = image.repeat_u;
    view.repeat_v = image.repeat_v;
    keep_share(view, there_of(image));
    return view;
}

void measure(const Picture& picture, Request request, BenchProgram& program) {
    const auto size_of = [](const auto& image) { return Json::array({image.width, image.height}); };
    request.search.edges = {picture.image.repeat_u, picture.image.repeat_v};
    request.search.there = there_of(picture.image);
    const ChartSize in{picture.image.width, picture.image.height};
    const ChartImage matched = view_matched(picture, request);
    const Image view = linear_image(matched);
    const uint64_t jpeg = jpeg_bytes(picture.image), view_jpeg = jpeg_bytes(matched);
    for (const Metric& metric : request.metrics) {
        request.search.metric = metric;
        const std::clock_t start = std::clock();
        const SearchResult result = search_chart(view, request.search);
        const double seconds = static_cast<double>(std::max<std::clock_t>(std::clock() - start, 1)) / CLOCKS_PER_SEC;
        ChartImage chart = chart_image(result.image);
        program.check(result.error <= metric.largest_error(), picture.name + ": the chart keeps the tolerance");
        program.check(std::abs(error_of(chart, view, request.search) - result.error) < 1e-9,
                      picture.name + ": the stored bytes have the error that the search states");
        tiles::layers::settle_alpha(chart);
        program.print({{"image", picture.name},
                       {"metric", name_of(metric.kind)},
                       {"tolerance", metric.tolerance},
                       {"in", size_of(in)},
                       {"view_size", size_of(view)},
                       {"size", size_of(result.image)},
                       {"error", rounded(result.error)},
                       {"calls", result.calls},
                       {"bc1_zstd_bytes", bc1_zstd_bytes(chart)},
                       {"jpeg_bytes", jpeg},
                       {"view_jpeg_bytes", view_jpeg},
                       {"mpixel_per_s", rounded(static_cast<double>(view.area()) / 1e6 / seconds)}});
    }
}

Coverage coverage_of(double metres_u, double metres_v) {
    Coverage coverage;
    if (metres_u > 0 && metres_v > 0) coverage = {metres_u, metres_v, 1, 1, 1, 1, 0};
    return coverage;
}

/// The generator's textures and what its city says about them.
std::vector<Picture> generated_pictures(const BenchOptions& options) {
    tiles::city::GeneratorOptions generator;
    generator.buildings = options.buildings;
    generator.seed = options.seed;
    tiles::city::CityHeader header;
    tiles::city::CityCatalog catalog;
    tiles::city::CityReport report;
    std::vector<Coverage> by_material;
    tiles::city::generate_city(generator, header, catalog, report, [&](tiles::city::CityObject&& object) {
        for (const auto& triangle : object.triangles) {
            by_material.resize(std::max<size_t>(by_material.size(), triangle.material + size_t{1}));
            std::array<CoverageVertex, 3> corners;
            for (size_t k = 0; k < 3; ++k) {
                const auto& at = object.vertices[triangle.vertex[k]];
                corners[k] = {{at.x, at.y, at.z}, {triangle.texcoord[k].x, triangle.texcoord[k].y}};
            }
            add_polygon(by_material[triangle.material], corners);
        }
        return true;
    });
    by_material.resize(catalog.materials.size());
    std::vector<Picture> pictures;
    for (size_t i = 0; i < catalog.images.size(); ++i) {
        if (!catalog.images[i].pixels) continue;
        const auto& pixels = *catalog.images[i].pixels;
        Picture picture{"texture-" + std::to_string(i), {}, {}};
        picture.image.width = pixels.width;
        picture.image.height = pixels.height;
        picture.image.rgb = pixels.rgb;
        for (size_t m = 0; m < catalog.materials.size(); ++m) {
            const auto& material = catalog.materials[m];
            if (material.image != static_cast<int32_t>(i)) continue;
            picture.image.repeat_u = picture.image.repeat_v = material.repeat;
            const auto metres = static_cast<double>(material.metres_per_repeat);
            add_coverage(picture.coverage, by_material[m]);
            add_coverage(picture.coverage, coverage_of(metres, metres));
        }
        pictures.push_back(std::move(picture));
    }
    return pictures;
}

/// Nothing, and a line, if the file is no image or is too large.
std::optional<Picture> read_picture(const std::string& path, const Request& request, BenchProgram& program) {
    const auto file = tiles::layers::ImageFile::open(path);
    if (!program.check(file.ok(), path + " is an image: " + (file ? "" : file.error().text()))) return std::nullopt;
    Picture picture{
        std::filesystem::path(path).filename().string(), {}, coverage_of(request.metres_u, request.metres_v)};
    const ChartSize size{(*file)->width(), (*file)->height()};
    const auto wanted = wanted_size(size, picture.coverage, request);
    const uint64_t held = kHeldTexel * size.width * size.height;
    const auto plan = tiles::layers::plan_image({size, (*file)->strip_bytes(), true, (*file)->has_alpha()}, wanted,
                                                true, request.memory_bytes - std::min(held, request.memory_bytes));
    const bool fits = plan.searched && !plan.halved && !plan.by_rows;
    if (!program.check(fits, fmt::format("{}: a search at {} x {} texels fits {} MiB (--memory-limit; --metres and "
                                         "--texel make images smaller)",
                                         path, wanted.width, wanted.height, request.memory_bytes >> 20)))
        return std::nullopt;
    auto image = tiles::layers::read_whole(**file);
    if (!program.check(image.ok(), path + " is an image: " + (image ? "" : image.error().text()))) return std::nullopt;
    tiles::layers::settle_alpha(*image);
    picture.image = *std::move(image);
    return picture;
}

}  // namespace

int main(int argc, char** argv) {
    Request request;
    take_metrics(kMetrics, request.metrics);
    BenchProgram program({"bench_atlas", kClaim, "image.jpg", true, {}, options_of(request)});
    BenchOptions options;
    options.buildings = 30;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    if (options.files.empty()) {
        const auto pictures = generated_pictures(options);
        program.check(!pictures.empty(), "the generator makes textures");
        for (const Picture& picture : pictures) measure(picture, request, program);
    }
    for (const std::string& file : options.files) {
        if (const auto picture = read_picture(file, request, program)) measure(*picture, request, program);
    }
    return program.exit_code();
}
