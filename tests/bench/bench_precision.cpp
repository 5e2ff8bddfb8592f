// Claim: positions whose low bits follow the distance take a third of floats and cost three bits a vertex a level.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <set>

#include "client/render/precision_merger.h"
#include "codec/bits/zstd_frame.h"
#include "codec/mesh/constrained_precision.h"
#include "codec/mesh/depth_order.h"
#include "codec/mesh/triangle_tree.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/mesh_files.h"
#include "tests/bench/precision_models.h"
#include "tests/bench/thesis_precision.h"
#include "tests/client/render/creased_model.h"
#include "tests/client/render/precision_picture.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace codec::mesh;
using client::Camera;

constexpr const char* kClaim =
    "Adaptive (AP) and constrained precision (CAP) of positions in sub-meshes, half a pixel allowed at 1080 pixels, "
    "after Meyer 2012, chapter 3.\n"
    "memory: the camera stands where the average bit level is as near `level` as it gets; percent of float3 with "
    "headers; paper_ap is 3 b / 96.\n"
    "path: a rotation that fills the screen and a dolly; bytes a vertex that the first frame needs, then planes, "
    "against "
    "fixed 16 bits.\n"
    "picture: PSNR to full precision, 1080 x 1080 pixels of 16 samples, Blinn-Phong; AP and CAP as they read missing "
    "bits;\n"
    "bytes: of positions, percent of floats. Of CAP_thirds edge_error_percent, the share of its squared error in "
    "pixels\n"
    "next to an edge of the picture (9 pixels that span 16 of 255), and inside_db, PSNR of the others; moved_db: full\n"
    "precision seen from so far aside that the model's middle moves by half of the allowed pixels. planes: bits a "
    "vertex\n"
    "after zstd -19, each plane on its own.\n"
    "detail: bytes of positions against fixed 16 bits of precision alone, of clustering vertices in cells of the "
    "allowed "
    "error alone, of both.\n"
    "depth: what keeping objects from running into each other asks for. change: all parts a level up, nanoseconds a "
    "vertex.\n"
    "thesis memory, thesis picture: its own figures.";
constexpr int kModelBits = 20;
constexpr uint32_t kCommonDropped = 16;
constexpr double kViewPixels = 1080, kFov = 60 * M_PI / 180;
constexpr double kSlope = 0.3;
constexpr size_t kPartTriangles = 6000;

DropRule rule_at(double pixels, Reconstruction reading = Reconstruction::kLow) {
    return drop_rule({pixels, kViewPixels, 2 * std::tan(kFov / 2), 1}, 1, kCommonDropped, reading);
}

constexpr const char* kReadingNames[] = {"low", "middle", "thirds"};

struct Variant {
    std::string name;
    Reconstruction reading = Reconstruction::kLow;
    std::vector<PackedPart> parts;

    uint64_t vertices() const {
        uint64_t count = 0;
        for (const auto& part : parts) count += part.positions.shape.vertices;
        return count;
    }
};

/// Connected parts of a mesh, by the places that triangles share.
std::vector<uint32_t> objects_of(const PrecisionPart& part) {
    std::map<codec::mesh::GridPoint, uint32_t> place;
    std::vector<uint32_t> parent;
    const auto root = [&](uint32_t p) {
        while (parent[p] != p) p = parent[p] = parent[parent[p]];
        return p;
    };
    std::vector<uint32_t> place_of;
    for (const codec::mesh::GridPoint& point : part.points) {
        const auto [entry, fresh] = place.insert({point, static_cast<uint32_t>(parent.size())});
        if (fresh) parent.push_back(entry->second);
        place_of.push_back(entry->second);
    }
    for (const auto& [a, b, c] : part.triangles) {
        parent[root(place_of[a])] = root(place_of[b]);
        parent[root(place_of[b])] = root(place_of[c]);
    }
    std::vector<uint32_t> object;
    for (const auto& triangle : part.triangles) object.push_back(root(place_of[triangle[0]]));
    return object;
}

enum class Constraint { kNone, kShading, kShadingAndDepth };
constexpr const char* kConstraintNames[] = {"AP", "CAP", "CAP_depth"};

std::vector<uint32_t> most_dropped(const PrecisionPart& part, Constraint constraint, const PrecisionGrid& grid) {
    if (constraint == Constraint::kNone) return {};
    const std::vector<double> normals = part.corner_normals();
    const std::vector<AttributeLimit> limits = {{normals, 3, 1.0 / 255, kSlope}};
    auto most = constrained_dropped(part.points, part.triangles, limits, part.on_border, kCommonDropped);
    if (constraint == Constraint::kShading) return most;
    const auto depth = depth_order_dropped(part.points, part.triangles, objects_of(part), grid);
    for (size_t v = 0; v < most.size(); ++v) {
        if (part.on_border[v] == 0) most[v] = std::min(most[v], depth[v]);
    }
    return most;
}

Variant pack_model(const PrecisionModel& model, Constraint constraint, Reconstruction reading) {
    Variant variant{kConstraintNames[static_cast<size_t>(constraint)], reading, {}};
    for (const PrecisionPart& part : model.parts) {
        const auto most = most_dropped(part, constraint, grid_of(part.points, kCommonDropped, reading));
        variant.parts.push_back(pack_part(part, most, kCommonDropped, reading));
    }
    return variant;
}

/// A camera at `distance` extents of the model from its centre, seen under an angle, which stands so many pixels of its
/// picture of the centre to the right.
Camera camera_at(const PrecisionModel& model, double distance, double angle, uint32_t pixels, double aside = 0) {
    const std::array<double, 3> away = {std::sin(angle) * 0.8, -std::cos(angle) * 0.8, 0.6};
    client::CameraSample sample;
    const double metres = model.extent * distance / 1024;
    const double right = aside * metres * 2 * std::tan(kFov / 2) / pixels;
    sample.x = model.centre[0] / 1024 + away[0] * metres + right * std::cos(angle);
    sample.y = model.centre[1] / 1024 + away[1] * metres + right * std::sin(angle);
    sample.z = model.centre[2] / 1024 + away[2] * metres;
    sample.yaw = -angle * 180 / M_PI;
    sample.pitch = -std::asin(0.6) * 180 / M_PI;
    sample.fov = kFov * 180 / M_PI;
    Camera camera = Camera::from_sample(sample, pixels, pixels);
    camera.near_plane = metres / 1000;
    return camera;
}

std::array<int32_t, 3> from_camera(const PackedPart& part, const Camera& camera) {
    const client::CameraCell cell = client::camera_cell(camera.position);
    std::array<int32_t, 3> from{};
    for (size_t c = 0; c < 3; ++c) from[c] = static_cast<int32_t>(part.positions.grid.origin[c] - cell.cell[c]);
    return from;
}

uint32_t dropped_of(const PackedPart& part, const DropRule& rule, const Camera& camera) {
    return dropped_in_box(rule, from_camera(part, camera), part.low, part.high);
}

struct Levels {
    std::vector<uint32_t> level;  ///< of each part
    double mean = 0;
    uint64_t bytes = 0;  ///< of all buffers
};

Levels levels_at(const Variant& variant, const DropRule& rule, const Camera& camera) {
    Levels levels;
    for (const PackedPart& part : variant.parts) {
        levels.level.push_back(level_of(part.positions.grid, dropped_of(part, rule, camera)));
        levels.mean += levels.level.back();
        levels.bytes += 4 * part.positions.shape.words_at(levels.level.back());
    }
    levels.mean /= static_cast<double>(variant.parts.size());
    return levels;
}

double percent_of_floats(uint64_t bytes, uint64_t vertices) {
    return rounded(100.0 * static_cast<double>(bytes) / (12.0 * static_cast<double>(vertices)));
}

/// Distance in extents at which the average level comes nearest to `level`, by bisection: levels fall with distance.
double distance_of_level(const PrecisionModel& model, const Variant& variant, const DropRule& rule, double level) {
    double near = 0.1, far = 2000;
    for (int i = 0; i < 40; ++i) {
        const double middle = std::sqrt(near * far);
        (levels_at(variant, rule, camera_at(model, middle, 0.7, 1080)).mean > level ? near : far) = middle;
    }
    return far;
}

void memory_table(const PrecisionModel& model, const Variant& ap, const Variant& cap, const Variant& depth,
                  BenchProgram& program) {
    const DropRule rule = rule_at(0.5);
    for (int level = 5; level <= 12; ++level) {
        const double distance = distance_of_level(model, ap, rule, level);
        const Camera camera = camera_at(model, distance, 0.7, 1080);
        const Levels plain = levels_at(ap, rule, camera), bound = levels_at(cap, rule, camera);
        program.print({{"table", "memory"},
                       {"file", model.name},
                       {"level", level},
                       {"mean_level", rounded(plain.mean)},
                       {"distance_extents", rounded(distance)},
                       {"ap_percent", percent_of_floats(plain.bytes, ap.vertices())},
                       {"paper_ap_percent", rounded(300.0 * level / 96)},
                       {"cap_percent", percent_of_floats(bound.bytes, ap.vertices())},
                       {"cap_depth_percent", percent_of_floats(levels_at(depth, rule, camera).bytes, ap.vertices())}});
    }
}

/// Which of the six directions of the axes a normal is nearest to.
int32_t main_direction(const float* normal) {
    int32_t axis = 0;
    for (int32_t c = 1; c < 3; ++c) {
        if (std::fabs(normal[c]) > std::fabs(normal[axis])) axis = c;
    }
    return 2 * axis + (normal[axis] < 0 ? 1 : 0);
}

/// Vertices that are left where those in one cell of 2^cell_bits grid units become one, as long as they face one way.
uint64_t clustered_vertices(const PrecisionPart& part, uint32_t cell_bits) {
    std::set<std::pair<codec::mesh::GridPoint, int32_t>> cells;
    for (size_t v = 0; v < part.points.size(); ++v) {
        codec::mesh::GridPoint cell = part.points[v];
        for (int32_t& x : cell) x >>= cell_bits;
        cells.insert({cell, main_direction(&part.normals[3 * v])});
    }
    return cells.size();
}

void detail_table(const PrecisionModel& model, const Variant& ap, BenchProgram& program) {
    const DropRule rule = rule_at(0.5);
    for (const double level : {6.0, 8.0, 10.0, 12.0}) {
        const Camera camera = camera_at(model, distance_of_level(model, ap, rule, level), 0.7, 1080);
        double precision = 0, detail = 0, both = 0;
        for (size_t p = 0; p < ap.parts.size(); ++p) {
            const PositionWords& positions = ap.parts[p].positions;
            const uint32_t dropped = dropped_of(ap.parts[p], rule, camera);
            const auto left = static_cast<double>(clustered_vertices(model.parts[p], dropped));
            const double bits = positions.shape.record_bits(level_of(positions.grid, dropped));
            precision += bits / 8 * positions.shape.vertices;
            detail += 6 * left;
            both += bits / 8 * left;
        }
        const double all = 6 * static_cast<double>(ap.vertices()) / 100;
        program.print({{"table", "detail"},
                       {"file", model.name},
                       {"level", level},
                       {"precision_percent_of_fixed16", rounded(precision / all)},
                       {"clustering_percent_of_fixed16", rounded(detail / all)},
                       {"both_percent_of_fixed16", rounded(both / all)}});
    }
}

struct Path {
    std::string name;
    std::vector<Camera> cameras;
};

/// A straight flight over the middle of a city from west to east, `height` metres above its lowest point.
Path flight(const PrecisionModel& model, const std::string& name, double height, double pitch) {
    Path path{name, {}};
    for (int i = 0; i < 100; ++i) {
        client::CameraSample sample;
        sample.x = (model.centre[0] + model.extent * (i / 100.0 - 0.5)) / 1024;
        sample.y = model.centre[1] / 1024;
        sample.z = (model.ground + height * model.units_a_metre) / 1024;
        sample.yaw = 90;
        sample.pitch = pitch;
        path.cameras.push_back(Camera::from_sample(sample, 1920, 1080));
    }
    return path;
}

std::vector<Path> paths_of(const PrecisionModel& model) {
    if (model.units_a_metre > 0)
        return {flight(model, "street", 2, 0), flight(model, "roof", 40, -10), flight(model, "high", 400, -30)};
    Path rotation{"rotation", {}}, dolly{"dolly", {}};
    for (int i = 0; i < 120; ++i) rotation.cameras.push_back(camera_at(model, 1, i * 2 * M_PI / 120, 1080));
    for (int i = -100; i <= 100; ++i)
        dolly.cameras.push_back(camera_at(model, 0.6 * std::pow(20, std::abs(i) / 100.0), 0.7, 1080));
    return {rotation, dolly};
}

/// What the parts of a model hold and have been sent while a camera moves.
class Flown {
  public:
    explicit Flown(const Variant& variant)
        : variant_(variant), dropped_(variant.parts.size(), kCommonDropped), sent_(dropped_) {}

    void fly_to(const Camera& camera, const DropRule& rule) {
        double mean = 0;
        for (size_t p = 0; p < variant_.parts.size(); ++p) {
            const PackedPart& part = variant_.parts[p];
            const uint32_t before = dropped_[p];
            dropped_[p] = settled_dropped(rule, before, from_camera(part, camera), part.low, part.high);
            mean += level_of(part.positions.grid, dropped_[p]);
            changes_ += frames_ > 0 && dropped_[p] != before ? 1 : 0;
            send(p);
        }
        mean /= static_cast<double>(variant_.parts.size());
        least_ = std::min(least_, mean);
        greatest_ = std::max(greatest_, mean);
        ++frames_;
    }

    Json figures() const {
        const auto vertices = static_cast<double>(variant_.vertices());
        return {{"parts", variant_.parts.size()},
                {"frames", frames_},
                {"least_mean_level", rounded(least_)},
                {"greatest_mean_level", rounded(greatest_)},
                {"level_changes", changes_},
                {"first_bytes_a_vertex", rounded(static_cast<double>(first_) / vertices)},
                {"plane_bytes_a_vertex", rounded(static_cast<double>(planes_) / vertices)},
                {"fixed16_bytes_a_vertex", 6}};
    }

  private:
    /// The client keeps on the CPU what it was sent once.
    void send(size_t p) {
        const PositionWords& positions = variant_.parts[p].positions;
        const uint32_t level = level_of(positions.grid, dropped_[p]);
        if (frames_ == 0) {
            first_ += 4 * positions.shape.words_at(level);
        } else if (dropped_[p] < sent_[p]) {
            planes_ += 4 * positions.shape.words_between(level_of(positions.grid, sent_[p]), level);
        }
        sent_[p] = frames_ == 0 ? dropped_[p] : std::min(sent_[p], dropped_[p]);
    }

    const Variant& variant_;
    std::vector<uint32_t> dropped_, sent_;
    size_t frames_ = 0;
    uint64_t changes_ = 0, first_ = 0, planes_ = 0;
    double least_ = 99, greatest_ = 0;
};

void path_table(const PrecisionModel& model, const Variant& variant, BenchProgram& program) {
    const DropRule rule = rule_at(0.5, variant.reading);
    for (const Path& path : paths_of(model)) {
        Flown flown(variant);
        for (const Camera& camera : path.cameras) flown.fly_to(camera, rule);
        Json line = {{"table", "path"},
                     {"file", model.name},
                     {"variant", variant.name},
                     {"reading", kReadingNames[static_cast<size_t>(variant.reading)]},
                     {"path", path.name}};
        line.update(flown.figures());
        program.print(line);
    }
}

std::vector<uint8_t> picture_of(client::test::PrecisionPicture& picture, const Variant& variant, const DropRule& rule,
                                const Camera& camera) {
    std::vector<std::vector<uint32_t>> words;
    std::vector<client::test::PrecisionDraw> draws;
    for (const PackedPart& part : variant.parts) {
        const uint32_t level = level_of(part.positions.grid, dropped_of(part, rule, camera));
        words.push_back(pack_precision(part.positions.shape, part.positions.words, level));
    }
    for (size_t p = 0; p < variant.parts.size(); ++p) {
        const PackedPart& part = variant.parts[p];
        draws.push_back({words[p], &part.positions.grid, part.normals, part.indices, rule});
    }
    return picture.draw(camera, draws, 30);
}

/// Pixels of a grey picture, of `side` x `side`, whose neighbours differ much.
std::vector<bool> edge_pixels(std::span<const uint8_t> rgba, uint32_t side) {
    constexpr int kSpan = 16;
    std::vector<bool> edge(size_t{side} * side);
    const auto grey = [&](uint32_t x, uint32_t y) { return rgba[4 * (size_t{y} * side + x)]; };
    for (uint32_t y = 0; y < side; ++y) {
        for (uint32_t x = 0; x < side; ++x) {
            int low = 255, high = 0;
            for (uint32_t v = y - std::min(y, 1u); v <= std::min(y + 1, side - 1); ++v) {
                for (uint32_t u = x - std::min(x, 1u); u <= std::min(x + 1, side - 1); ++u) {
                    low = std::min<int>(low, grey(u, v));
                    high = std::max<int>(high, grey(u, v));
                }
            }
            edge[size_t{y} * side + x] = high - low >= kSpan;
        }
    }
    return edge;
}

/// Where a picture differs from the full one: at its edges, which positions alone decide, or inside what they bound.
void add_edge_error(std::span<const uint8_t> shown, std::span<const uint8_t> full, uint32_t side, Json& line) {
    const std::vector<bool> edge = edge_pixels(full, side);
    std::vector<uint8_t> shown_inside, full_inside;
    double at_edges = 0, all = 0;
    for (size_t i = 0; i < edge.size(); ++i) {
        const double difference = static_cast<double>(shown[4 * i]) - full[4 * i];
        all += difference * difference;
        if (edge[i]) {
            at_edges += difference * difference;
            continue;
        }
        shown_inside.insert(shown_inside.end(), &shown[4 * i], &shown[4 * i] + 4);
        full_inside.insert(full_inside.end(), &full[4 * i], &full[4 * i] + 4);
    }
    line["edge_error_percent"] = rounded(all > 0 ? 100 * at_edges / all : 0);
    line["inside_db"] = rounded(client::test::psnr(shown_inside, full_inside));
}

void picture_table(const client::Device& device, const PrecisionModel& model, const Variant& depth,
                   BenchProgram& program) {
    constexpr uint32_t kPixels = 1080;
    client::test::PrecisionPicture picture(device, kPixels, kPixels, 4);
    constexpr Reconstruction kReadings[] = {Reconstruction::kLow, Reconstruction::kMiddle, Reconstruction::kThirds};
    std::vector<Variant> variants;
    for (const Reconstruction reading : kReadings) {
        variants.push_back(pack_model(model, Constraint::kNone, reading));
        variants.push_back(pack_model(model, Constraint::kShading, reading));
    }
    const size_t cap_thirds = variants.size() - 1;
    variants.push_back(depth);
    for (const double distance : {1.0, 2.0, 4.0}) {
        const Camera camera = camera_at(model, distance, 0.7, kPixels);
        const DropRule all_bits{~0u, kCommonDropped};
        const auto full = picture_of(picture, variants[0], all_bits, camera);
        for (const double pixels : {0.5, 0.25, 0.125}) {
            const DropRule rule = rule_at(pixels * kViewPixels / kPixels);
            Json line = {
                {"table", "picture"},
                {"file", model.name},
                {"distance_extents", distance},
                {"allowed_pixels", pixels},
                {"mean_level", rounded(levels_at(variants[0], rule, camera).mean)},
                {"ap_percent", percent_of_floats(levels_at(variants[0], rule, camera).bytes, model.vertices())},
                {"cap_percent", percent_of_floats(levels_at(variants[1], rule, camera).bytes, model.vertices())}};
            for (size_t i = 0; i < variants.size(); ++i) {
                const auto shown = picture_of(picture, variants[i], rule, camera);
                line[variants[i].name + "_" + kReadingNames[static_cast<size_t>(variants[i].reading)] + "_db"] =
                    rounded(client::test::psnr(shown, full));
                if (i == cap_thirds) add_edge_error(shown, full, kPixels, line);
            }
            const Camera aside = camera_at(model, distance, 0.7, kPixels, pixels / 2);
            line["moved_db"] = rounded(client::test::psnr(picture_of(picture, variants[0], all_bits, aside), full));
            program.print(line);
        }
    }
}

/// The same bits vertex by vertex: what the plane's own order saves.
std::vector<uint32_t> interleaved_plane(const PositionWords& positions, uint32_t plane) {
    const PrecisionShape& shape = positions.shape;
    std::vector<uint32_t> bits((uint64_t{shape.plane_vertices(plane)} * 3 + 31) / 32);
    uint64_t at = 0;
    for (size_t i = 0; i < size_t{shape.plane_vertices(plane)} * 3; ++i) {
        if (shape.leading[i % 3] > plane) continue;
        bits[at / 32] |= (positions.words[i] >> (shape.full_bits - 1 - plane) & 1) << (at % 32);
        ++at;
    }
    bits.resize((at + 31) / 32);
    return bits;
}

void plane_table(const PrecisionModel& model, const Variant& variant, BenchProgram& program) {
    const auto vertices = static_cast<double>(variant.vertices());
    for (uint32_t dropped = 13; dropped-- > 0; dropped -= std::min(dropped, 2u)) {
        uint64_t raw = 0, packed = 0, interleaved = 0;
        for (const PackedPart& part : variant.parts) {
            const uint32_t plane = part.positions.grid.full_bits() - 1 - dropped;
            const auto words = precision_plane(part.positions.shape, part.positions.words, plane);
            const auto other = interleaved_plane(part.positions, plane);
            raw += 4 * words.size();
            packed += codec::bits::compress_frame(std::as_bytes(std::span(words)), 19).size();
            interleaved += codec::bits::compress_frame(std::as_bytes(std::span(other)), 19).size();
        }
        program.print({{"table", "planes"},
                       {"file", model.name},
                       {"dropped_bit", dropped},
                       {"bits_a_vertex", rounded(8 * static_cast<double>(raw) / vertices)},
                       {"zstd_bits_a_vertex", rounded(8 * static_cast<double>(packed) / vertices)},
                       {"zstd_bits_interleaved", rounded(8 * static_cast<double>(interleaved) / vertices)}});
    }
}

/// All parts a level up, on the CPU one by one and on the GPU in one dispatch.
class LevelChange {
  public:
    LevelChange(const client::Device& device, const Variant& variant) : device_(device), merger_(device) {
        for (const PackedPart& part : variant.parts) {
            const PrecisionShape& shape = part.positions.shape;
            const uint32_t from = shape.full_bits - 8;
            sources_.push_back(pack_precision(shape, part.positions.words, from));
            planes_.push_back(precision_plane(shape, part.positions.words, from));
            expected_.push_back(pack_precision(shape, part.positions.words, from + 1));
            changes_.push_back({&shape, from, from + 1, upload(sources_.back()) | LAYER_REF_DIRECT,
                                upload(planes_.back()) | LAYER_REF_DIRECT,
                                upload(expected_.back()) | LAYER_REF_DIRECT});
        }
        table_ = client::create_buffer(device_, client::PrecisionMerger::table_bytes(changes_.size()),
                                       client::BufferPlace::kUpload);
    }
    ~LevelChange() {
        client::destroy_buffer(device_, table_);
        for (client::Buffer& buffer : buffers_) client::destroy_buffer(device_, buffer);
    }
    LevelChange(const LevelChange&) = delete;
    LevelChange& operator=(const LevelChange&) = delete;

    bool on_cpu() const {
        bool same = true;
        for (size_t i = 0; i < sources_.size(); ++i) {
            const auto view = PrecisionView::create(sources_[i]);
            const auto changed = change_level(*view, changes_[i].to_level, planes_[i]);
            same &= changed.ok() && *changed == expected_[i];
        }
        return same;
    }

    void on_gpu() const {
        client::submit_and_wait(device_, [&](VkCommandBuffer commands) { merger_.record(commands, changes_, table_); });
    }

  private:
    VkDeviceAddress upload(std::span<const uint32_t> words) {
        buffers_.push_back(
            client::create_buffer(device_, std::max<uint64_t>(words.size_bytes(), 4), client::BufferPlace::kReadback));
        std::memcpy(buffers_.back().mapped, words.data(), words.size_bytes());
        return buffers_.back().address;
    }

    const client::Device& device_;
    client::PrecisionMerger merger_;
    std::vector<std::vector<uint32_t>> sources_, planes_, expected_;
    std::vector<client::PrecisionChange> changes_;
    std::vector<client::Buffer> buffers_;
    client::Buffer table_;
};

void change_table(const client::Device& device, const PrecisionModel& model, const Variant& variant, int repetitions,
                  BenchProgram& program) {
    const LevelChange change(device, variant);
    program.check(change.on_cpu(), model.name + ": a level up equals packing");
    std::vector<float> floats(3 * variant.vertices()), copy(floats.size());
    const std::vector<std::function<void()>> work = {[&] { keep(change.on_cpu()); }, [&] { change.on_gpu(); },
                                                     [&] {
                                                         std::memcpy(copy.data(), floats.data(),
                                                                     floats.size() * sizeof(float));
                                                         keep(copy);
                                                     }};
    const auto seconds = time_in_turn(work, repetitions);
    const auto nanoseconds = [&](const std::vector<double>& all) {
        return rounded(1e9 * spread_of(all).median / static_cast<double>(variant.vertices()));
    };
    program.print({{"table", "change"},
                   {"file", model.name},
                   {"variant", variant.name},
                   {"device", device.name},
                   {"buffers", variant.parts.size()},
                   {"cpu_ns_a_vertex", nanoseconds(seconds[0])},
                   {"gpu_ns_a_vertex", nanoseconds(seconds[1])},
                   {"gpu_to_cpu", to_json(ratio_of(seconds[1], seconds[0]))},
                   {"gpu_to_copy_of_floats", to_json(ratio_of(seconds[1], seconds[2]))}});
}

/// Of the largest part.
void depth_table(const PrecisionModel& model, BenchProgram& program) {
    constexpr uint32_t kMostDropped = 10;
    const PrecisionPart& part =
        *std::max_element(model.parts.begin(), model.parts.end(),
                          [](const auto& a, const auto& b) { return a.triangles.size() < b.triangles.size(); });
    const std::vector<uint32_t> object = objects_of(part);
    const PrecisionGrid grid = grid_of(part.points, kMostDropped, Reconstruction::kThirds);
    const std::vector<uint32_t> most = depth_order_dropped(part.points, part.triangles, object, grid);
    uint64_t box_pairs = 0;
    TriangleTree(part.points, part.triangles).each_pair([&](uint32_t, uint32_t) { ++box_pairs; });
    uint64_t free = 0, without = 0, with = 0;
    for (uint32_t level = 1; level <= kMostDropped; ++level) {
        std::vector<uint32_t> dropped(most.size(), level);
        without += new_meetings(part.points, part.triangles, object, grid, dropped).size();
        for (size_t v = 0; v < most.size(); ++v) dropped[v] = std::min(level, most[v]);
        with += new_meetings(part.points, part.triangles, object, grid, dropped).size();
    }
    for (const uint32_t m : most) free += m == kMostDropped ? 1 : 0;
    program.check(with == 0, model.name + ": constrained objects never meet");
    const auto triangles = static_cast<double>(part.triangles.size());
    program.print(
        {{"table", "depth"},
         {"file", model.name},
         {"triangles", part.triangles.size()},
         {"objects", std::set<uint32_t>(object.begin(), object.end()).size()},
         {"most_dropped", kMostDropped},
         {"box_pairs_of_all", rounded(static_cast<double>(box_pairs) / (triangles * (triangles - 1) / 2))},
         {"meetings_without", without},
         {"meetings_with", with},
         {"free_vertices_percent", rounded(100.0 * static_cast<double>(free) / static_cast<double>(most.size()))}});
}

void measure(const client::Device& device, const PrecisionModel& model, int repetitions, BenchProgram& program) {
    const Variant ap = pack_model(model, Constraint::kNone, Reconstruction::kLow),
                  cap = pack_model(model, Constraint::kShading, Reconstruction::kLow);
    const Variant depth = pack_model(model, Constraint::kShadingAndDepth, Reconstruction::kMiddle);
    memory_table(model, ap, cap, depth, program);
    detail_table(model, ap, program);
    path_table(model, ap, program);
    path_table(model, pack_model(model, Constraint::kNone, Reconstruction::kMiddle), program);
    path_table(model, cap, program);
    picture_table(device, model, depth, program);
    plane_table(model, ap, program);
    depth_table(model, program);
    change_table(device, model, ap, repetitions, program);
    change_table(device, model, cap, repetitions, program);
}

/// The creased plate of the tests, as large as the other models.
GridMesh creased_mesh() {
    const auto plate = client::test::creased_plate(16, 1.5, 0.12);
    GridMesh mesh{plate.points, plate.triangles};
    for (auto& point : mesh.points)
        for (int32_t& x : point) x *= 32;
    return mesh;
}

void print_thesis(BenchProgram& program) {
    for (const ThesisPrecision& row : kThesisPrecision) {
        program.print({{"table", "thesis memory"},
                       {"level", row.level},
                       {"car_ap_cap_percent", row.car_percent},
                       {"david_ap_cap_percent", row.david_percent},
                       {"car_ap_cap_float_ms", row.car_milliseconds},
                       {"david_ap_cap_float_ms", row.david_milliseconds}});
    }
    for (const ThesisPicture& picture : kThesisPictures) {
        program.print({{"table", "thesis picture"},
                       {"file", picture.model},
                       {"AP_db", picture.adaptive_db},
                       {"CAP_db", picture.constrained_db}});
    }
}

}  // namespace

int main(int argc, char** argv) {
    BenchProgram program({"bench_precision", kClaim, "OBJ, PLY, STL or city model", false});
    BenchOptions options;
    options.repetitions = 5;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    print_thesis(program);
    client::Instance instance = client::create_instance(false);
    const auto physical = client::choose_device(instance, "", {});
    if (!program.check(physical.ok(), "a Vulkan device")) return program.exit_code();
    client::Device device = client::create_device(*physical);
    if (options.files.empty())
        measure(device, precision_model("creased plate", creased_mesh(), kPartTriangles), options.repetitions, program);
    for (const std::string& file : options.files) {
        const auto source = read_mesh_file(file);
        if (!program.check(source.ok(), source.ok() ? "" : source.error().text())) continue;
        const std::string name = std::filesystem::path(file).filename().string();
        const QuantisedMesh quantised = quantise(*source, kModelBits);
        PrecisionModel model = precision_model(name, quantised.mesh, kPartTriangles);
        if (source->buildings > 0) model.units_a_metre = 1 / quantised.step;
        measure(device, model, options.repetitions, program);
    }
    client::destroy_device(device);
    client::destroy_instance(instance);
    return program.exit_code();
}
