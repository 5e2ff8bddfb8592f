// The city with textured walls: how textures are dealt and laid, and what stays as it is without them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "tests/tiles/city/generated_city.h"
#include "tiles/city/generator.h"
#include "tiles/city/generator_walls.h"

namespace citystream::tiles::city {
namespace {

using City = GeneratedCity;

City generate(uint32_t buildings, uint32_t textures, uint64_t seed = 1) {
    GeneratorOptions options;
    options.buildings = buildings;
    options.seed = seed;
    options.textures = textures;
    return generated_city(options);
}

/// Buildings that show each image which is made on demand.
std::map<int32_t, uint32_t> uses_of_made_images(const City& city) {
    std::map<int32_t, uint32_t> uses;
    for (const CityObject& object : city.objects) {
        std::set<int32_t> shown;
        for (const Triangle& triangle : object.triangles) {
            const int32_t image = city.catalog.materials[triangle.material].image;
            if (image >= 0 && city.catalog.images[static_cast<size_t>(image)].make) shown.insert(image);
        }
        for (const int32_t image : shown) ++uses[image];
    }
    return uses;
}

bool same_triangles(const CityObject& a, const CityObject& b) {
    const auto corner = [](const CityObject& object, const Triangle& triangle, size_t k) {
        const Vec3& at = object.vertices[triangle.vertex[k]];
        return std::array{at.x, at.y, at.z, triangle.texcoord[k].x, triangle.texcoord[k].y};
    };
    if (a.triangles.size() != b.triangles.size()) return false;
    for (size_t i = 0; i < a.triangles.size(); ++i) {
        if (a.triangles[i].material != b.triangles[i].material) return false;
        for (size_t k = 0; k < 3; ++k)
            if (corner(a, a.triangles[i], k) != corner(b, b.triangles[i], k)) return false;
    }
    return true;
}

TEST(TexturedCity, ShowsExactlyAsManyDistinctTexturesAsAsked) {
    for (const uint32_t textures : {procedural::kLeastTextures, 200U, 601U}) {
        const City city = generate(1000, textures);
        EXPECT_EQ(city.report.buildings_emitted, 1000U);
        EXPECT_EQ(uses_of_made_images(city).size(), textures);
    }
}

TEST(TexturedCity, NeverHoldsMoreTexturesThanBuildingsWant) {
    const City city = generate(10, 5000);
    EXPECT_LE(city.catalog.images.size(), 100U);
    EXPECT_GE(uses_of_made_images(city).size(), 10U);
}

TEST(TexturedCity, HasFewCommonTexturesAndManyRareOnes) {
    std::vector<uint32_t> uses;
    uint64_t total = 0, common = 0;
    for (const auto& [image, count] : uses_of_made_images(generate(3000, 1500))) {
        uses.push_back(count);
        total += count;
    }
    std::sort(uses.rbegin(), uses.rend());
    for (size_t i = 0; i < uses.size() / 8; ++i) common += uses[i];
    EXPECT_GT(common, total / 3);
    EXPECT_LT(common, total * 2 / 3);
    EXPECT_LE(uses[uses.size() / 2], total / uses.size()) << "the median is not rarer than the mean";
}

TEST(TexturedCity, LeavesImagesToBeMadeAndMakesThemAlike) {
    const City city = generate(300, 120), again = generate(300, 120);
    ASSERT_EQ(city.catalog.images.size(), again.catalog.images.size());
    size_t made = 0;
    for (size_t i = 0; i < city.catalog.images.size(); ++i) {
        const ImageSource& image = city.catalog.images[i];
        EXPECT_NE(static_cast<bool>(image.pixels), static_cast<bool>(image.make));
        if (!image.make || made >= 10) continue;
        ++made;
        EXPECT_EQ(image.drawn()->rgb, again.catalog.images[i].drawn()->rgb);
    }
    EXPECT_EQ(made, 10U);
    ASSERT_EQ(city.objects.size(), again.objects.size());
    for (size_t i = 0; i < city.objects.size(); ++i)
        EXPECT_TRUE(same_triangles(city.objects[i], again.objects[i])) << city.objects[i].id;
}

TEST(TexturedCity, HasNoReliefAndTheGroundTreesAndPlacesOfTheCityWithRelief) {
    const City textured = generate(300, 120), relief = generate(300, 0);
    ASSERT_EQ(textured.objects.size(), relief.objects.size());
    for (size_t i = 0; i < relief.objects.size(); ++i) {
        const CityObject &a = textured.objects[i], &b = relief.objects[i];
        EXPECT_TRUE(a.facades.empty());
        EXPECT_EQ(a.id, b.id);
        if (a.kind != ObjectKind::kBuilding) {
            EXPECT_TRUE(same_triangles(a, b)) << a.id;
            continue;
        }
        const auto roofs = [](const CityObject& object) {
            return std::count_if(object.triangles.begin(), object.triangles.end(),
                                 [](const Triangle& t) { return t.surface == SurfaceKind::kRoof; });
        };
        EXPECT_EQ(roofs(a), roofs(b)) << a.id;
        // A building with relief has its walls' feet and roof's head among its vertices, too.
        const auto highest = [](const CityObject& object) {
            return std::max_element(object.vertices.begin(), object.vertices.end(),
                                    [](const Vec3& p, const Vec3& q) { return p.z < q.z; })
                ->z;
        };
        EXPECT_EQ(highest(a), highest(b)) << a.id;
    }
}

TEST(TexturedCity, LaysWholeWindowsAboutAsLargeAsTheTextureSays) {
    const City city = generate(400, 100);
    double least = 10, most = 0, area = 0, fitting = 0;
    for (const CityObject& object : city.objects) {
        for (const Triangle& triangle : object.triangles) {
            const Material& material = city.catalog.materials[triangle.material];
            if (material.image < 0 || !city.catalog.images[static_cast<size_t>(material.image)].make) continue;
            const auto& t = triangle.texcoord;
            for (const Vec2& at : t) ASSERT_LT(std::max(std::abs(at.x), std::abs(at.y)), 64);
            if (t[0].y != t[1].y || t[0].x == t[1].x) continue;
            const Vec3 &a = object.vertices[triangle.vertex[0]], &b = object.vertices[triangle.vertex[1]];
            const double length = std::hypot(b.x - a.x, b.y - a.y);
            const double stretch =
                length / (std::abs(t[1].x - t[0].x) * static_cast<double>(material.metres_per_repeat));
            least = std::min(least, stretch);
            most = std::max(most, stretch);
            area += length;
            if (stretch > 0.8 && stretch < 1.25) fitting += length;
        }
    }
    EXPECT_GT(area, 1000);
    EXPECT_GT(least, 0.5);
    EXPECT_LT(most, 2.01);
    EXPECT_GT(fitting, 0.9 * area);
}

TEST(TexturedCity, SaysSoInItsTitle) {
    EXPECT_EQ(generate(5, 60).header.title, "generated city (seed 1, 5 buildings, 60 wall textures)");
}

}  // namespace
}  // namespace citystream::tiles::city
