// Claim: pictures lit through the radiance layer are as near to ray-traced ones as its lattice is fine.
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <numeric>
#include <sstream>

#include "client/light/environment_file.h"
#include "client/light/sky_model.h"
#include "client/light/spherical_harmonics.h"
#include "client/light/sun_position.h"
#include "client/reference/sky_reference.h"
#include "client/render/frame_file.h"
#include "client/render/tone.h"
#include "client/report/image_metrics.h"
#include "codec/chart_word_layout.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/child_process.h"
#include "tests/bench/city_heights.h"
#include "tests/bench/number_option.h"
#include "tests/bench/sample_city.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using client::Camera;
using client::EnvironmentMap;
using client::FrameImage;
using client::RadiancePicture;
using client::ReferenceTriangle;
using client::SkyReference;
using tiles::tileset::Layer;

constexpr const char* kClaim =
    "A generated city without pictures, flown by citystream-fly under each environment FILE, or a clear evening sky "
    "without its sun,\n"
    "with radiance layers of several lattices and directions, against the same triangles by rays: --rays^2 a "
    "place, four places a pixel. psnr_db: of the picture; surface_psnr_db: of pixels that show surfaces alone, median "
    "and worst of the\n"
    "cameras. representation: layer, or ambient, the same city without the layer: unshadowed light of nine harmonics. "
    "radiance_bytes:\n"
    "all steps of all tiles, and what part of all layers' bytes they are. --frames keeps pictures and references.";
constexpr uint32_t kPixelAcross = 2, kSkyWidth = 512;
constexpr double kLongestSeconds = 3600;

struct Options {
    std::vector<uint32_t> lattices = {8, 4, 2}, directions = {16, 32}, local_directions = {8};
    uint32_t rays = 16;
    uint32_t width = 320, height = 180;
    bool relief = false;
    std::string frames;
};

std::string program_beside(const std::string& name) {
    return (std::filesystem::canonical("/proc/self/exe").parent_path() / name).string();
}

/// Runs to the end. What matters is what the command leaves.
void run(const std::vector<std::string>& command) {
    ChildProcess child(command);
    child.line_with("\x01", kLongestSeconds);
}

/// With a plain below the horizon of the colour that a tenth of the sky's light makes of it.
EnvironmentMap evening_sky() {
    EnvironmentMap map = client::sky_map(client::ClearSky(client::sun_direction(48, 172, 18), 3), kSkyWidth);
    const auto light = client::harmonic_light(map).irradiance({0, 0, 1}, 5);
    client::Rgb plain{};
    for (size_t c = 0; c < 3; ++c) plain[c] = static_cast<float>(0.1 / std::numbers::pi * light[c]);
    std::fill(map.texels.begin() + static_cast<std::ptrdiff_t>(map.texels.size() / 2), map.texels.end(), plain);
    return map;
}

/// The surfaces of the archive's leaves, exactly, from the city's origin.
Result<std::vector<ReferenceTriangle>> triangles_of(const SampleCity& city, const client::Rgb& albedo) {
    std::vector<ReferenceTriangle> triangles;
    for (const auto* tile : city.leaves()) {
        if (tile->steps(Layer::kMesh).empty()) continue;
        const auto mesh = mesh_of(city, *tile);
        if (!mesh) return mesh.error();
        const GridPoint base = city.manifest.tile_origin(*tile), origin = city.manifest.origin;
        for (size_t i = 0; i + 2 < mesh->indices.size(); i += 3) {
            ReferenceTriangle triangle{{}, albedo};
            for (size_t k = 0; k < 3; ++k) {
                const auto& place = mesh->vertices[mesh->indices[i + k]].position;
                triangle.corners[k] = {to_metres(base.x - origin.x + place[0]), to_metres(base.y - origin.y + place[1]),
                                       to_metres(base.z - origin.z + place[2])};
            }
            triangles.push_back(triangle);
        }
    }
    return triangles;
}

Status write_environment(const EnvironmentMap& map, const std::string& file) {
    const auto out = OIIO::ImageOutput::create(file);
    const OIIO::ImageSpec spec(static_cast<int>(map.width), static_cast<int>(map.height), 3, OIIO::TypeDesc::FLOAT);
    if (!out || !out->open(file, spec) || !out->write_image(OIIO::TypeDesc::FLOAT, map.texels.data()) || !out->close())
        return Error{file + ": cannot be written"};
    return Done{};
}

/// Above the corners, and among the houses.
std::vector<client::CameraSample> cameras_of(const tiles::tileset::Manifest& manifest) {
    const auto& [least, most] = manifest.extent;
    const double x = to_metres(manifest.origin.x) + (least[0] + most[0]) / 2;
    const double y = to_metres(manifest.origin.y) + (least[1] + most[1]) / 2;
    const double half = (most[0] - least[0]) / 2, top = most[2];
    std::vector<client::CameraSample> cameras;
    const auto add = [&](double east, double north, double up, double yaw, double pitch) {
        cameras.push_back(
            {static_cast<double>(cameras.size()), x + east * half, y + north * half, top + up, yaw, pitch, 60});
    };
    add(-0.45, -0.45, 12, 45, -28);
    add(0.45, 0.4, 20, 228, -32);
    add(0.05, -0.5, 3, 350, -12);
    add(0, 0, 60, 10, -75);
    return cameras;
}

/// A sky, how bright it is shown, and what rays make of the city under it.
struct Scene {
    std::string name, file;
    EnvironmentMap map;
    double stops = 0;
    std::vector<RadiancePicture> references;
};

struct City {
    std::string mesh, glb, path;
    std::vector<client::CameraSample> samples;
    std::vector<std::string> source;  ///< what the builder makes it from
};

/// Level white ground is white, about.
double stops_of(const EnvironmentMap& map) {
    const auto light = client::harmonic_light(client::reduced(map, 256)).irradiance({0, 0, 1}, 5);
    return std::round(8 * std::log2(std::numbers::pi / std::max(1e-9, client::luminance(light)))) / 8;
}

Result<SampleCity> build(const City& city, const std::string& archive, const std::vector<std::string>& options) {
    std::vector<std::string> command = {program_beside("citystream-build")};
    command.insert(command.end(), city.source.begin(), city.source.end());
    command.insert(command.end(), {"-o", archive});
    command.insert(command.end(), options.begin(), options.end());
    run(command);
    return open_city(archive);
}

Result<std::vector<FrameImage>> fly(const City& city, const Scene& scene, const std::string& archive,
                                    const Options& options, const std::string& folder) {
    std::filesystem::create_directories(folder);
    run({program_beside("citystream-fly"),
         archive,
         "--path",
         city.path,
         "--fps",
         "1",
         "--size",
         fmt::format("{}x{}", options.width, options.height),
         "--supersample",
         std::to_string(kPixelAcross),
         "--tolerance",
         "0.25",
         "--light-tolerance",
         "0",
         "--environment",
         scene.file,
         "--sun",
         "map",
         "--exposure",
         fmt::format("{}", scene.stops),
         "--frames",
         folder});
    std::vector<FrameImage> frames;
    for (size_t i = 0; i < city.samples.size(); ++i) {
        auto frame = client::read_png(fmt::format("{}/frame_{:05}.png", folder, i));
        if (!frame) return frame.error();
        frames.push_back(std::move(*frame));
    }
    return frames;
}

/// Pixels that show surfaces alone, as one row.
FrameImage surfaces_of(const FrameImage& image, const RadiancePicture& reference) {
    FrameImage kept;
    for (size_t i = 0; i < reference.surface.size(); ++i) {
        if (reference.surface[i] == 0) continue;
        kept.rgba.insert(kept.rgba.end(), image.rgba.begin() + static_cast<std::ptrdiff_t>(4 * i),
                         image.rgba.begin() + static_cast<std::ptrdiff_t>(4 * i + 4));
    }
    kept.width = static_cast<uint32_t>(kept.rgba.size() / 4);
    kept.height = 1;
    return kept;
}

struct Likeness {
    Spread whole, surface;
};

Likeness compare(const std::vector<FrameImage>& frames, const Scene& scene) {
    std::vector<double> whole, surface;
    for (size_t i = 0; i < frames.size(); ++i) {
        const FrameImage truth = shown_picture(scene.references[i], std::exp2(scene.stops));
        whole.push_back(client::psnr(truth, frames[i]));
        surface.push_back(
            client::psnr(surfaces_of(truth, scene.references[i]), surfaces_of(frames[i], scene.references[i])));
    }
    return {spread_of(whole), spread_of(surface)};
}

class Pictures {
  public:
    Pictures(const Options& options, BenchProgram& program) : options_(options), program_(program) {}

    void measure(const BenchOptions& given) {
        if (!make_city(given) || !make_scenes(given) || !draw_references()) return;
        measure_archive("ambient", {"--layers", "mesh"}, {});
        for (const uint32_t lattice : options_.lattices) {
            for (const uint32_t directions : options_.directions) {
                for (const uint32_t local : options_.local_directions)
                    measure_archive("layer",
                                    {"--layers", "mesh,radiance", "--lattice", std::to_string(lattice), "--directions",
                                     std::to_string(directions), "--local-directions", std::to_string(local)},
                                    {{"lattice", lattice}, {"texels_across", directions}, {"local_across", local}});
            }
        }
    }

  private:
    bool holds(const Status& status) { return program_.check(status.ok(), status.ok() ? "" : status.error().text()); }

    bool make_city(const BenchOptions& given) {
        city_.source = {"generate", "--buildings", std::to_string(given.buildings), "--seed",
                        std::to_string(given.seed)};
        city_.glb = folder_ / "city.glb";
        city_.path = folder_ / "path.csv";
        city_.mesh = folder_ / "reference.3tz";
        const auto built = build(city_, city_.mesh, {"--layers", "mesh", "--reference", city_.glb});
        if (!program_.check(built.ok(), built.ok() ? "" : built.error().text())) return false;
        city_.samples = cameras_of(built->manifest);
        std::ofstream path(city_.path);
        path << "t,x,y,z,yaw,pitch,fov\n";
        for (const auto& s : city_.samples)
            path << fmt::format("{},{},{},{},{},{},{}\n", s.t, s.x, s.y, s.z, s.yaw, s.pitch, s.fov);
        return true;
    }

    bool make_scenes(const BenchOptions& given) {
        if (given.files.empty()) {
            scenes_.push_back({"clear-evening", folder_ / "sky.exr", evening_sky(), 0, {}});
            if (!holds(write_environment(scenes_[0].map, scenes_[0].file))) return false;
        }
        for (const auto& file : given.files) {
            auto read = client::read_environment(file);
            if (!program_.check(read.ok(), read.ok() ? "" : read.error().text())) return false;
            scenes_.push_back({std::filesystem::path(file).stem().string(), file, std::move(read->map), 0, {}});
        }
        for (Scene& scene : scenes_) scene.stops = stops_of(scene.map);
        return true;
    }

    Result<SkyReference> make_reference() const {
        const auto grey = static_cast<float>(client::srgb_decoded((CHART_WORD_UNTEXTURED & 0xff) / 255.0));
        const client::Rgb albedo = {grey, grey, grey};
        if (options_.relief) {
            const auto scene = client::load_glb(city_.glb);
            if (!scene) return scene.error();
            return SkyReference::create(*scene, albedo);
        }
        const auto city = open_city(city_.mesh);
        if (!city) return city.error();
        const auto triangles = triangles_of(*city, albedo);
        if (!triangles) return triangles.error();
        const GridPoint& origin = city->manifest.origin;
        return SkyReference::create(*triangles, {to_metres(origin.x), to_metres(origin.y), to_metres(origin.z)});
    }

    bool draw_references() {
        const auto reference = make_reference();
        if (!program_.check(reference.ok(), reference.ok() ? "" : reference.error().text())) return false;
        for (Scene& one : scenes_) {
            for (const auto& sample : city_.samples) {
                const Camera camera = Camera::from_sample(sample, options_.width, options_.height);
                one.references.push_back(
                    reference->draw(camera, one.map, {.across = options_.rays, .pixel_across = kPixelAcross}));
                if (!keep_picture(shown_picture(one.references.back(), std::exp2(one.stops)), one.name + "-reference",
                                  one.references.size() - 1))
                    return false;
            }
        }
        return true;
    }

    bool keep_picture(const FrameImage& picture, const std::string& name, size_t camera) {
        if (options_.frames.empty()) return true;
        std::filesystem::create_directories(options_.frames);
        return holds(client::write_png(fmt::format("{}/{}-{}.png", options_.frames, name, camera), picture));
    }

    void measure_archive(const std::string& representation, const std::vector<std::string>& build_options,
                         const Json& form) {
        const std::string archive = folder_ / "city.3tz";
        const auto built = build(city_, archive, build_options);
        if (!program_.check(built.ok(), built.ok() ? "" : built.error().text())) return;
        const auto& bytes = built->manifest.wire_bytes;
        const uint64_t radiance = bytes[static_cast<size_t>(Layer::kRadiance)];
        const uint64_t all = std::accumulate(bytes.begin(), bytes.end(), uint64_t{0});
        for (const Scene& scene : scenes_) {
            const auto frames = fly(city_, scene, archive, options_, folder_ / "frames");
            if (!program_.check(frames.ok(), frames.ok() ? "" : frames.error().text())) return;
            const Likeness likeness = compare(*frames, scene);
            Json line{{"environment", scene.name}, {"representation", representation}};
            std::string name = scene.name + "-" + representation;
            for (const auto& [key, value] : form.items()) {
                line[key] = value;
                name += "-" + value.dump();
            }
            line.update({{"cameras", frames->size()},
                         {"rays_a_pixel", options_.rays * options_.rays * kPixelAcross * kPixelAcross},
                         {"psnr_db", to_json(likeness.whole)},
                         {"surface_psnr_db", to_json(likeness.surface)},
                         {"radiance_bytes", radiance},
                         {"radiance_share", rounded(static_cast<double>(radiance) / static_cast<double>(all))}});
            program_.print(line);
            for (size_t i = 0; i < frames->size(); ++i) {
                if (!keep_picture((*frames)[i], name, i)) return;
            }
        }
    }

    const Options& options_;
    BenchProgram& program_;
    TemporaryFolder folder_;
    City city_;
    std::vector<Scene> scenes_;
};

/// Numbers with commas between them.
bool take_numbers(const std::string& text, uint32_t most, std::vector<uint32_t>& numbers) {
    numbers.clear();
    std::istringstream parts(text);
    for (std::string part; std::getline(parts, part, ',');) {
        uint32_t number = 0;
        if (!take_number(part, 1U, most, number)) return false;
        numbers.push_back(number);
    }
    return !numbers.empty();
}

std::vector<BenchOption> options_of(Options& options) {
    return {{"--lattices", "metres between receivers, with commas between them (default 8,4,2)",
             [&](const std::string& text) { return take_numbers(text, 64, options.lattices); }},
            {"--directions", "texels on a side of the source's cube, with commas between them (default 16,32)",
             [&](const std::string& text) { return take_numbers(text, 64, options.directions); }},
            {"--local-directions", "on a side of a receiver's square of directions, with commas (default 8)",
             [&](const std::string& text) { return take_numbers(text, 32, options.local_directions); }},
            {"--rays", "of a place of a pixel, squared, 1 to 256 (default 16: 1024 rays a pixel)",
             [&](const std::string& text) { return take_number(text, 1U, 256U, options.rays); }},
            {"--relief", "yes: references show the facades' relief (citystream-build --reference); no (the default)",
             [&](const std::string& text) {
                 options.relief = text == "yes";
                 return options.relief || text == "no";
             }},
            {"--frames", "folder in which pictures are kept", [&](const std::string& text) {
                 options.frames = text;
                 return !text.empty();
             }}};
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    BenchDescription description{"bench_sky_pictures", kClaim, "sky.hdr"};
    description.options = options_of(options);
    BenchProgram program(description);
    BenchOptions given;
    given.buildings = 12;
    if (!program.read_arguments(argc, argv, given)) return program.exit_code();
    Pictures(options, program).measure(given);
    return program.exit_code();
}
