// What the generator promises of its stream as a whole: counts, repeatability, coordinates, catalog.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <vector>

#include "tests/tiles/city/generated_city.h"
#include "tiles/city/generator.h"
#include "tiles/city/generator_random.h"

namespace citystream::tiles::city {
namespace {

using City = GeneratedCity;

City generate(uint32_t buildings, uint64_t seed, Vec2 origin = {}) {
    GeneratorOptions options;
    options.buildings = buildings;
    options.seed = seed;
    options.origin = origin;
    return generated_city(options);
}

size_t count(const City& city, ObjectKind kind) {
    return static_cast<size_t>(std::count_if(city.objects.begin(), city.objects.end(),
                                             [kind](const CityObject& object) { return object.kind == kind; }));
}

class Digest {
  public:
    void add(uint64_t word) { value_ = procedural::mix(value_ ^ word); }
    void add(double number) {
        uint64_t word = 0;
        std::memcpy(&word, &number, sizeof word);
        add(word);
    }
    uint64_t value() const { return value_; }

  private:
    uint64_t value_ = 0;
};

uint64_t digest(const City& city) {
    Digest digest;
    for (const CityObject& object : city.objects) {
        for (char letter : object.id) digest.add(static_cast<uint64_t>(letter));
        for (const Vec3& at : object.vertices)
            for (double part : {at.x, at.y, at.z}) digest.add(part);
        for (const Triangle& triangle : object.triangles) {
            digest.add(uint64_t{triangle.material});
            for (size_t i = 0; i < 3; ++i) {
                digest.add(uint64_t{triangle.vertex[i]});
                digest.add(triangle.texcoord[i].x);
                digest.add(triangle.texcoord[i].y);
            }
        }
        for (const FacadeWall& wall : object.facades) {
            for (double part :
                 {wall.lower_left.x, wall.lower_left.y, wall.lower_left.z, wall.along.x, wall.along.y, wall.height})
                digest.add(part);
            digest.add(uint64_t{wall.map});
            digest.add(uint64_t{wall.palette});
        }
    }
    for (uint32_t i = 0; i < city.catalog.facade_maps.size(); ++i) {
        const codec::facade::RunGrid map = city.catalog.facade_maps.map(i);
        for (const auto* list : {&map.x_breaks, &map.y_breaks, &map.labels})
            for (uint32_t word : *list) digest.add(uint64_t{word});
    }
    for (const ImageSource& image : city.catalog.images)
        for (uint8_t level : image.pixels->rgb) digest.add(uint64_t{level});
    return digest.value();
}

TEST(Generator, EmitsExactlyAsManyBuildingsAsAsked) {
    for (uint32_t buildings : {0U, 1U, 7U, 61U, 200U}) {
        const City city = generate(buildings, 3);
        EXPECT_EQ(count(city, ObjectKind::kBuilding), buildings);
        EXPECT_EQ(city.report.buildings_emitted, buildings);
        EXPECT_EQ(city.report.features_read, buildings);
        EXPECT_EQ(city.report.objects_emitted, city.objects.size());
        uint64_t triangles = 0;
        for (const CityObject& object : city.objects) triangles += object.triangles.size();
        EXPECT_EQ(city.report.triangles_emitted, triangles);
        EXPECT_GT(count(city, ObjectKind::kTerrain), 0U);
    }
}

TEST(Generator, MakesATownOfAThousandBuildingsFromFewMapsAndAllTypes) {
    const City city = generate(1000, 1);
    EXPECT_EQ(count(city, ObjectKind::kBuilding), 1000U);
    EXPECT_LE(city.catalog.facade_maps.size(), 700U);
    size_t facades = 0, detached = 0, attached = 0;
    double highest = 0;
    for (const CityObject& object : city.objects) {
        if (object.kind != ObjectKind::kBuilding) continue;
        facades += object.facades.size();
        detached += object.facades.size() >= 4 && object.facades.size() <= 5;
        attached += object.facades.size() == 2;
        for (const FacadeWall& wall : object.facades) highest = std::max(highest, wall.lower_left.z + wall.height);
    }
    EXPECT_GT(facades, 2000U);
    EXPECT_GT(detached, 100U);
    EXPECT_GT(attached, 100U);
    EXPECT_GT(highest, 60) << "no tower";
    EXPECT_LT(highest, 200);
}

TEST(Generator, GivesTheSameStreamForTheSameSeed) {
    EXPECT_EQ(digest(generate(150, 5)), digest(generate(150, 5)));
}

TEST(Generator, StillGivesTheCityOfItsFirstVersion) {
    EXPECT_EQ(digest(generate(150, 5)), 6341391991242704009U);
}

TEST(Generator, GivesAnotherCityForAnotherSeed) {
    EXPECT_NE(digest(generate(60, 5)), digest(generate(60, 6)));
}

TEST(Generator, KeepsEveryRelativeCoordinateWhenTheOriginMoves) {
    const Vec2 origin{10'000'000, -9'999'999};
    const City here = generate(150, 2), there = generate(150, 2, origin);
    ASSERT_EQ(here.objects.size(), there.objects.size());
    for (size_t i = 0; i < here.objects.size(); ++i) {
        const CityObject &a = here.objects[i], &b = there.objects[i];
        ASSERT_EQ(a.vertices.size(), b.vertices.size());
        for (size_t v = 0; v < a.vertices.size(); ++v) {
            ASSERT_EQ(a.vertices[v].x, b.vertices[v].x - origin.x);
            ASSERT_EQ(a.vertices[v].y, b.vertices[v].y - origin.y);
            ASSERT_EQ(a.vertices[v].z, b.vertices[v].z);
        }
        ASSERT_EQ(a.facades.size(), b.facades.size());
        for (size_t f = 0; f < a.facades.size(); ++f) {
            ASSERT_EQ(a.facades[f].lower_left.x, b.facades[f].lower_left.x - origin.x);
            ASSERT_EQ(a.facades[f].along.x, b.facades[f].along.x);
            ASSERT_EQ(a.facades[f].map, b.facades[f].map);
        }
    }
}

TEST(Generator, PutsEveryCoordinateOnTheGlobalGrid) {
    const auto on_grid = [](double metres) { return metres * 1024 == std::floor(metres * 1024); };
    for (const CityObject& object : generate(200, 9).objects) {
        for (const Vec3& at : object.vertices)
            ASSERT_TRUE(on_grid(at.x) && on_grid(at.y) && on_grid(at.z)) << object.id;
        for (const FacadeWall& wall : object.facades)
            for (double part :
                 {wall.lower_left.x, wall.lower_left.y, wall.lower_left.z, wall.along.x, wall.along.y, wall.height})
                ASSERT_TRUE(on_grid(part)) << object.id;
    }
}

TEST(Generator, StopsWhenTheSinkWantsNoMore) {
    CityHeader header;
    CityCatalog catalog;
    CityReport report;
    GeneratorOptions options;
    int seen = 0;
    generate_city(options, header, catalog, report, [&seen](CityObject&&) { return ++seen < 5; });
    EXPECT_EQ(seen, 5);
}

TEST(Generator, TellsProgressAtMostAThousandTimesAndEndsAtTheTotal) {
    CityHeader header;
    CityCatalog catalog;
    CityReport report;
    GeneratorOptions options;
    options.buildings = 1001;
    uint64_t calls = 0, last = 0;
    options.progress = [&](uint64_t done, uint64_t total) {
        ++calls;
        EXPECT_GT(done, last);
        EXPECT_EQ(total, 1001U);
        last = done;
    };
    generate_city(options, header, catalog, report, [](CityObject&&) { return true; });
    EXPECT_LE(calls, 1000U);
    EXPECT_EQ(last, 1001U);
    EXPECT_EQ(header.title, "generated city (seed 1, 1001 buildings)");
}

TEST(Generator, RefersOnlyToWhatTheCatalogHolds) {
    const City city = generate(200, 4);
    const CityCatalog& catalog = city.catalog;
    for (const Material& material : catalog.materials) {
        ASSERT_LT(material.image, static_cast<int32_t>(catalog.images.size()));
        EXPECT_GT(material.metres_per_repeat, 0);
    }
    for (const ImageSource& image : catalog.images) {
        ASSERT_TRUE(image.pixels);
        EXPECT_EQ(image.pixels->rgb.size(), size_t{3} * image.pixels->width * image.pixels->height);
    }
    for (const FacadePalette& palette : catalog.palettes)
        for (uint32_t material : palette.material) ASSERT_LT(material, catalog.materials.size());
    std::set<uint32_t> palettes_seen;
    for (const CityObject& object : city.objects) {
        for (const Triangle& triangle : object.triangles) {
            ASSERT_LT(triangle.material, catalog.materials.size());
            for (uint32_t vertex : triangle.vertex) ASSERT_LT(vertex, object.vertices.size());
            for (const Vec2& at : triangle.texcoord) ASSERT_LT(std::max(std::abs(at.x), std::abs(at.y)), 64);
        }
        for (const FacadeWall& wall : object.facades) {
            ASSERT_LT(wall.map, catalog.facade_maps.size());
            ASSERT_LT(wall.palette, catalog.palettes.size());
            palettes_seen.insert(wall.palette);
        }
    }
    EXPECT_GT(palettes_seen.size(), 8U);
    std::set<std::array<std::vector<uint32_t>, 3>> distinct;
    for (uint32_t i = 0; i < catalog.facade_maps.size(); ++i) {
        const codec::facade::RunGrid map = catalog.facade_maps.map(i);
        distinct.insert({map.x_breaks, map.y_breaks, map.labels});
    }
    EXPECT_EQ(distinct.size(), catalog.facade_maps.size()) << "a map is stored twice";
}

}  // namespace
}  // namespace citystream::tiles::city
