// Claim: how fast the builder makes charts of images, stage by stage, on all cores.
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <thread>

#include "codec/atlas/bc1.h"
#include "codec/atlas/chart_content.h"
#include "codec/atlas/chart_search.h"
#include "codec/atlas/shared_chart.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/metric_option.h"
#include "tests/bench/number_option.h"
#include "tiles/city/generator.h"
#include "tiles/layers/image_cache.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::codec::atlas;

constexpr const char* kClaim =
    "Throughput of what citystream-build does to an image until it is a shared chart. A line for each stage:\n"
    "decode (or draw, of generated textures), view match (Lanczos to --scale of the sides), search with each metric\n"
    "(both orders, multiples of 4), then of the view-matched image mips, BC1 without and with rate-distortion\n"
    "(strength 4; all mips), and zstd. mpixel: of the image that the stage reads. mpixel_per_s: on all threads;\n"
    "per_core: a second of processor time, which other work on the machine changes less. share: of the processor time\n"
    "of a build with default options, which searches nothing and encodes with rate-distortion.\n"
    "hash: of all that the stage made; two builds of this program that print the same hash made the same bytes.\n"
    "Without FILEs: textures of a generated city.";

struct Request {
    uint32_t textures = 24;
    uint32_t jobs = std::max(1U, std::thread::hardware_concurrency());
    double scale = 0.9;
    std::vector<Metric> metrics;
};

std::vector<BenchOption> options_of(Request& request) {
    return {{"--textures", "how many of the generated city's (24)",
             [&](const std::string& text) { return take_number(text, 1U, 100000U, request.textures); }},
            {"--jobs", "threads (all cores)",
             [&](const std::string& text) { return take_number(text, 1U, 1024U, request.jobs); }},
            {"--scale", "of the sides after view matching (0.9)",
             [&](const std::string& text) { return take_number(text, 0.001, 1.0, request.scale); }},
            {"--metric", "metrics with tolerances (rmse:0.05,hvse:0.3,ssim:0.98,flip:0.05)",
             [&](const std::string& text) { return take_metrics(text, request.metrics); }}};
}

double thread_seconds() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::vector<uint32_t> words_of(std::span<const std::byte> bytes) {
    std::vector<uint32_t> words((bytes.size() + 3) / 4, 0);
    std::memcpy(words.data(), bytes.data(), bytes.size());
    return words;
}

ContentHash hash_of(std::span<const uint32_t> words) {
    return content_hash({{static_cast<uint32_t>(words.size()), 0}, words});
}

/// What one image became in a stage.
struct Made {
    uint64_t pixels = 0, bytes = 0;
    ContentHash hash;
};

Made made_of(uint64_t pixels, std::span<const std::byte> bytes) {
    return {pixels, bytes.size(), hash_of(words_of(bytes))};
}

struct StageTime {
    std::string name;
    uint64_t pixels = 0, bytes = 0;
    double wall_seconds = 0, thread_seconds = 0;
    ContentHash hash;
    bool default_build = true;  ///< is part of a build with default options
};

/// The same work on every image, on all threads.
StageTime run_stage(const std::string& name, size_t images, uint32_t jobs, const std::function<Made(size_t)>& work) {
    std::vector<Made> made(images);
    std::vector<double> seconds(jobs, 0);
    std::atomic<size_t> next = 0;
    StageTime stage;
    stage.name = name;
    stage.wall_seconds = seconds_of([&] {
        std::vector<std::jthread> threads;
        for (uint32_t job = 0; job < jobs; ++job) {
            threads.emplace_back([&, job] {
                for (size_t i = next++; i < images; i = next++) made[i] = work(i);
                seconds[job] = thread_seconds();
            });
        }
    });
    for (const double own : seconds) stage.thread_seconds += own;
    std::vector<uint32_t> hashes;
    for (const Made& one : made) {
        stage.pixels += one.pixels;
        stage.bytes += one.bytes;
        for (const uint64_t half : {one.hash.low, one.hash.high}) {
            hashes.push_back(static_cast<uint32_t>(half));
            hashes.push_back(static_cast<uint32_t>(half >> 32));
        }
    }
    stage.hash = hash_of(hashes);
    return stage;
}

/// Images on their way through the stages.
class Line {
  public:
    explicit Line(const Request& request) : request_(request) {}

    void draw(const tiles::city::CityCatalog& catalog, const std::vector<uint32_t>& images) {
        whole_.resize(images.size());
        stage("draw", true, [&](size_t i) {
            const auto drawn = catalog.images[images[i]].drawn();
            ChartImage& image = whole_[i];
            image.width = drawn->width;
            image.height = drawn->height;
            image.rgb = drawn->rgb;
            image.repeat_u = image.repeat_v = true;
            return pixels_made(image, image);
        });
    }

    bool decode(const std::vector<std::string>& files, BenchProgram& program) {
        whole_.resize(files.size());
        stage("decode", true, [&](size_t i) {
            if (auto image = tiles::layers::decode_image(files[i])) whole_[i] = *std::move(image);
            return pixels_made(whole_[i], whole_[i]);
        });
        for (size_t i = 0; i < files.size(); ++i) {
            if (!program.check(!whole_[i].rgb.empty(), files[i] + " is an image")) return false;
        }
        return true;
    }

    void match() {
        views_.resize(whole_.size());
        stage("view match", true, [&](size_t i) {
            const ChartImage& image = whole_[i];
            const auto side = [&](uint32_t old) {
                return std::max(1U, static_cast<uint32_t>(request_.scale * static_cast<double>(old)));
            };
            views_[i] = chart_image(resample(image, side(image.width), side(image.height), Shrink::kLanczos,
                                             {image.repeat_u, image.repeat_v}));
            return pixels_made(image, views_[i]);
        });
    }

    void search(const Metric& metric) {
        SearchSettings settings;
        settings.metric = metric;
        settings.multiple = 4;
        stage("search " + to_string(metric), false, [&](size_t i) {
            SearchSettings own = settings;
            own.edges = {whole_[i].repeat_u, whole_[i].repeat_v};
            return pixels_made(views_[i], chart_image(search_chart(linear_image(views_[i]), own).image));
        });
    }

    void mips() {
        stage("mips", true, [&](size_t i) {
            std::vector<std::byte> bytes;
            for (ChartImage mip = views_[i]; mip.width * mip.height > 1;) {
                mip = downsample(mip);
                const auto own = std::as_bytes(std::span(mip.rgb));
                bytes.insert(bytes.end(), own.begin(), own.end());
            }
            return made_of(pixels(views_[i]), bytes);
        });
    }

    void compress(uint32_t rate_distortion) {
        std::vector<LayerSteps> layers(views_.size());
        const std::string name = rate_distortion == 0 ? "bc1" : fmt::format("bc1, rate-distortion {}", rate_distortion);
        stage(name, rate_distortion > 0, [&](size_t i) {
            layers[i] = encode_atlas(std::span(&views_[i], 1), {rate_distortion});
            std::vector<uint32_t> words;
            for (const LayerStep& step : layers[i]) words.insert(words.end(), step.words.begin(), step.words.end());
            return made_of(pixels(views_[i]), std::as_bytes(std::span(words)));
        });
        stage("zstd of " + name, rate_distortion > 0, [&](size_t i) {
            std::vector<std::byte> bytes;
            for (const auto& level : encode_chart_levels(layers[i]))
                bytes.insert(bytes.end(), level.begin(), level.end());
            return made_of(pixels(views_[i]), bytes);
        });
    }

    void print(const BenchProgram& program) const {
        double sum = 0;
        for (const StageTime& stage : stages_) sum += stage.default_build ? stage.thread_seconds : 0;
        for (const StageTime& stage : stages_) {
            const double mpixel = static_cast<double>(stage.pixels) * 1e-6;
            Json line{{"stage", stage.name},
                      {"images", views_.size()},
                      {"mpixel", rounded(mpixel)},
                      {"bytes", stage.bytes},
                      {"jobs", request_.jobs},
                      {"mpixel_per_s", rounded(mpixel / stage.wall_seconds)},
                      {"per_core", rounded(mpixel / stage.thread_seconds)}};
            if (stage.default_build) line["share"] = rounded(stage.thread_seconds / sum);
            line["hash"] = fmt::format("{:016x}{:016x}", stage.hash.high, stage.hash.low);
            program.print(line);
        }
    }

  private:
    static uint64_t pixels(const ChartImage& image) { return uint64_t{image.width} * image.height; }
    static Made pixels_made(const ChartImage& in, const ChartImage& out) {
        return made_of(pixels(in), std::as_bytes(std::span(out.rgb)));
    }
    void stage(const std::string& name, bool default_build, const std::function<Made(size_t)>& work) {
        stages_.push_back(run_stage(name, whole_.size(), request_.jobs, work));
        stages_.back().default_build = default_build;
    }

    const Request& request_;
    std::vector<ChartImage> whole_, views_;
    std::vector<StageTime> stages_;
};

/// The first `count` drawn textures that walls show.
std::vector<uint32_t> generated_images(const BenchOptions& options, uint32_t count, tiles::city::CityCatalog& catalog) {
    tiles::city::GeneratorOptions generator;
    generator.buildings = options.buildings;
    generator.seed = options.seed;
    generator.textures = 10 * count + 56;
    tiles::city::CityHeader header;
    tiles::city::CityReport report;
    tiles::city::generate_city(generator, header, catalog, report, [](tiles::city::CityObject&&) { return true; });
    std::vector<uint32_t> drawn;
    for (uint32_t i = 0; i < catalog.images.size(); ++i) {
        if (catalog.images[i].make) drawn.push_back(i);
    }
    std::vector<uint32_t> images;
    for (size_t i = 0; i < std::min<size_t>(count, drawn.size()); ++i)
        images.push_back(drawn[i * drawn.size() / std::min<size_t>(count, drawn.size())]);
    return images;
}

}  // namespace

int main(int argc, char** argv) {
    Request request;
    take_metrics("rmse:0.05,hvse:0.3,ssim:0.98,flip:0.05", request.metrics);
    BenchProgram program({"bench_build_textures", kClaim, "image.jpg", true, {}, options_of(request)});
    BenchOptions options;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    Line line(request);
    tiles::city::CityCatalog catalog;
    if (!options.files.empty()) {
        if (!line.decode(options.files, program)) return program.exit_code();
    } else {
        const auto images = generated_images(options, request.textures, catalog);
        if (!program.check(!images.empty(), "the generator makes textures")) return program.exit_code();
        line.draw(catalog, images);
    }
    line.match();
    for (const Metric& metric : request.metrics) line.search(metric);
    line.mips();
    for (const uint32_t rate_distortion : {0U, 4U}) line.compress(rate_distortion);
    line.print(program);
    return program.exit_code();
}
