// Claim: facade maps on the grid of their runs are small where they are kept as well as where they are sent.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <lzma.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>

#include "codec/bits/zstd_frame.h"
#include "codec/facade/facade_map.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/sample_city.h"
#include "tiles/city/generator.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::codec::facade;

constexpr const char* kClaim =
    "Displacement (int16) and material (uint8) maps of facades: raw arrays, PNG (16 bit and 8 bit grey), xz -9, zstd "
    "-19, and our run-grid\n"
    "map kept as it is and sent with zstd -19. resident_bytes: what random access needs. *_to_ours: over our figure. "
    "Then the cells that a ray\n"
    "crosses in cast_facade_ray, counted from its hits, by the angle between ray and wall normal. Every map is decoded "
    "and compared.\n"
    "FILEs are facades.json folders of rasters: FOLDER/*_depth.png with FOLDER/*_material.png.";
constexpr size_t kMostMaps = 16;

using Bytes = std::vector<std::byte>;

struct RawMap {
    Bytes displacement, material;
};

RawMap raw_of(const FacadeImage& image) {
    const auto depth = std::as_bytes(std::span(image.displacement_mm));
    const auto slots = std::as_bytes(std::span(image.material));
    return {{depth.begin(), depth.end()}, {slots.begin(), slots.end()}};
}

Bytes xz(const Bytes& raw) {
    Bytes out(lzma_stream_buffer_bound(raw.size()));
    size_t size = 0;
    const auto result =
        lzma_easy_buffer_encode(9, LZMA_CHECK_CRC64, nullptr, reinterpret_cast<const uint8_t*>(raw.data()), raw.size(),
                                reinterpret_cast<uint8_t*>(out.data()), &size, out.size());
    out.resize(result == LZMA_OK ? size : 0);
    return out;
}

uint64_t png_bytes(const void* pixels, const FacadeImage& image, OIIO::TypeDesc type) {
    std::vector<unsigned char> file;
    OIIO::Filesystem::IOVecOutput memory(file);
    const auto output = OIIO::ImageOutput::create("map.png", &memory);
    OIIO::ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height), 1, type);
    spec.attribute("png:compressionLevel", 9);
    if (!output || !output->open("map.png", spec) || !output->write_image(type, pixels) || !output->close()) return 0;
    return file.size();
}

uint64_t png_bytes(const FacadeImage& image) {
    std::vector<uint16_t> depth;
    for (const int16_t value : image.displacement_mm) depth.push_back(static_cast<uint16_t>(value + 32768));
    return png_bytes(depth.data(), image, OIIO::TypeDesc::UINT16) +
           png_bytes(image.material.data(), image, OIIO::TypeDesc::UINT8);
}

struct Sums {
    uint64_t maps = 0, texels = 0, cells = 0, raw = 0, png = 0, xz = 0, zstd = 0, ours_resident = 0, ours_wire = 0;
};

void add(const FacadeImage& image, const std::vector<uint32_t>& words, Sums& sums, BenchProgram& program) {
    const auto decoded = decode_facade_map(words);
    program.check(decoded.ok() && *decoded == image, "a map decodes to the image it was made of");
    const auto view = FacadeMapView::create(words);
    const RawMap raw = raw_of(image);
    ++sums.maps;
    sums.texels += image.material.size();
    sums.cells += view ? uint64_t{view->columns()} * view->rows() : 0;
    sums.raw += raw.displacement.size() + raw.material.size();
    const uint64_t png = png_bytes(image);
    program.check(png > 0, "OpenImageIO writes the PNG");
    sums.png += png;
    sums.xz += xz(raw.displacement).size() + xz(raw.material).size();
    sums.zstd +=
        codec::bits::compress_frame(raw.displacement).size() + codec::bits::compress_frame(raw.material).size();
    sums.ours_resident += words.size() * 4;
    sums.ours_wire += codec::bits::compress_frame(std::as_bytes(std::span(words))).size();
}

void print_sums(const std::string& set, const Sums& sums, BenchProgram& program) {
    const auto line = [&](const char* representation, uint64_t wire, uint64_t resident) {
        const auto ratio = [](uint64_t a, uint64_t b) {
            return rounded(static_cast<double>(a) / static_cast<double>(b));
        };
        program.print({{"set", set},
                       {"representation", representation},
                       {"maps", sums.maps},
                       {"texels", sums.texels},
                       {"wire_bytes", wire},
                       {"resident_bytes", resident},
                       {"wire_to_ours", ratio(wire, sums.ours_wire)},
                       {"resident_to_ours", ratio(resident, sums.ours_resident)},
                       {"wire_bits_per_texel", ratio(8 * wire, sums.texels)}});
    };
    line("citystream run-grid map + zstd -19", sums.ours_wire, sums.ours_resident);
    line("raw", sums.raw, sums.raw);
    line("PNG", sums.png, sums.raw);
    line("xz -9", sums.xz, sums.raw);
    line("zstd -19", sums.zstd, sums.raw);
}

/// Time to bring a map to where rays can be cast (check), and back to arrays, over copying the raw arrays.
void measure_decoding(const std::string& set, const std::vector<FacadeImage>& images,
                      const std::vector<std::vector<uint32_t>>& maps, int repetitions, BenchProgram& program) {
    const std::vector<std::function<void()>> work = {[&] {
                                                         for (const auto& words : maps)
                                                             keep(FacadeMapView::create(words).ok());
                                                     },
                                                     [&] {
                                                         for (const auto& words : maps)
                                                             keep(decode_facade_map(words)->width);
                                                     },
                                                     [&] {
                                                         for (const auto& image : images) {
                                                             const FacadeImage copy = image;
                                                             keep(copy.material.data());
                                                         }
                                                     }};
    const auto seconds = time_in_turn(work, repetitions);
    program.print({{"set", set},
                   {"case", "decoding"},
                   {"maps", maps.size()},
                   {"check_to_raw_copy", to_json(ratio_of(seconds[0], seconds[2]))},
                   {"expand_to_raw_copy", to_json(ratio_of(seconds[1], seconds[2]))}});
}

/// Cells between two coordinates of one axis: breaks strictly between them.
template <typename Break>
uint32_t breaks_between(double a, double b, uint32_t count, Break at) {
    uint32_t crossed = 0;
    for (uint32_t i = 1; i < count; ++i) crossed += at(i) > std::min(a, b) && at(i) < std::max(a, b) ? 1 : 0;
    return crossed;
}

struct RayCount {
    uint64_t rays = 0, hits = 0, cells = 0;
};

/// Rays on a 16 x 16 raster of the wall, from outside, tilted by `degrees` in 8 directions.
void cast_rays(const FacadeMapView& map, double degrees, RayCount& count, bool& inside) {
    const double tilt = degrees * std::numbers::pi / 180;
    for (int i = 0; i < 256; ++i) {
        const double turn = (i % 8 + 0.37) * std::numbers::pi / 4;
        const double origin[3] = {(i % 16 + 0.43) / 16 * map.width(), (i / 16 + 0.57) / 16 * map.height(),
                                  map.depth_max_mm() + 1e-3};
        // A texel is 10 mm: u and v go in texels, w in millimetres.
        const double direction[3] = {std::sin(tilt) * std::cos(turn) / 10, std::sin(tilt) * std::sin(turn) / 10,
                                     -std::cos(tilt)};
        const FacadeRayHit hit = cast_facade_ray(map, origin, direction);
        ++count.rays;
        if (!hit.hit) continue;
        ++count.hits;
        const double u = origin[0] + hit.t * direction[0], v = origin[1] + hit.t * direction[1];
        inside = inside && u > -1e-6 && v > -1e-6 && u < map.width() + 1e-6 && v < map.height() + 1e-6;
        count.cells += 1 + breaks_between(origin[0], u, map.columns(), [&](uint32_t k) { return map.x_break(k); }) +
                       breaks_between(origin[1], v, map.rows(), [&](uint32_t k) { return map.y_break(k); });
    }
}

void measure_rays(const std::string& set, const std::vector<std::vector<uint32_t>>& maps, BenchProgram& program) {
    bool inside = true;
    for (const double degrees : {0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0}) {
        RayCount count;
        uint64_t most = 0;
        for (const auto& words : maps) {
            const auto view = FacadeMapView::create(words);
            if (!view) continue;
            cast_rays(*view, degrees, count, inside);
            most += 256 * (uint64_t{view->columns()} + view->rows() + 2);
        }
        const double cells = static_cast<double>(count.cells) / static_cast<double>(std::max<uint64_t>(count.hits, 1));
        program.print(
            {{"set", set},
             {"case", "rays"},
             {"degrees", degrees},
             {"rays", count.rays},
             {"hits", count.hits},
             {"cells_per_hit", rounded(cells)},
             {"ratio_to_worst_case", rounded(cells * static_cast<double>(count.rays) / static_cast<double>(most))}});
    }
    program.check(inside, "every hit lies on the facade");
}

void measure_set(const std::string& set, const std::vector<FacadeImage>& images, int repetitions,
                 BenchProgram& program) {
    Sums sums;
    std::vector<std::vector<uint32_t>> maps;
    for (const FacadeImage& image : images) {
        auto words = encode_facade_map(image);
        if (!program.check(words.ok(), words.ok() ? "" : words.error().text())) continue;
        add(image, *words, sums, program);
        maps.push_back(std::move(*words));
    }
    if (maps.empty()) return;
    print_sums(set, sums, program);
    measure_decoding(set, images, maps, repetitions, program);
    measure_rays(set, maps, program);
}

std::vector<FacadeImage> generated_maps(const BenchOptions& options) {
    tiles::city::GeneratorOptions generator;
    generator.buildings = options.buildings;
    generator.seed = options.seed;
    tiles::city::CityHeader header;
    tiles::city::CityCatalog catalog;
    tiles::city::CityReport report;
    tiles::city::generate_city(generator, header, catalog, report, [](tiles::city::CityObject&&) { return true; });
    std::vector<FacadeImage> images;
    const size_t count = std::min(kMostMaps, catalog.facade_maps.size());
    for (size_t i = 0; i < count; ++i) {
        auto image = decode_facade_map(catalog.facade_maps[i * catalog.facade_maps.size() / count]);
        if (image) images.push_back(std::move(*image));
    }
    return images;
}

std::vector<uint16_t> read_grey(const std::string& path, int& width, int& height) {
    const auto input = OIIO::ImageInput::open(path);
    if (!input || input->spec().nchannels != 1) return {};
    width = input->spec().width;
    height = input->spec().height;
    std::vector<uint16_t> pixels(static_cast<size_t>(width) * static_cast<size_t>(height));
    // Read in the file's own type: a conversion from 8 bits would stretch the numbers.
    if (input->spec().format == OIIO::TypeDesc::UINT16)
        return input->read_image(0, 0, 0, 1, OIIO::TypeDesc::UINT16, pixels.data()) ? pixels : std::vector<uint16_t>{};
    std::vector<uint8_t> bytes(pixels.size());
    if (!input->read_image(0, 0, 0, 1, OIIO::TypeDesc::UINT8, bytes.data())) return {};
    std::copy(bytes.begin(), bytes.end(), pixels.begin());
    return pixels;
}

/// One facade of a raster folder; materials are numbered by first use, and the last slot takes those past 15.
FacadeImage read_raster(const std::string& depth_file, const std::string& material_file) {
    FacadeImage image;
    int width = 0, height = 0, width2 = 0, height2 = 0;
    const auto depth = read_grey(depth_file, width, height), material = read_grey(material_file, width2, height2);
    if (depth.empty() || width != width2 || height != height2) return {};
    image.width = static_cast<uint32_t>(width);
    image.height = static_cast<uint32_t>(height);
    std::map<uint16_t, uint8_t> slots;
    for (uint32_t row = image.height; row-- > 0;) {  // PNG rows run downwards
        for (uint32_t column = 0; column < image.width; ++column) {
            const size_t at = size_t{row} * image.width + column;
            image.displacement_mm.push_back(static_cast<int16_t>(depth[at] - 32768));
            const auto next = static_cast<uint8_t>(std::min<size_t>(slots.size(), 15));
            image.material.push_back(slots.try_emplace(material[at], next).first->second);
        }
    }
    return image;
}

std::vector<FacadeImage> raster_maps(const std::string& folder) {
    std::vector<std::string> files;
    for (const auto& file : std::filesystem::directory_iterator(folder)) {
        const std::string path = file.path().string();
        if (path.ends_with("_depth.png")) files.push_back(path);
    }
    std::sort(files.begin(), files.end());
    std::vector<FacadeImage> images;
    for (const auto& file : files) {
        auto image = read_raster(file, file.substr(0, file.size() - std::strlen("_depth.png")) + "_material.png");
        if (image.width > 0) images.push_back(std::move(image));
    }
    return images;
}

}  // namespace

int main(int argc, char** argv) {
    BenchProgram program({"bench_facade", kClaim, "FOLDER"});
    BenchOptions options;
    options.buildings = 300;
    options.files = {};
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    measure_set("generated:" + std::to_string(options.buildings), generated_maps(options), options.repetitions,
                program);
    const std::string surveyed = CITYSTREAM_SOURCE_DIR "/../shared/data/ingolstadt_facade_rasters";
    if (options.files.empty() && std::filesystem::exists(surveyed)) options.files.push_back(surveyed);
    if (options.files.empty()) program.print_skipped("no raster folder given and none in ../shared/data");
    for (const auto& folder : options.files) {
        const auto images = raster_maps(folder);
        program.check(!images.empty(), folder + " holds rasters");
        measure_set(std::filesystem::path(folder).filename().string(), images, options.repetitions, program);
    }
    return program.exit_code();
}
