#include "tiles/layers/mesh_form.h"

#include <gtest/gtest.h>

namespace citystream::tiles::layers::test {
namespace {

using codec::mesh::MeshTopology;

TEST(MeshForm, SaysNothingOfWhatIsAsByDefault) {
    EXPECT_EQ("", to_string(MeshForm()));
    EXPECT_EQ(" mesh-transport=draco normal-bits=24 mesh-topology=strip-code precision=cap mesh-steps=2",
              to_string({MeshTransport::kDraco, 24, MeshTopology::kStripCode, PositionPrecision::kConstrained, 2}));
}

TEST(MeshForm, NormalsTakeAnEvenNumberOfBits) {
    for (const uint32_t bits : {8u, 16u, 24u, 32u}) {
        MeshForm form;
        form.normal_bits = bits;
        EXPECT_TRUE(check_mesh_form(form));
        EXPECT_EQ(bits, 2 * form.layer_options(0, 1 << 16, {}).content.normal_bits);
    }
    for (const uint32_t bits : {0u, 7u, 15u, 34u, 4'000'000'000u}) {
        MeshForm form;
        form.normal_bits = bits;
        const Status refused = check_mesh_form(form);
        ASSERT_FALSE(refused) << bits;
        EXPECT_NE(refused.error().text().find(std::to_string(bits)), std::string::npos);
    }
}

TEST(MeshForm, StepsAreOfTheCodecsNumber) {
    MeshForm form;
    EXPECT_TRUE(check_mesh_form(form));
    for (const uint32_t steps : {1u, 4u}) {
        form.steps = steps;
        EXPECT_TRUE(check_mesh_form(form));
    }
    for (const uint32_t steps : {0u, 5u}) {
        form.steps = steps;
        EXPECT_FALSE(check_mesh_form(form)) << steps;
    }
}

TEST(MeshForm, GoesIntoTheOptionsOfTheCodec) {
    MeshForm form{MeshTransport::kDefault, 16, MeshTopology::kLocalStrips, PositionPrecision::kConstrained, 4};
    const auto layer = form.layer_options(0.5f, 1 << 17, [](uint32_t chart) {
        return std::array<uint32_t, 2>{chart, 7};
    });
    const auto& options = layer.content;
    EXPECT_EQ(0.5f, options.finest_error_metres);
    EXPECT_EQ(MeshTopology::kLocalStrips, options.topology);
    EXPECT_EQ(4u, options.most_steps);
    EXPECT_FALSE(layer.choose_steps);
    ASSERT_TRUE(options.constraint);
    EXPECT_EQ(1 << 17, options.constraint->tile_side);
    EXPECT_EQ((std::array<uint32_t, 2>{9, 7}), options.constraint->chart_size(9));

    form.precision = PositionPrecision::kAdaptive;
    form.transport = MeshTransport::kDraco;
    const auto draco = form.layer_options(0, int64_t{1} << 40, {});
    EXPECT_EQ(MeshTransport::kDraco, draco.transport);
    EXPECT_FALSE(draco.content.constraint);
    EXPECT_EQ(1u, draco.content.most_steps) << "Draco has no steps";
}

TEST(MeshForm, StepsAreChosenUnlessToldHowMany) {
    const auto chosen = MeshForm().layer_options(0, 1 << 17, {});
    EXPECT_TRUE(chosen.choose_steps);
    EXPECT_EQ(kMostChosenSteps, chosen.content.most_steps);
}

}  // namespace
}  // namespace citystream::tiles::layers::test
