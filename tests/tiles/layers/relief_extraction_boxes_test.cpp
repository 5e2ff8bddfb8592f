// Cities of plain blocks (LoD1): prisms have no relief, whatever their outlines.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "tests/tiles/city/city_probe.h"
#include "tiles/layers/relief_extraction.h"

namespace citystream::tiles::layers {
namespace {

using Outline = std::vector<std::array<double, 2>>;  // metres, counter-clockwise

/// One feature of a CityJSONSeq: prisms, as one surface each side, in millimetres.
class Block {
  public:
    Block(double x, double y, double turn) : x_(x), y_(y), cos_(std::cos(turn)), sin_(std::sin(turn)) {}

    Block& prism(const Outline& outline, double low, double high) {
        const size_t count = outline.size(), first = vertices_;
        for (const double z : {low, high}) {
            for (const auto& [u, v] : outline) add_vertex(x_ + cos_ * u - sin_ * v, y_ + sin_ * u + cos_ * v, z);
        }
        std::vector<size_t> floor, roof;
        for (size_t i = 0; i < count; ++i) {
            const size_t next = (i + 1) % count;
            surface({first + i, first + next, first + count + next, first + count + i});
            floor.push_back(first + count - 1 - i);
            roof.push_back(first + count + i);
        }
        surface(floor);
        surface(roof);
        return *this;
    }

    std::string line(size_t number) const {
        const std::string id = "\"b" + std::to_string(number) + "\"";
        return R"({"type":"CityJSONFeature","id":)" + id + R"(,"CityObjects":{)" + id +
               R"(:{"type":"Building","geometry":[{"type":"MultiSurface","lod":"1","boundaries":[)" + surfaces_ +
               R"(]}]}},"vertices":[)" + points_ + "]}\n";
    }

  private:
    void add_vertex(double x, double y, double z) {
        points_ += points_.empty() ? "[" : ",[";
        points_ += std::to_string(std::lround(x * 1000)) + "," + std::to_string(std::lround(y * 1000)) + "," +
                   std::to_string(std::lround(z * 1000)) + "]";
        ++vertices_;
    }
    void surface(const std::vector<size_t>& ring) {
        surfaces_ += surfaces_.empty() ? "[[" : ",[[";
        for (size_t i = 0; i < ring.size(); ++i) surfaces_ += (i == 0 ? "" : ",") + std::to_string(ring[i]);
        surfaces_ += "]]";
    }
    double x_, y_, cos_, sin_;
    size_t vertices_ = 0;
    std::string points_, surfaces_;
};

Outline rectangle(double u0, double v0, double u1, double v1) {
    return {{u0, v0}, {u1, v0}, {u1, v1}, {u0, v1}};
}

/// 200 blocks of other sizes, turned about, on a square of streets.
ReliefExtractionReport extract(const std::function<void(Block&, double width, double depth, double height)>& make) {
    std::string text = R"({"type":"CityJSON","version":"2.0","transform":{"scale":[0.001,0.001,0.001],)"
                       R"("translate":[500000,4000000,30]},"CityObjects":{},"vertices":[]})"
                       "\n";
    for (size_t i = 0; i < 200; ++i) {
        Block block(static_cast<double>(i % 15) * 80, static_cast<double>(i / 15) * 80,
                    static_cast<double>(i) * std::numbers::phi);
        const double size = static_cast<double>(i);
        make(block, 4 + std::fmod(size * 1.7, 41), 4 + std::fmod(size * 2.3, 29), 2.5 + std::fmod(size * 3.1, 47));
        text += block.line(i);
    }
    const city::TestFolder folder;
    city::ReadCity read = city::read_files({folder.write("blocks.city.jsonl", text)});
    EXPECT_TRUE(read.status.ok());
    ReliefExtractor extractor(read.catalog, {});
    for (city::CityObject& object : read.objects) extractor.extract(object);
    const ReliefExtractionReport report = extractor.report();
    EXPECT_EQ(report.buildings, 200u);
    EXPECT_GE(report.candidate_planes, 600u);
    return report;
}

TEST(ReliefExtractionBlocks, BoxesHaveNoFacades) {
    const auto report = extract([](Block& block, double width, double depth, double height) {
        block.prism(rectangle(0, 0, width, depth), 0, height);
    });
    EXPECT_EQ(report.facades, 0u);
    EXPECT_EQ(report.triangles_after, report.triangles_before);
}

TEST(ReliefExtractionBlocks, BlocksWithAWingHaveNoFacades) {
    const auto report = extract([](Block& block, double width, double depth, double height) {
        // The wing stands out by 0.3 m to 2 m, or far.
        const double out = std::fmod(width, 3) < 2 ? 0.3 + 0.12 * std::fmod(depth, 14) : depth / 2;
        block.prism(
            {{0, 0}, {width, 0}, {width, depth}, {width / 2, depth}, {width / 2, depth + out}, {0, depth + out}}, 0,
            height);
    });
    EXPECT_EQ(report.facades, 0u);
}

TEST(ReliefExtractionBlocks, OutlinesOfManyStepsHaveNoFacades) {
    const auto report = extract([](Block& block, double width, double depth, double height) {
        Outline outline = {{0, 0}, {width, 0}};
        constexpr int kSteps = 10;
        for (int i = kSteps; i > 0; --i) {
            const double v = depth + 0.15 * (i % 4);
            outline.push_back({width * i / kSteps, v});
            outline.push_back({width * (i - 1) / kSteps, v});
        }
        block.prism(outline, 0, height);
    });
    EXPECT_EQ(report.facades, 0u);
}

TEST(ReliefExtractionBlocks, StoreysThatStandBackHaveNoFacades) {
    const auto report = extract([](Block& block, double width, double depth, double height) {
        const double back = std::fmod(width, 1.5);
        block.prism(rectangle(0, 0, width, depth), 0, height);
        block.prism(rectangle(back, back, width - back, depth - back), height, height + 3);
        block.prism(rectangle(2 * back, 2 * back, width - back, depth - back), height + 3, height + 6);
    });
    EXPECT_EQ(report.facades, 0u);
}

}  // namespace
}  // namespace citystream::tiles::layers
