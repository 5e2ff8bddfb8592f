// The radiance layer by every transport through the builder: the same receivers and words, what is written anew of the
// archive that is replaced, and what `info` says.
#include <gtest/gtest.h>

#include <span>
#include <vector>

#include "codec/radiance/radiance_layer.h"
#include "tests/tiles/layers/radiance_builds.h"
#include "tiles/layers/inspect_city.h"

namespace citystream::tiles::layers {
namespace {

using codec::radiance::kRadianceTransportNames;
using codec::radiance::MatrixForm;
using codec::radiance::RadianceTransport;
using tileset::Layer;
using enum RadianceTransport;

constexpr std::array<RadianceTransport, 4> kTransports = {kVisibility, kBiclusters, kDistinctRows, kRows};

class RadianceTransportBuild : public RadianceBuildTest {
  protected:
    RadianceTransportBuild() : RadianceBuildTest(16, 4) {}

    BuildOptions usual_options() const override {
        BuildOptions options = RadianceBuildTest::usual_options();
        options.leaf_triangles = 150;
        return options;
    }

    BuildSummary built(const std::string& name, RadianceTransport transport, double error = 0) const {
        auto summary = build(name, generated(6), [&](BuildOptions& options) {
            options.radiance.transport = transport;
            options.radiance.error = error;
        });
        EXPECT_TRUE(summary) << summary.error().text();
        if (!summary || !summary->radiance) return {};
        EXPECT_EQ(summary->radiance->tiles, summary->radiance->baked + summary->radiance->reused);
        EXPECT_EQ(summary->radiance->transport, transport);
        return std::move(*summary);
    }

    /// Of all tiles, one behind the other.
    std::vector<uint32_t> words_of(const std::string& name, MatrixForm form) const {
        const OpenCity city = open_city(path(name));
        std::vector<uint32_t> all;
        for (const auto& [address, record] : city.tiles) {
            const auto bytes = city.reader->find(tileset::layer_path(Layer::kRadiance, address));
            std::vector<std::span<const std::byte>> wire;
            uint64_t begin = 0, decoded_bytes = 0;
            for (const tileset::StepRecord& step : record.steps(Layer::kRadiance)) {
                wire.push_back(bytes.subspan(begin, step.end - begin));
                begin = step.end;
                decoded_bytes += step.decoded_bytes;
            }
            const auto words = codec::radiance::decode_radiance_layer(wire, decoded_bytes, form);
            EXPECT_TRUE(words) << words.error().text();
            if (words) all.insert(all.end(), words->begin(), words->end());
        }
        return all;
    }
};

TEST_F(RadianceTransportBuild, WordsAreTheSameWhicheverWayTheyTravel) {
    for (const RadianceTransport transport : kTransports) {
        const std::string name(name_of(transport));
        const BuildSummary summary = built(name, transport);
        EXPECT_EQ(summary.radiance->reused, 0U);
        EXPECT_GT(summary.radiance->tiles, 1U) << "the test is too easy";
        for (const MatrixForm form : {MatrixForm::kRows, MatrixForm::kBiclusters})
            EXPECT_EQ(words_of(name, form), words_of("visibility", form)) << name;
        const auto info = read_city_info(path(name));
        ASSERT_TRUE(info) << info.error().text();
        const auto& radiance = (*info)["radiance"];
        EXPECT_EQ(radiance["transports"], (nlohmann::json{{name, summary.radiance->tiles}}));
        EXPECT_EQ(radiance["receivers"], summary.radiance->receivers);
        EXPECT_EQ(radiance["prefixes"].size(), transport == kVisibility ? 3U : 1U);
        EXPECT_EQ(radiance["prefixes"].back()["wire_bytes"], (*info)["layers"]["radiance"]["wire_bytes"]);
        EXPECT_EQ((*info)["build_options"].get<std::string>().find("radiance-transport=" + name) != std::string::npos,
                  transport != kVisibility);
        const auto damages = verify_city(path(name));
        ASSERT_TRUE(damages);
        EXPECT_TRUE(damages->empty()) << damages->front();
    }
}

TEST_F(RadianceTransportBuild, BitsThatAreThereAreWrittenInAnotherTransportWithoutRays) {
    constexpr double kError = 0.02;
    const BuildSummary first = built("bits.3tz", kVisibility, kError);
    for (const RadianceTransport transport : {kBiclusters, kDistinctRows, kRows}) {
        const auto anew = std::filesystem::copy_options::overwrite_existing;
        std::filesystem::copy_file(path("bits.3tz"), path("city.3tz"), anew);
        const BuildSummary second = built("city.3tz", transport, kError);
        EXPECT_EQ(second.radiance->recoded, second.radiance->tiles);
        EXPECT_EQ(second.radiance->rays, 0U);
        const std::string fresh = std::string(name_of(transport));
        EXPECT_GT(built(fresh, transport, kError).radiance->rays, 0U);
        EXPECT_EQ(bytes_of("city.3tz"), bytes_of(fresh));
        const BuildSummary third = built("city.3tz", transport, kError);
        EXPECT_EQ(third.radiance->reused, third.radiance->tiles);
        EXPECT_EQ(third.radiance->recoded, 0U);
    }
    // A matrix has no bits: the way back needs rays.
    const BuildSummary back = built("city.3tz", kVisibility, kError);
    EXPECT_EQ(back.radiance->baked, first.radiance->tiles);
    EXPECT_EQ(bytes_of("city.3tz"), bytes_of("bits.3tz"));
}

TEST(RadianceForm, SaysATransportThatIsNotTheUsual) {
    EXPECT_EQ(to_string(RadianceForm{}), " lattice=4m directions=32 local-directions=8");
    EXPECT_EQ(to_string(RadianceForm{.transport = kDistinctRows}),
              " lattice=4m directions=32 local-directions=8 radiance-transport=distinct-rows");
}

}  // namespace
}  // namespace citystream::tiles::layers
