// The look at a facade before and after: rays that see another thing are counted, and what they fault is given back.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/tiles/layers/relief_building.h"
#include "tests/tiles/layers/relief_probe.h"
#include "tiles/layers/relief_extraction.h"
#include "tiles/layers/relief_extraction_views.h"

namespace citystream::tiles::layers {
namespace {

using namespace relief;

constexpr double kWidth = 8, kHeight = 5, kDeep = -0.2;

/// A front of four windows, and the steps of the extraction on it.
class Wall {
  public:
    Wall() : building(catalog) {
        plaster = building.material(220, 210, 190);
        glass = building.material(60, 90, 140);
        building.body(kWidth, kHeight, plaster);
        const std::vector<Opening> windows = {{1, 1, 2.2, 2.2}, {5, 1, 6.2, 2.2}, {1, 3, 2.2, 4.2}, {5, 3, 6.2, 4.2}};
        building.wall({0, 0, kWidth, kHeight}, windows, plaster);
        for (const Opening& o : windows) building.window(o, 0, kDeep, plaster, glass);
        const city::CityObject& object = building.object();
        taken.assign(object.triangles.size(), 0);
        for (const WallFrame& found : find_wall_frames(object, options)) {
            if (found.along.x > 0.9) frame = found;  // faces south
        }
        parts = gather_parts(object, frame, taken, 0.5, options);
        cells = make_cell_grid(frame, parts, 0.002, 0.015, size_t{1} << 20);
    }

    /// Compares after `change` was made to the map.
    template <typename Change>
    ViewDifference look(const Change& change) {
        const LayerStack stack(cells, parts, -0.5);
        const Surroundings surroundings(frame, parts, options.tolerance + cells.stair);
        Decider decider(cells, stack, surroundings, parts, options.tolerance);
        const Decision decision = decider.decide();
        const SlotTable slots = choose_slots(parts, decision, catalog);
        ReliefMap map = make_relief_map(cells, parts, decision, slots, options.tolerance);
        change(map);
        return WallViews(frame, parts, taken, catalog).compare(decider, decision, map, slots);
    }

    city::CityCatalog catalog;
    ReliefBuilding building;
    uint32_t plaster = 0, glass = 0;
    ReliefExtractionOptions options;
    std::vector<uint8_t> taken;
    WallFrame frame;
    FacadeParts parts;
    CellGrid cells;
};

TEST(ReliefViews, AMapThatIsRightIsSeenAsTheTrianglesWere) {
    Wall wall;
    const ViewDifference difference = wall.look([](ReliefMap&) {});
    EXPECT_GT(difference.rays, 10000u);
    EXPECT_LT(difference.wrong_share(), 0.002);
}

TEST(ReliefViews, WindowsOfAnotherDepthAreSeenAndTheirPatchesAtFault) {
    Wall wall;
    const ViewDifference difference = wall.look([](ReliefMap& map) {
        for (uint32_t& label : map.grid.labels) {
            if (codec::facade::displacement_of(label) == -200)
                label = codec::facade::make_label(-450, codec::facade::material_of(label));
        }
    });
    EXPECT_GT(difference.wrong_share(), 0.1);
    for (size_t i = 0; i < wall.parts.patches.size(); ++i) {
        if (wall.parts.patches[i].depth > -0.1) continue;
        EXPECT_GT(difference.patch_wrong[i] * 10, difference.patch_rays[i] * 8) << i;
    }
}

TEST(ReliefViews, AnotherColourIsSeen) {
    Wall wall;
    const ViewDifference difference = wall.look([](ReliefMap& map) {
        for (uint32_t& label : map.grid.labels)
            label = codec::facade::make_label(codec::facade::displacement_of(label), 0);
    });
    EXPECT_GT(difference.wrong_share(), 0.08) << "panes in the colour of the wall";
}

TEST(ReliefViews, SurfaceWhereTheModelHasAHoleIsSeen) {
    Wall wall;
    std::erase_if(wall.parts.parts, [](const Part& part) { return part.normal.w > 0.9 && part.low.w < -0.1; });
    const ViewDifference difference = wall.look([](ReliefMap& map) {
        for (uint32_t& label : map.grid.labels) {
            if (codec::facade::displacement_of(label) == codec::facade::kOpenDisplacement)
                label = codec::facade::make_label(-200, 0);
        }
    });
    EXPECT_GT(difference.wrong_share(), 0.05);
}

}  // namespace
}  // namespace citystream::tiles::layers
