// What tests of builds with light have in common.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>

#include "tests/tiles/layers/city_builds.h"
#include "tiles/layers/radiance_form.h"

namespace citystream::tiles::layers {

/// Mesh and radiance alone, on few rays; skipped where there is no Embree.
class RadianceBuildTest : public CityBuildTest {
  protected:
    RadianceBuildTest(uint32_t lattice_metres, uint32_t texels_across)
        : lattice_metres_(lattice_metres), texels_across_(texels_across) {}

    void SetUp() override {
        if (!radiance_can_be_built()) GTEST_SKIP() << "there is no Embree";
    }
    BuildOptions usual_options() const override {
        BuildOptions options = CityBuildTest::usual_options();
        options.layers = {true, false, false, true};
        options.radiance.lattice_metres = lattice_metres_;
        options.radiance.texels_across = texels_across_;
        return options;
    }

  private:
    uint32_t lattice_metres_, texels_across_;
};

}  // namespace citystream::tiles::layers
