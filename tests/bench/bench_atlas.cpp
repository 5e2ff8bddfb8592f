// Claim: what our BC1 encoder costs and how good it is, against libsquish's range fit and cluster fit.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <squish.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "codec/atlas/atlas_layer.h"
#include "codec/atlas/bc1.h"
#include "codec/bits/zstd_frame.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/sample_city.h"
#include "tiles/city/generator.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using codec::atlas::ChartImage;

constexpr const char* kClaim =
    "BC1 of procedural textures and photographs: our encoder, libsquish range fit and cluster fit (equal weights, "
    "decoded by one decoder).\n"
    "psnr_db over all three channels. speed_to_range_fit: Mtexel/s over those of the range fit, on a 256 x 256 part. "
    "wire_bytes: blocks of the\n"
    "finest mip after zstd -19; png_bytes and rgb_zstd_bytes of the same image without loss. FILEs are images.";
constexpr size_t kMostTextures = 6, kMostPhotographs = 6;
constexpr uint32_t kTimedSide = 256;

using Blocks = std::vector<uint32_t>;

/// Whole blocks only: sizes are cut to multiples of 4 when an image is read.
template <typename EncodeBlock>
Blocks encode_image(const ChartImage& image, EncodeBlock encode_block) {
    Blocks blocks;
    blocks.reserve(size_t{image.width} / 4 * (image.height / 4) * 2);
    for (uint32_t y = 0; y < image.height; y += 4) {
        for (uint32_t x = 0; x < image.width; x += 4) {
            uint8_t texels[48];
            for (uint32_t row = 0; row < 4; ++row)
                std::memcpy(texels + 12 * row, &image.rgb[3 * (size_t{y + row} * image.width + x)], 12);
            uint32_t block[2];
            encode_block(texels, block);
            blocks.insert(blocks.end(), block, block + 2);
        }
    }
    return blocks;
}

Blocks encode_ours(const ChartImage& image) {
    return encode_image(image,
                        [](const uint8_t* texels, uint32_t* block) { codec::atlas::encode_bc1_block(texels, block); });
}

Blocks encode_squish(const ChartImage& image, int fit) {
    return encode_image(image, [fit](const uint8_t* texels, uint32_t* block) {
        squish::u8 rgba[64];
        for (size_t i = 0; i < 16; ++i) {
            std::memcpy(rgba + 4 * i, texels + 3 * i, 3);
            rgba[4 * i + 3] = 255;
        }
        float equal[3] = {1, 1, 1};
        squish::CompressMasked(rgba, 0xFFFF, block, squish::kDxt1 | fit, equal);
    });
}

/// Colours of a block as BC1 decoders show them, three-colour mode included (squish may use it).
void decode_block(const uint32_t block[2], uint8_t rgb[48]) {
    if ((block[0] & 0xFFFF) > (block[0] >> 16)) {
        for (uint32_t i = 0; i < 16; ++i) codec::atlas::decode_bc1_texel(block, i, rgb + 3 * i);
        return;
    }
    squish::u8 rgba[64];
    squish::Decompress(rgba, block, squish::kDxt1);
    for (size_t i = 0; i < 16; ++i) std::memcpy(rgb + 3 * i, rgba + 4 * i, 3);
}

double psnr(const ChartImage& image, const Blocks& blocks) {
    double squares = 0;
    size_t at = 0;
    for (uint32_t y = 0; y < image.height; y += 4) {
        for (uint32_t x = 0; x < image.width; x += 4, at += 2) {
            uint8_t rgb[48];
            decode_block(&blocks[at], rgb);
            for (uint32_t i = 0; i < 48; ++i) {
                const double difference = rgb[i] - image.rgb[3 * (size_t{y + i / 12} * image.width + x) + i % 12];
                squares += difference * difference;
            }
        }
    }
    return 10 * std::log10(255.0 * 255.0 / std::max(squares / static_cast<double>(image.rgb.size()), 1e-9));
}

ChartImage part_of(const ChartImage& image, uint32_t width, uint32_t height) {
    ChartImage part;
    part.width = std::min(image.width, width) / 4 * 4;
    part.height = std::min(image.height, height) / 4 * 4;
    part.metres_per_texel = 0.01F;
    for (uint32_t y = 0; y < part.height; ++y) {
        const auto row = image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * size_t{y} * image.width);
        part.rgb.insert(part.rgb.end(), row, row + static_cast<std::ptrdiff_t>(3 * size_t{part.width}));
    }
    return part;
}

uint64_t png_bytes(const ChartImage& image) {
    std::vector<unsigned char> file;
    OIIO::Filesystem::IOVecOutput memory(file);
    const auto output = OIIO::ImageOutput::create("image.png", &memory);
    OIIO::ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height), 3, OIIO::TypeDesc::UINT8);
    spec.attribute("png:compressionLevel", 9);
    const bool written = output && output->open("image.png", spec) &&
                         output->write_image(OIIO::TypeDesc::UINT8, image.rgb.data()) && output->close();
    return written ? file.size() : 0;
}

/// The layer's texels of mip 0 are those of our blocks, after zstd and back.
bool layer_round_trips(const ChartImage& image, const Blocks& blocks) {
    std::vector<uint32_t> words, step_words;
    for (const LayerStep& step : codec::atlas::encode_atlas(std::span(&image, 1))) {
        const auto raw = std::as_bytes(std::span(step.words));
        const auto back = codec::bits::decompress_frame(codec::bits::compress_frame(raw, 3), raw.size());
        if (!back || !std::equal(back->begin(), back->end(), raw.begin())) return false;
        words.insert(words.end(), step.words.begin(), step.words.end());
        step_words.push_back(static_cast<uint32_t>(step.words.size()));
    }
    const auto view = codec::atlas::AtlasLayerView::create(words, step_words);
    if (!view || view->finest_mip() != 0) return false;
    for (uint32_t i = 0; i < image.width * image.height; i += 5) {
        const uint32_t x = i % image.width, y = i / image.width;
        uint8_t shown[3], expected[3];
        view->texel(0, 0, x, y, shown);
        codec::atlas::decode_bc1_texel(&blocks[2 * (size_t{y / 4} * (image.width / 4) + x / 4)], y % 4 * 4 + x % 4,
                                       expected);
        if (std::memcmp(shown, expected, 3) != 0) return false;
    }
    return true;
}

struct Encoder {
    const char* name;
    std::function<Blocks(const ChartImage&)> encode;
};

struct Totals {
    std::vector<double> psnr;
    std::vector<std::vector<double>> seconds;  ///< by repetition
    uint64_t wire = 0;
};

void measure_set(const std::string& set, const std::vector<ChartImage>& images, int repetitions,
                 BenchProgram& program) {
    const std::vector<Encoder> encoders = {
        {"citystream", encode_ours},
        {"libsquish range fit", [](const ChartImage& i) { return encode_squish(i, squish::kColourRangeFit); }},
        {"libsquish cluster fit", [](const ChartImage& i) { return encode_squish(i, squish::kColourClusterFit); }}};
    std::vector<Totals> totals(encoders.size());
    uint64_t texels = 0, png = 0, rgb = 0;
    std::vector<std::vector<double>> speed(encoders.size()), rate(encoders.size());
    for (const ChartImage& image : images) {
        texels += uint64_t{image.width} * image.height;
        png += png_bytes(image);
        rgb += codec::bits::compress_frame(std::as_bytes(std::span(image.rgb))).size();
        for (size_t i = 0; i < encoders.size(); ++i) {
            const Blocks blocks = encoders[i].encode(image);
            totals[i].psnr.push_back(psnr(image, blocks));
            totals[i].wire += codec::bits::compress_frame(std::as_bytes(std::span(blocks))).size();
            if (i == 0)
                program.check(layer_round_trips(image, blocks), set + ": the atlas layer shows the encoder's blocks");
        }
        const ChartImage part = part_of(image, kTimedSide, kTimedSide);
        std::vector<std::function<void()>> work;
        for (const Encoder& encoder : encoders)
            work.emplace_back([&encoder, &part] { keep(encoder.encode(part).size()); });
        const auto seconds = time_in_turn(work, repetitions);
        for (size_t i = 0; i < encoders.size(); ++i) {
            for (int r = 0; r < repetitions; ++r) {
                const auto at = static_cast<size_t>(r);
                speed[i].push_back(seconds[1][at] / seconds[i][at]);
                rate[i].push_back(static_cast<double>(part.rgb.size()) / 3e6 / seconds[i][at]);
            }
        }
    }
    const auto ratio = [](uint64_t a, uint64_t b) { return rounded(static_cast<double>(a) / static_cast<double>(b)); };
    for (size_t i = 0; i < encoders.size(); ++i) {
        std::vector<double> gain;
        for (size_t k = 0; k < images.size(); ++k) gain.push_back(totals[i].psnr[k] - totals[1].psnr[k]);
        program.print({{"set", set},
                       {"encoder", encoders[i].name},
                       {"images", images.size()},
                       {"texels", texels},
                       {"psnr_db", to_json(spread_of(totals[i].psnr))},
                       {"psnr_over_range_fit_db", to_json(spread_of(gain))},
                       {"speed_to_range_fit", to_json(spread_of(speed[i]))},
                       {"mtexel_per_s", to_json(spread_of(rate[i]))},
                       {"wire_bytes", totals[i].wire},
                       {"wire_bits_per_texel", ratio(8 * totals[i].wire, texels)},
                       {"wire_to_png", ratio(totals[i].wire, png)},
                       {"resident_to_rgba8", 0.125},
                       {"png_bytes", png},
                       {"rgb_zstd_bytes", rgb}});
    }
    program.check(png > 0, "OpenImageIO writes the PNG");
    program.check(spread_of(totals[0].psnr).min > 20, set + ": our encoder keeps every image above 20 dB");
}

std::vector<ChartImage> procedural_textures(const BenchOptions& options) {
    tiles::city::GeneratorOptions generator;
    generator.buildings = options.buildings;
    generator.seed = options.seed;
    tiles::city::CityHeader header;
    tiles::city::CityCatalog catalog;
    tiles::city::CityReport report;
    tiles::city::generate_city(generator, header, catalog, report, [](tiles::city::CityObject&&) { return true; });
    std::vector<const tiles::city::Image*> found;
    for (const auto& source : catalog.images) {
        if (source.pixels && source.pixels->width >= 4 && source.pixels->height >= 4)
            found.push_back(source.pixels.get());
    }
    std::vector<ChartImage> images;
    const size_t count = std::min(kMostTextures, found.size());
    for (size_t i = 0; i < count; ++i) {
        const auto& image = *found[i * found.size() / count];
        ChartImage whole;
        whole.width = image.width;
        whole.height = image.height;
        whole.rgb = image.rgb;
        images.push_back(part_of(whole, image.width, image.height));
    }
    return images;
}

ChartImage read_photograph(const std::string& file) {
    const auto input = OIIO::ImageInput::open(file);
    if (!input || input->spec().nchannels < 3) return {};
    ChartImage whole;
    whole.width = static_cast<uint32_t>(input->spec().width);
    whole.height = static_cast<uint32_t>(input->spec().height);
    whole.rgb.resize(3 * size_t{whole.width} * whole.height);
    if (!input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, whole.rgb.data())) return {};
    return part_of(whole, 4096, 4096);
}

std::vector<std::string> kodak_files() {
    const std::filesystem::path folder = CITYSTREAM_SOURCE_DIR "/../shared/data/kodak";
    std::vector<std::string> files;
    if (!std::filesystem::exists(folder)) return files;
    for (const auto& file : std::filesystem::directory_iterator(folder)) {
        if (file.path().extension() == ".png") files.push_back(file.path().string());
    }
    std::sort(files.begin(), files.end());
    files.resize(std::min(files.size(), kMostPhotographs));
    return files;
}

}  // namespace

int main(int argc, char** argv) {
    BenchProgram program({"bench_atlas", kClaim, "photograph.png"});
    BenchOptions options;
    options.buildings = 30;
    options.repetitions = 5;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    const auto textures = procedural_textures(options);
    if (program.check(!textures.empty(), "the generator makes textures"))
        measure_set("procedural", textures, options.repetitions, program);
    std::string set = "files";
    if (options.files.empty()) {
        options.files = kodak_files();
        set = "kodak";
    }
    std::vector<ChartImage> photographs;
    for (const auto& file : options.files) {
        photographs.push_back(read_photograph(file));
        if (!program.check(!photographs.back().rgb.empty(), file + " is a colour image of at least 4 x 4 texels"))
            photographs.pop_back();
    }
    if (photographs.empty()) {
        program.print_skipped("no photographs given and none in ../shared/data/kodak");
    } else {
        measure_set(set, photographs, options.repetitions, program);
    }
    return program.exit_code();
}
