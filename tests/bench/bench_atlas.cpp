// Claim: how small charts become by view matching and by each metric and tolerance, and what they cost on the wire.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <ctime>
#include <filesystem>

#include "codec/atlas/bc1.h"
#include "codec/atlas/chart_search.h"
#include "codec/atlas/coverage.h"
#include "codec/bits/zstd_frame.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/metric_option.h"
#include "tiles/city/generator.h"
#include "tiles/layers/image_cache.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::codec::atlas;

constexpr const char* kClaim =
    "Charts after view matching and saliency search: size, error and bytes of every image, metric and tolerance.\n"
    "in: the image's size. view_size: after view matching by --metres and --texel (as it is without --metres). size,\n"
    "error: the chart's, by a search of --order that judges by the view-matched image. calls: of the metric.\n"
    "bc1_zstd_bytes: the chart's finest mip in BC1 after zstd -19. jpeg_bytes: the image as given, as JPEG of quality\n"
    "85, which a plain viewer would fetch; view_jpeg_bytes: the view-matched one. mpixel_per_s: view-matched pixels a\n"
    "second of processor time of the search, one core. Without IMAGEs: the textures of a generated city, with the "
    "metres that its walls,\n"
    "roofs and streets give them.";
constexpr int kJpegQuality = 85;
constexpr const char* kMetrics =
    "rmse:0.05,rmse:0.1,rmse:0.2,nrmse:0.1,hvse:0.1,hvse:0.2,hvse:0.3,hvse:0.4,hvse:0.5,ssim:0.98,ssim:0.95,ssim:0.9,"
    "flip:0.05,flip:0.1";

struct Request {
    double metres_u = 0, metres_v = 0;  // of one repeat; 0: no view matching
    double texel = 0.05;
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
            {"--metric", "metrics with tolerances, such as rmse:0.05,hvse:0.3,ssim:0.98,flip:0.05,none",
             [&request](const std::string& text) { return take_metrics(text, request.metrics); }},
            {"--order", "width, height, both, alternate or best",
             [&request](const std::string& text) { return take(parse_search_order(text), request.search.order); }},
            {"--filter", "area, lanczos or bilinear (the thesis's, without prefilter)",
             [&request](const std::string& text) { return take(parse_shrink(text), request.search.filter); }}};
}

uint64_t jpeg_bytes(const ChartImage& image) {
    std::vector<unsigned char> file;
    OIIO::Filesystem::IOVecOutput memory(file);
    const auto output = OIIO::ImageOutput::create("image.jpg", &memory);
    OIIO::ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height), 3, OIIO::TypeDesc::UINT8);
    spec.attribute("Compression", "jpeg:" + std::to_string(kJpegQuality));
    const auto row = static_cast<OIIO::stride_t>(3 * size_t{image.width});
    const bool written = output && output->open("image.jpg", spec) &&
                         output->write_image(OIIO::TypeDesc::UINT8, &image.rgb[image.rgb.size() - size_t(row)],
                                             OIIO::AutoStride, -row) &&
                         output->close();
    return written ? file.size() : 0;
}

uint64_t bc1_zstd_bytes(const ChartImage& chart) {
    const std::vector<uint32_t> words = encode_bc1_image(chart.rgb, chart.width, chart.height);
    return codec::bits::compress_frame(std::as_bytes(std::span(words))).size();
}

/// The error again, from the bytes that would be stored.
double error_of(const ChartImage& chart, const Image& original, const SearchSettings& search) {
    if (search.metric.kind == MetricKind::kNone) return 0;
    const Image shown = resample(linear_image(chart), original.width, original.height, search.filter, search.edges);
    return MetricReference(original, search.metric.kind, search.view).error(shown);
}

void measure(const Picture& picture, Request request, BenchProgram& program) {
    const auto size_of = [](const auto& image) { return Json::array({image.width, image.height}); };
    request.search.edges = {picture.image.repeat_u, picture.image.repeat_v};
    const ChartSize in{picture.image.width, picture.image.height};
    const ChartSize wanted = picture.coverage.used() ? view_size(in, picture.coverage, request.texel) : in;
    Image view = resample(picture.image, wanted.width, wanted.height, request.search.filter, request.search.edges);
    quantise(view);
    const uint64_t jpeg = jpeg_bytes(picture.image), view_jpeg = jpeg_bytes(chart_image(view));
    for (const Metric& metric : request.metrics) {
        request.search.metric = metric;
        const std::clock_t start = std::clock();
        const SearchResult result = search_chart(view, request.search);
        const double seconds = static_cast<double>(std::max<std::clock_t>(std::clock() - start, 1)) / CLOCKS_PER_SEC;
        const ChartImage chart = chart_image(result.image);
        program.check(result.error <= metric.largest_error(), picture.name + ": the chart keeps the tolerance");
        program.check(std::abs(error_of(chart, view, request.search) - result.error) < 1e-9,
                      picture.name + ": the stored bytes have the error that the search states");
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
        auto image = tiles::layers::decode_image(file);
        if (!program.check(image.ok(), file + " is an image: " + (image ? "" : image.error().text()))) continue;
        measure({std::filesystem::path(file).filename().string(), *std::move(image),
                 coverage_of(request.metres_u, request.metres_v)},
                request, program);
    }
    return program.exit_code();
}
