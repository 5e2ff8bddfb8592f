// What the transports of chart_transport.h need of a tile whose atlas is in pages, from its mesh and its chart table:
// runs of triangles for kUniform, the words of a coordinate layer (draw_layout.h) for kAttribute and kPacked.
//
// kPacked holds places as wrap_coordinate.h says: of 1/512 repeat, from 0 to below 64 (whole repeats that a chart's
// coordinates in the tile begin with are left out first, as the shaders do). A tile with any other place takes
// kAttribute, so that frames are the same. A tile of more pages than a transport can name takes kTable.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "client/render/chart_transport.h"
#include "codec/result.h"

namespace citystream::client {

/// Consecutive triangles of a range with one chart.
struct ChartRun {
    uint32_t range = 0, first = 0, triangles = 0;
    std::array<uint32_t, 2> words{};  ///< TileConstants.shared_charts of their draw
};

struct ChartCoordinates {
    ChartTransport transport = ChartTransport::kTable;  ///< that the tile takes
    std::vector<ChartRun> runs;                         ///< kUniform: all triangles in their order
    std::vector<uint32_t> words;                        ///< kAttribute, kPacked
};

/// Words of a page layer from its beginning that hold its chart table; 0 where its header says none that can be.
uint64_t page_table_words(std::span<const uint32_t> header);

/// `mesh`: all its words. `table`: page_table_words() of the atlas. Safe for words that nobody vouches for: whatever
/// does not add up is an error. O(triangles).
Result<ChartCoordinates> make_chart_coordinates(ChartTransport wanted, std::span<const uint32_t> mesh,
                                                std::span<const uint32_t> table);

}  // namespace citystream::client
