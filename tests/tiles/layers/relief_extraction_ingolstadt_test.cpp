// Facades found in the surveyed buildings of Ingolstadt, compared with the models themselves and with the rasters that
// were drawn of them independently. Skipped where ../shared/data is absent.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/tiles/layers/relief_probe.h"
#include "tiles/city/city_input.h"
#include "tiles/layers/relief_extraction.h"
#include "tiles/layers/relief_extraction_frame.h"

namespace citystream::tiles::layers {
namespace {

const std::filesystem::path kShared = CITYSTREAM_SOURCE_DIR "/../shared/data";

struct ExtractedCity {
    city::CityCatalog catalog;
    std::vector<city::CityObject> before, after;
    ReliefExtractionReport report;
};

/// Read and extracted once for all tests; empty when the data is absent.
const ExtractedCity& ingolstadt() {
    static const ExtractedCity city = [] {
        ExtractedCity made;
        std::vector<std::string> files;
        const auto folder = kShared / "ingolstadt_lod3";
        if (!std::filesystem::exists(folder)) return made;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
            if (entry.path().string().ends_with(".xml.xz")) files.push_back(entry.path().string());
        }
        std::sort(files.begin(), files.end());
        city::CityHeader header;
        city::CityReport report;
        const Status read = city::read_city(files, {}, header, made.catalog, report, [&](city::CityObject&& object) {
            made.before.push_back(std::move(object));
            return true;
        });
        EXPECT_TRUE(read.ok());
        ReliefExtractor extractor(made.catalog, {});
        made.after = made.before;
        for (city::CityObject& object : made.after) extractor.extract(object);
        made.report = extractor.report();
        return made;
    }();
    return city;
}

/// A raster of 2.5 cm pixels, first row at the top.
struct FacadeRaster {
    std::string name, building;
    uint32_t width = 0, height = 0;
    double pixel = 0;
    city::Vec3 origin, right, down, normal;
    std::vector<uint16_t> depth;
};

city::Vec3 vector_of(const nlohmann::json& list) {
    return {list[0].get<double>(), list[1].get<double>(), list[2].get<double>()};
}

std::vector<FacadeRaster> read_rasters() {
    const auto folder = kShared / "ingolstadt_facade_rasters";
    std::vector<FacadeRaster> rasters;
    std::ifstream file(folder / "facades.json");
    if (!file) return rasters;
    for (const nlohmann::json& entry : nlohmann::json::parse(file)) {
        FacadeRaster raster;
        raster.name = entry["name"];
        raster.building = entry["building"];
        raster.pixel = entry["pixel_m"];
        raster.origin = vector_of(entry["origin"]);
        raster.right = vector_of(entry["u_axis"]);
        raster.down = vector_of(entry["v_axis"]);
        raster.normal = vector_of(entry["normal"]);
        auto input = OIIO::ImageInput::open((folder / (raster.name + "_depth.png")).string());
        if (!input) continue;
        raster.width = static_cast<uint32_t>(input->spec().width);
        raster.height = static_cast<uint32_t>(input->spec().height);
        raster.depth.resize(size_t{raster.width} * raster.height);
        input->read_image(0, 0, 0, 1, OIIO::TypeDesc::UINT16, raster.depth.data());
        rasters.push_back(std::move(raster));
    }
    return rasters;
}

constexpr double kNothing = -1e300;
constexpr uint32_t kStride = 3;  // of the pixels that are compared

/// What the extracted building shows from the front at every kStride-th pixel: the front-most of relief and mesh.
class FrontView {
  public:
    FrontView(const ExtractedCity& city, const city::CityObject& object, const FacadeRaster& raster)
        : raster_(raster), columns_(raster.width / kStride), rows_(raster.height / kStride) {
        depth_.assign(columns_ * rows_, kNothing);
        for (const city::Triangle& t : object.triangles) draw(object, t);
        for (const city::FacadeWall& wall : object.facades) draw(ReliefProbe(city.catalog, wall));
    }
    double at(size_t column, size_t row) const { return depth_[row * columns_ + column]; }
    size_t columns() const { return columns_; }
    size_t rows() const { return rows_; }

  private:
    city::Vec3 pixel(size_t column, size_t row) const {
        const double x = (static_cast<double>(column * kStride) + 0.5) * raster_.pixel,
                     y = (static_cast<double>(row * kStride) + 0.5) * raster_.pixel;
        return {raster_.origin.x + raster_.right.x * x + raster_.down.x * y,
                raster_.origin.y + raster_.right.y * x + raster_.down.y * y,
                raster_.origin.z + raster_.right.z * x + raster_.down.z * y};
    }

    void put(size_t column, size_t row, double w) {
        double& depth = depth_[row * columns_ + column];
        if (w <= 2.0 && w >= -1.5) depth = std::max(depth, w);
    }

    void draw(const ReliefProbe& relief) {
        const city::Vec3& n = raster_.normal;
        if (relief.normal().x * n.x + relief.normal().y * n.y < -0.1) return;  // its back
        constexpr double kBefore = 2.0;
        for (size_t row = 0; row < rows_; ++row) {
            for (size_t column = 0; column < columns_; ++column) {
                const city::Vec3 p = pixel(column, row);
                const city::Vec3 from = {p.x + n.x * kBefore, p.y + n.y * kBefore, p.z + n.z * kBefore};
                const auto way = relief.distance(from, {-n.x, -n.y, -n.z});
                if (way && *way > 0) put(column, row, kBefore - *way);
            }
        }
    }

    void draw(const city::CityObject& object, const city::Triangle& t) {
        std::array<city::Vec3, 3> q;  // pixels of the coarser picture, metres outwards
        for (size_t k = 0; k < 3; ++k) {
            const city::Vec3& v = object.vertices[t.vertex[k]];
            const city::Vec3 d = {v.x - raster_.origin.x, v.y - raster_.origin.y, v.z - raster_.origin.z};
            const auto along = [&](const city::Vec3& a) { return d.x * a.x + d.y * a.y + d.z * a.z; };
            q[k] = {(along(raster_.right) / raster_.pixel - 0.5) / kStride,
                    (along(raster_.down) / raster_.pixel - 0.5) / kStride, along(raster_.normal)};
        }
        const double twice = (q[1].x - q[0].x) * (q[2].y - q[0].y) - (q[2].x - q[0].x) * (q[1].y - q[0].y);
        // The rasters show what faces the street, and windows and doors from both sides. Rows count downwards here.
        const bool opening = t.surface == city::SurfaceKind::kWindow || t.surface == city::SurfaceKind::kDoor;
        if (std::abs(twice) < 1e-9 || (twice > 0 && !opening)) return;
        const auto range = [](double a, double b, double c, size_t count) {
            const double low = std::ceil(std::min({a, b, c})), high = std::floor(std::max({a, b, c})) + 1;
            const double most = static_cast<double>(count);
            return std::array<size_t, 2>{static_cast<size_t>(std::clamp(low, 0.0, most)),
                                         static_cast<size_t>(std::clamp(high, 0.0, most))};
        };
        const auto [left, right] = range(q[0].x, q[1].x, q[2].x, columns_);
        const auto [top, bottom] = range(q[0].y, q[1].y, q[2].y, rows_);
        for (size_t row = top; row < bottom; ++row) {
            for (size_t column = left; column < right; ++column) {
                const double x = static_cast<double>(column), y = static_cast<double>(row);
                const double b = ((x - q[0].x) * (q[2].y - q[0].y) - (q[2].x - q[0].x) * (y - q[0].y)) / twice;
                const double c = ((q[1].x - q[0].x) * (y - q[0].y) - (x - q[0].x) * (q[1].y - q[0].y)) / twice;
                if (b < 0 || c < 0 || b + c > 1) continue;
                put(column, row, q[0].z + b * (q[1].z - q[0].z) + c * (q[2].z - q[0].z));
            }
        }
    }

    const FacadeRaster& raster_;
    size_t columns_, rows_;
    std::vector<double> depth_;
};

struct Agreement {
    size_t pixels = 0, within = 0;
    double share() const { return static_cast<double>(within) / static_cast<double>(std::max<size_t>(1, pixels)); }
};

/// Pixels where both show a surface, 25 mm apart at most, or neither does.
Agreement compare(const ExtractedCity& city, const FacadeRaster& raster, const std::vector<city::CityObject>& objects) {
    Agreement sum;
    for (const city::CityObject& object : objects) {
        if (object.id.find(raster.building) == std::string::npos) continue;
        const FrontView view(city, object, raster);
        for (size_t row = 0; row < view.rows(); ++row) {
            for (size_t column = 0; column < view.columns(); ++column) {
                const uint16_t value = raster.depth[row * kStride * raster.width + column * kStride];
                const double ours = view.at(column, row), theirs = value == 0 ? kNothing : (value - 32768) * 0.001;
                ++sum.pixels;
                const bool alike = (ours == kNothing) == (theirs == kNothing);
                if (alike && (ours == kNothing || std::abs(ours - theirs) <= 0.025)) ++sum.within;
            }
        }
    }
    return sum;
}

/// Some rasters look at panes from the room: no wall there faces outside, and nobody sees them.
bool faces_outside(const FacadeRaster& raster, const std::vector<city::CityObject>& objects) {
    for (const city::CityObject& object : objects) {
        if (object.id.find(raster.building) == std::string::npos) continue;
        for (const relief::WallFrame& frame : relief::find_wall_frames(object, {})) {
            const double cosine = frame.along.y * raster.normal.x - frame.along.x * raster.normal.y;
            if (cosine > 0.997 && std::abs(frame.local(raster.origin).w) < 0.7) return true;
        }
    }
    return false;
}

TEST(ReliefExtractionIngolstadt, TheFrontOfEveryFacadeIsThatOfTheIndependentRasters) {
    const ExtractedCity& city = ingolstadt();
    const std::vector<FacadeRaster> rasters = read_rasters();
    if (city.before.empty() || rasters.empty()) GTEST_SKIP() << kShared << " is absent";
    ASSERT_EQ(rasters.size(), 63u);
    Agreement all, of_triangles;
    size_t compared = 0;
    for (const FacadeRaster& raster : rasters) {
        if (!faces_outside(raster, city.before)) continue;
        const Agreement before = compare(city, raster, city.before), after = compare(city, raster, city.after);
        if (before.pixels == 0) continue;
        ++compared;
        // The triangles themselves, drawn by this test, differ from the rasters on edges.
        EXPECT_GE(after.share(), before.share() - 0.01) << raster.name;
        all.pixels += after.pixels;
        all.within += after.within;
        of_triangles.pixels += before.pixels;
        of_triangles.within += before.within;
    }
    EXPECT_GE(compared, 40u);
    EXPECT_GE(all.share(), of_triangles.share() - 0.002);
    EXPECT_GE(all.share(), 0.985);
    RecordProperty("within_25_mm", std::to_string(all.share()));
    RecordProperty("triangles_within_25_mm", std::to_string(of_triangles.share()));
}

TEST(ReliefExtractionIngolstadt, MoreThanHalfOfTheTrianglesBecomeRelief) {
    const ExtractedCity& city = ingolstadt();
    if (city.before.empty()) GTEST_SKIP() << kShared << " is absent";
    const ReliefExtractionReport& report = city.report;
    EXPECT_EQ(report.buildings, 36u);
    EXPECT_GE(report.buildings_with_relief, 30u);
    EXPECT_GE(report.facades, 40u);
    EXPECT_LE(report.triangles_after * 2, report.triangles_before);
    EXPECT_LE(report.largest_error, ReliefExtractionOptions{}.tolerance);
    EXPECT_LE(report.mean_error, 0.002);
    uint64_t after = 0, facades = 0;
    for (const city::CityObject& object : city.after) {
        after += object.triangles.size();
        facades += object.facades.size();
        for (const city::FacadeWall& wall : object.facades) {
            ASSERT_LT(wall.map, city.catalog.facade_maps.size());
            ASSERT_LT(wall.palette, city.catalog.palettes.size());
            for (const uint32_t label : city.catalog.facade_maps.map(wall.map).labels)
                ASSERT_LT(codec::facade::material_of(label), 16u);
        }
    }
    EXPECT_EQ(after, report.triangles_after);
    EXPECT_EQ(facades, report.facades);
}

using Key = std::array<double, 9>;

Key key_of(const city::CityObject& object, const city::Triangle& t) {
    Key key{};
    for (size_t k = 0; k < 3; ++k) {
        const city::Vec3& v = object.vertices[t.vertex[k]];
        key[3 * k] = v.x;
        key[3 * k + 1] = v.y;
        key[3 * k + 2] = v.z;
    }
    return key;
}

city::Vec3 cross(const city::Vec3& a, const city::Vec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double dot(const city::Vec3& a, const city::Vec3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
city::Vec3 minus(const city::Vec3& a, const city::Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}

/// Whether the way from a place along a direction is free of the object's triangles.
bool is_free(const city::CityObject& object, const city::Vec3& from, const city::Vec3& way) {
    for (const city::Triangle& t : object.triangles) {
        const city::Vec3 &a = object.vertices[t.vertex[0]], &b = object.vertices[t.vertex[1]],
                         &c = object.vertices[t.vertex[2]];
        const city::Vec3 e = minus(b, a), f = minus(c, a), p = cross(way, f), s = minus(from, a), q = cross(s, e);
        const double det = dot(e, p);
        if (det == 0) continue;
        const double u = dot(s, p) / det, v = dot(way, q) / det;
        if (u >= 0 && v >= 0 && u + v <= 1 && dot(f, q) / det > 1e-3) return false;
    }
    return true;
}

/// Whether the relief's surface (a front, or the side between two) passes within `reach` of a place.
bool is_on_relief(const ReliefProbe& relief, const city::Vec3& place, double reach) {
    const city::Vec3 at = relief.local(place);
    double lowest = 1e300, highest = -1e300;
    constexpr int kSteps = 6;
    for (int i = -kSteps; i <= kSteps; ++i) {
        for (int k = -kSteps; k <= kSteps; ++k) {
            const auto depth = relief.depth_at(at.x + reach * i / kSteps, at.y + reach * k / kSteps);
            lowest = std::min(lowest, depth.value_or(-1e300));
            if (depth) highest = std::max(highest, *depth);
        }
    }
    return lowest <= at.z + reach && highest >= at.z - reach;
}

TEST(ReliefExtractionIngolstadt, EveryVisibleTriangleThatWasTakenLiesOnTheRelief) {
    const ExtractedCity& city = ingolstadt();
    if (city.before.empty()) GTEST_SKIP() << kShared << " is absent";
    constexpr size_t kSampled = 61;  // every 61st triangle
    size_t taken = 0, seen = 0, lost = 0;
    for (size_t i = 0; i < city.before.size(); ++i) {
        const city::CityObject &before = city.before[i], &after = city.after[i];
        std::set<Key> kept;
        for (const city::Triangle& t : after.triangles) kept.insert(key_of(after, t));
        std::vector<ReliefProbe> reliefs;
        for (const city::FacadeWall& wall : after.facades) reliefs.emplace_back(city.catalog, wall);
        for (size_t k = i % kSampled; k < before.triangles.size(); k += kSampled) {
            const city::Triangle& t = before.triangles[k];
            if (kept.count(key_of(before, t)) != 0) continue;
            ++taken;
            const city::Vec3 &a = before.vertices[t.vertex[0]], &b = before.vertices[t.vertex[1]],
                             &c = before.vertices[t.vertex[2]];
            const city::Vec3 middle = {(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3, (a.z + b.z + c.z) / 3};
            city::Vec3 normal = cross(minus(b, a), minus(c, a));
            const double size = std::sqrt(dot(normal, normal));
            if (size < 1e-6) continue;
            normal = {normal.x / size, normal.y / size, normal.z / size};
            // Towards the street: out of the wall that took it, and up or down with the triangle.
            bool visible = false;
            for (const ReliefProbe& relief : reliefs) {
                const city::Vec3 out = relief.normal();
                const city::Vec3 way = {out.x + normal.x, out.y + normal.y, out.z + normal.z};
                visible = visible || (dot(way, normal) > 0.1 && is_free(before, middle, way));
            }
            if (!visible) continue;
            ++seen;
            const bool shown = std::any_of(reliefs.begin(), reliefs.end(), [&](const ReliefProbe& relief) {
                return is_on_relief(relief, middle, ReliefExtractionOptions{}.tolerance + 0.005);
            });
            if (!shown) ++lost;
        }
    }
    EXPECT_GE(taken, 700u);
    EXPECT_GE(seen, 300u);
    EXPECT_EQ(lost, 0u) << "of " << seen;
}

}  // namespace
}  // namespace citystream::tiles::layers
