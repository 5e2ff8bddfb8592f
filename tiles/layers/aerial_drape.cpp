#include "tiles/layers/aerial_drape.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <span>
#include <string_view>
#include <utility>

#include "tiles/layers/image_decode.h"

namespace citystream::tiles::layers {
namespace {

using city::CityObject;
using city::Triangle;
using city::Vec3;
using Polygon = std::vector<Vec3>;

constexpr double kLeastArea = 1e-6;                          // m^2: what cutting leaves below this is dropped
constexpr std::array<uint8_t, 3> kGround = {142, 140, 132};  // where the photograph cannot be read after all

double coordinate(const Vec3& at, int axis) {
    return axis == 0 ? at.x : at.y;
}

/// Where the edge a-b crosses `value`; the same point, bit for bit, for b-a.
Vec3 crossing(Vec3 a, Vec3 b, int axis, double value) {
    if (std::array{b.x, b.y, b.z} < std::array{a.x, a.y, a.z}) std::swap(a, b);
    const double t = (value - coordinate(a, axis)) / (coordinate(b, axis) - coordinate(a, axis));
    Vec3 at{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z)};
    (axis == 0 ? at.x : at.y) = value;
    return at;
}

/// The parts of a convex polygon below and above a line.
std::pair<Polygon, Polygon> split(const Polygon& polygon, int axis, double value) {
    std::pair<Polygon, Polygon> parts;
    for (size_t i = 0; i < polygon.size(); ++i) {
        const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double at = coordinate(a, axis) - value, next = coordinate(b, axis) - value;
        if (at <= 0) parts.first.push_back(a);
        if (at >= 0) parts.second.push_back(a);
        if ((at < 0 && next > 0) || (at > 0 && next < 0)) {
            const Vec3 cut = crossing(a, b, axis, value);
            parts.first.push_back(cut);
            parts.second.push_back(cut);
        }
    }
    return parts;
}

double level_area(const Vec3& a, const Vec3& b, const Vec3& c) {
    return 0.5 * std::abs((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y));
}

/// Collects the triangles of an object anew.
class Remake {
  public:
    void keep(const Triangle& triangle, const CityObject& object) {
        Triangle kept = triangle;
        for (size_t k = 0; k < 3; ++k) kept.vertex[k] = vertex(object.vertices[triangle.vertex[k]]);
        triangles_.push_back(kept);
    }

    template <typename Texcoord>
    uint64_t add(const Polygon& polygon, const Triangle& like, uint32_t material, Texcoord texcoord) {
        uint64_t added = 0;
        for (size_t i = 2; i < polygon.size(); ++i) {
            if (level_area(polygon[0], polygon[i - 1], polygon[i]) < kLeastArea) continue;
            Triangle made = like;
            made.material = material;
            for (size_t k = 0; k < 3; ++k) {
                const Vec3& at = polygon[k == 0 ? 0 : i - 2 + k];
                made.vertex[k] = vertex(at);
                made.texcoord[k] = texcoord(at);
            }
            triangles_.push_back(made);
            ++added;
        }
        return added;
    }

    void finish(CityObject& object) {
        object.vertices = std::move(vertices_);
        object.triangles = std::move(triangles_);
    }

  private:
    uint32_t vertex(const Vec3& at) {
        const auto [found, is_new] = known_.try_emplace({at.x, at.y, at.z}, static_cast<uint32_t>(vertices_.size()));
        if (is_new) vertices_.push_back(at);
        return found->second;
    }

    std::vector<Vec3> vertices_;
    std::vector<Triangle> triangles_;
    std::map<std::array<double, 3>, uint32_t> known_;
};

/// Blocks of one axis of a photograph: texels count from the west or the south.
struct Axis {
    double from = 0, to = 0;
    uint32_t texels = 0;

    uint32_t blocks() const { return (texels + AerialDrape::kBlockTexels - 1) / AerialDrape::kBlockTexels; }
    uint32_t begin(uint32_t block) const { return static_cast<uint32_t>(uint64_t{texels} * block / blocks()); }
    double edge(uint32_t block) const { return from + (to - from) * begin(block) / texels; }
    uint32_t padded_begin(uint32_t block) const {
        return begin(block) - std::min(begin(block), AerialDrape::kMarginTexels);
    }
    uint32_t padded_end(uint32_t block) const {
        return std::min(texels, begin(block + 1) + AerialDrape::kMarginTexels);
    }
    /// 0..1 over the padded block.
    double share(uint32_t block, double at) const {
        const double texel = (at - from) / (to - from) * texels;
        return std::clamp((texel - padded_begin(block)) / (padded_end(block) - padded_begin(block)), 0.0, 1.0);
    }
};

Axis across(const AerialImage& image) {
    return {image.xmin, image.xmax, image.width};
}
Axis up(const AerialImage& image) {
    return {image.ymin, image.ymax, image.height};
}

/// Texels x0..x1, y0..y1 of a file, y upwards; empty when it cannot be read.
city::Image read_block(const std::string& path, uint32_t x0, uint32_t x1, uint32_t y0, uint32_t y1) {
    city::Image block{x1 - x0, y1 - y0, {}};
    const auto file = ImageFile::open(path);
    if (!file || (*file)->width() < x1 || (*file)->height() < y1) return {};
    const size_t row_bytes = size_t{3} * block.width, file_row = size_t{3} * (*file)->width();
    const uint32_t height = (*file)->height();
    block.rgb.resize(row_bytes * block.height);
    const Status read = (*file)->visit_rows([&](uint32_t top, uint32_t count, std::span<const uint8_t> rgb, auto) {
        for (uint32_t i = 0; i < count; ++i) {
            const uint32_t y = height - 1 - (top + i);
            if (y < y0 || y >= y1) continue;
            std::memcpy(block.rgb.data() + row_bytes * (y - y0), rgb.data() + file_row * i + size_t{3} * x0, row_bytes);
        }
    });
    return read ? block : city::Image{};
}

std::vector<double> numbers_in(std::string_view text) {
    std::vector<double> numbers;
    for (size_t at = 0; at < text.size();) {
        const size_t begin = text.find_first_not_of(", \t\r\n", at);
        if (begin == std::string_view::npos) break;
        at = std::min(text.find_first_of(", \t\r\n", begin), text.size());
        double value = 0;
        const auto [end, error] = std::from_chars(text.data() + begin, text.data() + at, value);
        if (error != std::errc() || end != text.data() + at || !std::isfinite(value)) return {};
        numbers.push_back(value);
    }
    return numbers;
}

/// The six numbers beside an image; empty without such a file.
std::vector<double> world_file_of(const std::string& path) {
    const std::filesystem::path image(path);
    const std::string extension = image.extension().string();
    std::vector<std::string> names = {".wld", extension + "w"};
    if (extension.size() >= 3) names.push_back({'.', extension[1], extension.back(), 'w'});
    for (const std::string& name : names) {
        std::ifstream file(std::filesystem::path(image).replace_extension(name));
        if (!file) continue;
        return numbers_in(std::string((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>()));
    }
    return {};
}

/// The place of the comma before the last four parts; npos: there are fewer commas.
size_t comma_before_place(std::string_view text) {
    size_t comma = text.size();
    for (int i = 0; i < 4 && comma != std::string_view::npos; ++i)
        comma = comma == 0 ? std::string_view::npos : text.rfind(',', comma - 1);
    return comma;
}

bool covers_area(const std::array<double, 4>& place) {
    return place[2] > place[0] && place[3] > place[1];
}

Error no_area(const std::string& path) {
    return Error{"aerial image " + path +
                 " covers no area, or is mirrored: XMIN,YMIN,XMAX,YMAX are west, south, east, north"};
}

/// What the world file beside an image says. It gives the middle of the upper left texel.
Result<std::array<double, 4>> place_beside(const std::string& path, const ImageFile& file) {
    const std::vector<double> world = world_file_of(path);
    if (world.size() != 6)
        return Error{"aerial image " + path + " has no place: put a world file beside it or add ,XMIN,YMIN,XMAX,YMAX"};
    if (world[1] != 0 || world[2] != 0)
        return Error{"aerial image " + path + " is turned by its world file: warp it so that north is up"};
    const double xmin = world[4] - world[0] / 2, ymax = world[5] - world[3] / 2;
    return std::array{xmin, ymax + world[3] * file.height(), xmin + world[0] * file.width(), ymax};
}

}  // namespace

Result<AerialRequest> parse_aerial(const std::string& text) {
    const size_t comma = comma_before_place(text);
    if (comma != std::string::npos && comma > 0) {
        const std::vector<double> numbers = numbers_in(std::string_view(text).substr(comma + 1));
        if (numbers.size() == 4) {
            const AerialRequest request{text.substr(0, comma),
                                        std::array{numbers[0], numbers[1], numbers[2], numbers[3]}};
            if (!covers_area(*request.place)) return no_area(request.path);
            return request;
        }
    }
    std::error_code failed;
    if (text.find(',') != std::string::npos && !std::filesystem::exists(text, failed))
        return Error{
            "aerial image " + text +
            ": what follows the image is not XMIN,YMIN,XMAX,YMAX, four numbers, and no file has all of this as "
            "its name"};
    return AerialRequest{text, std::nullopt};
}

Result<AerialImage> open_aerial(const std::string& text) {
    const auto request = parse_aerial(text);
    if (!request) return request.error();
    const auto file = ImageFile::open(request->path);
    if (!file) return file.error();
    const auto place = request->place ? Result(*request->place) : place_beside(request->path, **file);
    if (!place) return place.error();
    if (!covers_area(*place)) return no_area(request->path);
    const auto& [xmin, ymin, xmax, ymax] = *place;
    return AerialImage{request->path, xmin, ymin, xmax, ymax, (*file)->width(), (*file)->height()};
}

void AerialDrape::drape(CityObject& object) {
    if (object.kind != city::ObjectKind::kTerrain && object.kind != city::ObjectKind::kLandUse) return;
    for (size_t image = 0; image < images_.size(); ++image) drape_image(image, object);
}

void AerialDrape::drape_image(size_t image, CityObject& object) {
    const Axis x = across(images_[image]), y = up(images_[image]);
    Remake remade;
    bool any = false;
    for (const Triangle& triangle : object.triangles) {
        Polygon rest;
        for (const uint32_t vertex : triangle.vertex) rest.push_back(object.vertices[vertex]);
        const auto [west, east] = std::minmax({rest[0].x, rest[1].x, rest[2].x});
        const auto [south, north] = std::minmax({rest[0].y, rest[1].y, rest[2].y});
        const bool beside = east <= x.from || west >= x.to || north <= y.from || south >= y.to;
        if (beside || catalog_.materials[triangle.material].image >= 0) {
            remade.keep(triangle, object);
            continue;
        }
        any = true;
        const auto bare = [](const Vec3&) { return city::Vec2{}; };
        const auto cut = [&](int axis, double value, bool keep_above) {
            auto [below, above] = split(rest, axis, value);
            remade.add(keep_above ? below : above, triangle, triangle.material, bare);
            rest = std::move(keep_above ? above : below);
        };
        cut(0, x.from, true);
        cut(0, x.to, false);
        cut(1, y.from, true);
        cut(1, y.to, false);
        for (uint32_t column = 0; column < x.blocks() && !rest.empty(); ++column) {
            auto [strip, beyond] = split(rest, 0, x.edge(column + 1));
            rest = std::move(beyond);
            for (uint32_t row = 0; row < y.blocks() && !strip.empty(); ++row) {
                auto [block, above] = split(strip, 1, y.edge(row + 1));
                strip = std::move(above);
                if (block.size() < 3) continue;
                draped_ += remade.add(block, triangle, material_of(image, column, row), [&](const Vec3& at) {
                    return city::Vec2{x.share(column, at.x), y.share(row, at.y)};
                });
            }
        }
    }
    if (any) remade.finish(object);
}

uint32_t AerialDrape::material_of(size_t image, uint32_t column, uint32_t row) {
    const auto [known, is_new] =
        materials_.try_emplace({image, column, row}, static_cast<uint32_t>(catalog_.materials.size()));
    if (!is_new) return known->second;
    const Axis x = across(images_[image]), y = up(images_[image]);
    city::Material material;
    material.rgb = kGround;
    material.image = static_cast<int32_t>(catalog_.images.size());
    material.repeat = false;
    catalog_.images.push_back({.make = [path = images_[image].path, x, y, column, row] {
        return read_block(path, x.padded_begin(column), x.padded_end(column), y.padded_begin(row), y.padded_end(row));
    }});
    catalog_.materials.push_back(material);
    return known->second;
}

}  // namespace citystream::tiles::layers
