// Claim: block compression. Quality and speed of our encoders against libsquish, bytes on the wire against the loss.
#include <squish.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "codec/atlas/alpha_mask.h"
#include "codec/atlas/bc1.h"
#include "codec/atlas/bc1_rate.h"
#include "codec/atlas/bc4.h"
#include "codec/atlas/block_planes.h"
#include "codec/atlas/step_blocks.h"
#include "codec/bits/zstd_frame.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/block_images.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
namespace atlas = codec::atlas;

constexpr const char* kClaim =
    "BC1 of photographs, facades, textures and procedural images: our encoders, libsquish's range fit and cluster fit, "
    "and JPEG.\n"
    "Lines per image and encoder: psnr_db over all three channels; speed_to_range_fit: Mtexel/s over those of the "
    "range "
    "fit, on a\n256 x 256 part; wire_bytes after zstd -19 of whole blocks, planes_bytes with endpoints and index words "
    "apart.\n"
    "rate LAMBDA: rate-distortion mode (its speed is that of rate 10); largest_rise: of a block's squared error per "
    "texel over its best block's.\n"
    "Lines per set: means; bd_rate_percent: bytes against another curve at equal PSNR (mean over the common range, "
    "between the\npoints linear in PSNR and log bytes), negative is smaller. FILEs are images.";
constexpr uint32_t kMostWidth = 768, kMostHeight = 512, kTimedSide = 256;
constexpr size_t kMostImages = 6;
constexpr uint32_t kLambdas[] = {2, 5, 10, 20, 40, 80};
constexpr int kJpegQualities[] = {30, 50, 70, 80, 90, 95, 98};

using Words = std::vector<uint32_t>;

uint64_t zstd_bytes(const Words& words) {
    return codec::bits::compress_frame(std::as_bytes(std::span(words))).size();
}

uint64_t planes_bytes(const Words& words) {
    Words planes(words.size());
    atlas::split_block_planes(words, 2, planes);
    return zstd_bytes(planes);
}

/// Every 5:6:5 field of the endpoints less that of the block before, round its range.
Words endpoint_differences(const Words& words) {
    constexpr uint32_t kHigh = 0x8410'8410u;  // the top bit of each field, which must not borrow
    Words result = words;
    for (size_t i = 2; i < words.size(); i += 2) {
        const uint32_t a = words[i], b = words[i - 2];
        result[i] = ((a | kHigh) - (b & ~kHigh)) ^ ((a ^ ~b) & kHigh);
    }
    return result;
}

/// Planes, of which that of the index words is in four planes of its own: first rows of four texels, second rows, ...
uint64_t rows_apart_bytes(const Words& words) {
    Words planes(words.size());
    atlas::split_block_planes(words, 2, planes);
    const auto raw = std::as_bytes(std::span(planes));
    std::vector<std::byte> bytes(raw.begin(), raw.end());
    const size_t half = raw.size() / 2, blocks = words.size() / 2;
    for (size_t i = 0; i < half; ++i) bytes[half + i % 4 * blocks + i / 4] = raw[half + i];
    return codec::bits::compress_frame(bytes).size();
}

Words encode_ours(const BlockImage& image, atlas::PartitionSearch search, int rounds, bool steps) {
    atlas::Bc1Options options;
    options.search = search;
    options.rounds = rounds;
    options.steps = steps;
    return atlas::encode_bc1_image(image.rgb, image.width, image.height, options);
}

Words encode_squish(const BlockImage& image, int fit) {
    Words words;
    for (uint32_t y = 0; y < image.height; y += 4) {
        for (uint32_t x = 0; x < image.width; x += 4) {
            squish::u8 rgba[64];
            for (size_t i = 0; i < 16; ++i) {
                std::memcpy(rgba + 4 * i, &image.rgb[3 * ((y + i / 4) * size_t{image.width} + x + i % 4)], 3);
                rgba[4 * i + 3] = 255;
            }
            float equal[3] = {1, 1, 1};
            uint32_t block[2];
            squish::CompressMasked(rgba, 0xFFFF, block, squish::kDxt1 | fit, equal);
            words.insert(words.end(), block, block + 2);
        }
    }
    return words;
}

Words encode_rate(const BlockImage& image, uint32_t lambda, atlas::Bc1RateTotals& totals) {
    atlas::Bc1RateOptions options;
    options.lambda = lambda;
    options.most_rise_per_texel = 4 * lambda + 16;
    atlas::Bc1RateEncoder encoder(options);
    Words words = encoder.encode(atlas::bc1_blocks_of(image.rgb, image.width, image.height));
    totals = encoder.totals();
    return words;
}

struct Encoder {
    std::string name;
    bool standard;  ///< makes three-colour blocks too
    std::function<Words(const BlockImage&)> encode;
};

std::vector<Encoder> encoders() {
    using atlas::PartitionSearch;
    return {
        {"libsquish range fit", true, [](const BlockImage& i) { return encode_squish(i, squish::kColourRangeFit); }},
        {"libsquish cluster fit", true,
         [](const BlockImage& i) { return encode_squish(i, squish::kColourClusterFit); }},
        {"even partitions", false,
         [](const BlockImage& i) { return encode_ours(i, PartitionSearch::kEven, 2, false); }},
        {"all partitions", false, [](const BlockImage& i) { return encode_ours(i, PartitionSearch::kAll, 4, false); }},
        {"all partitions and steps", false,
         [](const BlockImage& i) { return encode_ours(i, PartitionSearch::kAll, 8, true); }}};
}
constexpr size_t kRangeFit = 0, kClusterFit = 1, kOurs = 3;

BlockImage part_of(const BlockImage& image) {
    BlockImage part{image.name, std::min(image.width, kTimedSide), std::min(image.height, kTimedSide), {}};
    for (size_t y = 0; y < part.height; ++y) {
        const uint8_t* row = &image.rgb[3 * y * image.width];
        part.rgb.insert(part.rgb.end(), row, row + 3 * size_t{part.width});
    }
    return part;
}

/// A point of a curve, and curves of one image.
struct Point {
    double psnr, bytes;
};
using Curve = std::vector<Point>;

double log_bytes_at(const Curve& curve, double psnr) {
    for (size_t i = 1; i < curve.size(); ++i) {
        if (psnr > curve[i].psnr && i + 1 < curve.size()) continue;
        const Point &a = curve[i - 1], &b = curve[i];
        return std::log(a.bytes) + (std::log(b.bytes) - std::log(a.bytes)) * (psnr - a.psnr) / (b.psnr - a.psnr);
    }
    return 0;
}

/// Ascending in PSNR, without points that cost more for less.
Curve tidy(Curve curve) {
    std::sort(curve.begin(), curve.end(), [](const Point& a, const Point& b) { return a.psnr < b.psnr; });
    Curve kept;
    for (const Point& point : curve) {
        while (!kept.empty() && kept.back().bytes >= point.bytes) kept.pop_back();
        if (kept.empty() || point.psnr > kept.back().psnr + 1e-6) kept.push_back(point);
    }
    return kept;
}

/// Bytes of `curve` over those of `reference` at equal PSNR, less one; false where they have no range in common.
bool bd_rate(Curve curve, Curve reference, double& ratio) {
    curve = tidy(std::move(curve));
    reference = tidy(std::move(reference));
    if (curve.size() < 2 || reference.size() < 2) return false;
    const double low = std::max(curve.front().psnr, reference.front().psnr);
    const double high = std::min(curve.back().psnr, reference.back().psnr);
    if (high - low < 0.2) return false;
    constexpr int kSteps = 100;
    double sum = 0;
    for (int i = 0; i <= kSteps; ++i) {
        const double psnr = low + (high - low) * i / kSteps;
        sum += log_bytes_at(curve, psnr) - log_bytes_at(reference, psnr);
    }
    ratio = std::exp(sum / (kSteps + 1)) - 1;
    return true;
}

/// Sums over a set's images, by encoder.
struct Totals {
    double psnr = 0;
    uint64_t wire = 0, planes = 0;
    std::vector<double> speed;
};

struct SetResult {
    uint64_t layouts[4][2] = {};  ///< bytes: whole, planes, rows apart, endpoint differences; best blocks and rate 10
    std::vector<std::string> names;  ///< in the order of their first lines
    std::vector<Totals> totals;
    std::vector<double> against_jpeg, against_whole;
    uint64_t texels = 0;

    Totals& of(const std::string& name) {
        const auto place = static_cast<size_t>(std::find(names.begin(), names.end(), name) - names.begin());
        if (place == names.size()) {
            names.push_back(name);
            totals.emplace_back();
        }
        return totals[place];
    }
};

double bits_per_texel(uint64_t bytes, uint64_t texels) {
    return rounded(8.0 * static_cast<double>(bytes) / static_cast<double>(texels));
}

Json line_of(const std::string& set, const BlockImage& image, const std::string& encoder) {
    return {{"set", set}, {"image", image.name}, {"texels", image.texels()}, {"encoder", encoder}};
}

void add_layouts(const Words& words, size_t encoder, SetResult& result) {
    result.layouts[0][encoder] += zstd_bytes(words);
    result.layouts[1][encoder] += planes_bytes(words);
    result.layouts[2][encoder] += rows_apart_bytes(words);
    result.layouts[3][encoder] += planes_bytes(endpoint_differences(words));
}

Point report_words(const std::string& set, const BlockImage& image, const std::string& name, const Words& words,
                   bool standard, Json more, SetResult& result, const BenchProgram& program) {
    const double psnr = psnr_of(image, shown_by_blocks(words, image.width, image.height, standard));
    const uint64_t wire = zstd_bytes(words), planes = planes_bytes(words);
    Totals& totals = result.of(name);
    totals.psnr += psnr;
    totals.wire += wire;
    totals.planes += planes;
    Json line = line_of(set, image, name);
    line.update({{"psnr_db", rounded(psnr)},
                 {"wire_bytes", wire},
                 {"planes_bytes", planes},
                 {"bits_per_texel", bits_per_texel(planes, image.texels())}});
    line.update(more);
    program.print(line);
    return {psnr, static_cast<double>(planes)};
}

/// Each encoder's speed in the same repetitions as the range fit's.
std::vector<Spread> speeds(const BlockImage& image, const std::vector<Encoder>& all, int repetitions) {
    const BlockImage part = part_of(image);
    std::vector<std::function<void()>> work;
    for (const Encoder& encoder : all) work.emplace_back([&encoder, &part] { keep(encoder.encode(part).size()); });
    work.emplace_back([&part] {
        atlas::Bc1RateTotals totals;
        keep(encode_rate(part, 10, totals).size());
    });
    const auto seconds = time_in_turn(work, repetitions);
    std::vector<Spread> result;
    for (const auto& of_encoder : seconds) result.push_back(ratio_of(seconds[kRangeFit], of_encoder));
    return result;
}

void measure_image(const std::string& set, const BlockImage& image, int repetitions, SetResult& result,
                   BenchProgram& program) {
    const std::vector<Encoder> all = encoders();
    const std::vector<Spread> speed = speeds(image, all, repetitions);
    Curve planes, whole, jpeg;
    double psnr[8] = {};
    result.texels += image.texels();
    for (size_t i = 0; i < all.size(); ++i) {
        const Words words = all[i].encode(image);
        const Point point = report_words(set, image, all[i].name, words, all[i].standard,
                                         {{"speed_to_range_fit", to_json(speed[i])}}, result, program);
        result.of(all[i].name).speed.push_back(speed[i].median);
        psnr[i] = point.psnr;
        if (i != kOurs) continue;
        add_layouts(words, 0, result);
        planes.push_back(point);
        whole.push_back({point.psnr, static_cast<double>(zstd_bytes(words))});
    }
    program.check(psnr[kOurs] > psnr[kClusterFit] - 0.05,
                  set + " " + image.name +
                      ": all partitions are within 0.05 dB of the cluster fit, which has the three-colour mode too");
    for (const uint32_t lambda : kLambdas) {
        atlas::Bc1RateTotals totals;
        const Words words = encode_rate(image, lambda, totals);
        const std::string name = "rate " + std::to_string(lambda);
        const Point point =
            report_words(set, image, name, words, false,
                         {{"largest_rise", rounded(static_cast<double>(totals.largest_rise) / 16)}}, result, program);
        if (lambda == 10) {
            result.of(name).speed.push_back(speed.back().median);
            add_layouts(words, 1, result);
        }
        planes.push_back(point);
        whole.push_back({point.psnr, static_cast<double>(zstd_bytes(words))});
        program.check(totals.largest_rise <= 16 * (4 * lambda + 16), image.name + ": no block rises above the bound");
    }
    for (const int quality : kJpegQualities) {
        const JpegResult shown = through_jpeg(image, quality);
        if (!program.check(shown.bytes > 0, "OpenImageIO writes and reads JPEG")) return;
        jpeg.push_back({shown.psnr, static_cast<double>(shown.bytes)});
        Json line = line_of(set, image, "jpeg " + std::to_string(quality));
        line.update({{"psnr_db", rounded(shown.psnr)},
                     {"wire_bytes", shown.bytes},
                     {"bits_per_texel", bits_per_texel(shown.bytes, image.texels())}});
        program.print(line);
    }
    double ratio = 0;
    if (bd_rate(planes, jpeg, ratio)) result.against_jpeg.push_back(ratio);
    if (bd_rate(planes, whole, ratio)) result.against_whole.push_back(ratio);
}

Json percent(const std::vector<double>& ratios) {
    Spread spread = spread_of(ratios);
    return to_json({100 * spread.min, 100 * spread.median, 100 * spread.max});
}

void measure_set(const std::string& set, const std::vector<BlockImage>& images, int repetitions,
                 BenchProgram& program) {
    SetResult result;
    for (const BlockImage& image : images) measure_image(set, image, repetitions, result, program);
    const auto count = static_cast<double>(images.size());
    for (size_t i = 0; i < result.names.size(); ++i) {
        const Totals& totals = result.totals[i];
        Json line{{"set", set}, {"images", images.size()}, {"encoder", result.names[i]}};
        line.update({{"mean_psnr_db", rounded(totals.psnr / count)},
                     {"whole_bits_per_texel", bits_per_texel(totals.wire, result.texels)},
                     {"bits_per_texel", bits_per_texel(totals.planes, result.texels)}});
        if (!totals.speed.empty()) line["speed_to_range_fit"] = to_json(spread_of(totals.speed));
        program.print(line);
    }
    constexpr const char* kLayouts[4] = {"whole blocks", "planes", "planes, index rows apart",
                                         "planes, endpoint differences"};
    for (size_t i = 0; i < 4; ++i) {
        program.print({{"set", set},
                       {"layout", kLayouts[i]},
                       {"best_blocks_bits_per_texel", bits_per_texel(result.layouts[i][0], result.texels)},
                       {"rate_10_bits_per_texel", bits_per_texel(result.layouts[i][1], result.texels)}});
    }
    program.print({{"set", set},
                   {"images", images.size()},
                   {"curve", "rate mode, planes"},
                   {"bd_rate_percent_to_whole_blocks", percent(result.against_whole)},
                   {"bd_rate_percent_to_jpeg", percent(result.against_jpeg)},
                   {"images_in_jpegs_range", result.against_jpeg.size()}});
}

/// A fence of soft-edged posts over a gradient: RGBA.
std::vector<uint8_t> fence(uint32_t side, bool soft) {
    std::mt19937 random(2);
    std::vector<uint8_t> rgba;
    for (uint32_t y = 0; y < side; ++y) {
        for (uint32_t x = 0; x < side; ++x) {
            const double distance = std::abs(static_cast<double>((x + y / 3) % 24) - 12.0) - 5.0;
            const double cover = soft ? std::clamp(0.5 - distance / 3, 0.0, 1.0) : distance < 0 ? 1.0 : 0.0;
            const auto noise = static_cast<int>(random() % 16);
            for (const int base : {90, 70, 50})
                rgba.push_back(static_cast<uint8_t>(base + static_cast<int>(x % 64) / 2 + noise));
            rgba.push_back(static_cast<uint8_t>(255 * cover + 0.5));
        }
    }
    return rgba;
}

struct AlphaError {
    double alpha = 0, colour = 0, seen = 0;

    void add(const uint8_t* shown, const uint8_t* texel) {
        alpha += (shown[3] - texel[3]) * (shown[3] - texel[3]);
        if (texel[3] == 0) return;
        seen += 3;
        for (int c = 0; c < 3; ++c) colour += (shown[c] - texel[c]) * (shown[c] - texel[c]);
    }
};

void block_at(const std::vector<uint8_t>& rgba, uint32_t side, uint32_t x, uint32_t y, uint8_t texels[64]) {
    for (uint32_t row = 0; row < 4; ++row) std::memcpy(texels + 16 * row, &rgba[4 * (size_t{y + row} * side + x)], 16);
}

/// Blocks as the builder makes them.
Words encode_alpha(const std::vector<uint8_t>& rgba, uint32_t side) {
    atlas::ChartImage chart;
    chart.width = chart.height = side;
    for (size_t i = 0; i < rgba.size(); i += 4) {
        chart.rgb.insert(chart.rgb.end(), &rgba[i], &rgba[i + 3]);
        chart.alpha.push_back(rgba[i + 3]);
    }
    atlas::fill_hidden_colours(chart);
    Words words;
    atlas::StepBlocks(words, 0).append(chart);
    return words;
}

void measure_alpha(bool soft, BenchProgram& program) {
    constexpr uint32_t kAlphaSide = 256;
    const std::vector<uint8_t> rgba = fence(kAlphaSide, soft);
    const Words words = encode_alpha(rgba, kAlphaSide);
    AlphaError ours, theirs;
    const uint32_t* block = words.data();
    for (uint32_t y = 0; y < kAlphaSide; y += 4) {
        for (uint32_t x = 0; x < kAlphaSide; x += 4, block += 4) {
            uint8_t texels[64], shown[64];
            block_at(rgba, kAlphaSide, x, y, texels);
            uint32_t peer[4];
            squish::CompressMasked(texels, 0xFFFF, peer, squish::kDxt5 | squish::kColourClusterFit);
            squish::Decompress(shown, peer, squish::kDxt5);
            for (uint32_t i = 0; i < 16; ++i) {
                uint8_t texel[4];
                atlas::decode_bc1_texel(block + 2, i, texel);
                texel[3] = atlas::decode_bc4_texel(block, i);
                ours.add(texel, texels + 4 * i);
                theirs.add(shown + 4 * i, texels + 4 * i);
            }
        }
    }
    const auto rmse = [](double squares, double count) { return rounded(std::sqrt(squares / count)); };
    constexpr double kCount = double{kAlphaSide} * kAlphaSide;
    Words planes(words.size());
    atlas::split_block_planes(words, 4, planes);
    const std::string set = soft ? "soft alpha" : "cut-out alpha";
    program.print({{"set", set},
                   {"encoder", "bc3"},
                   {"alpha_rmse", rmse(ours.alpha, kCount)},
                   {"seen_colour_rmse", rmse(ours.colour, ours.seen)},
                   {"planes_bytes", zstd_bytes(planes)}});
    program.print({{"set", set},
                   {"encoder", "libsquish DXT5 cluster fit"},
                   {"alpha_rmse", rmse(theirs.alpha, kCount)},
                   {"seen_colour_rmse", rmse(theirs.colour, theirs.seen)}});
    program.check(ours.alpha <= theirs.alpha * 1.05 + 1, set + ": alpha as good as libsquish's");
}

std::vector<BlockImage> read_images(const std::vector<std::string>& files, size_t most, BenchProgram& program) {
    std::vector<BlockImage> images;
    for (size_t i = 0; i < std::min(most, files.size()); ++i) {
        BlockImage image =
            read_block_image(files[i * files.size() / std::min(most, files.size())], kMostWidth, kMostHeight);
        if (program.check(!image.rgb.empty(), files[i] + " is a colour image of at least 4 x 4 texels"))
            images.push_back(std::move(image));
    }
    return images;
}

}  // namespace

int main(int argc, char** argv) {
    BenchProgram program({"bench_blocks", kClaim, "photograph.png", false});
    BenchOptions options;
    options.repetitions = 5;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    if (!options.files.empty()) {
        const auto images = read_images(options.files, options.files.size(), program);
        if (!images.empty()) measure_set("files", images, options.repetitions, program);
        return program.exit_code();
    }
    measure_set("procedural", procedural_block_images(), options.repetitions, program);
    for (const bool soft : {false, true}) measure_alpha(soft, program);
    for (const std::string set : {"kodak", "cc0", "facades"}) {
        const auto images = read_images(shared_image_files(set), kMostImages, program);
        if (images.empty()) {
            program.print({{"set", set}, {"skipped", "not in ../shared/data"}});
        } else {
            measure_set(set, images, options.repetitions, program);
        }
    }
    return program.exit_code();
}
