// How the mesh pass gets the frame of a chart that lies in a page (wrap_coordinate_layout.h): what --chart-transport
// chooses from. Frames are the same bytes with all of them; memory and time differ. Tiles with charts of their own form
// (atlas_layer.h) have no frames and are drawn as they always are.
//
// Source: "Space-Optimized Texture Atlases" 8.1.2, Table 1, for all but kTable.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/render/draw_layout.h"

namespace citystream::client {

enum class ChartTransport {
    kTable = CHART_TRANSPORT_TABLE,          ///< "table": the triangle's entry in the layer's chart table; no memory
    kUniform = CHART_TRANSPORT_UNIFORM,      ///< "uniform": push constants, one draw for each run of equal charts
    kAttribute = CHART_TRANSPORT_ATTRIBUTE,  ///< "attribute": four floats a corner
    kPacked = CHART_TRANSPORT_PACKED,        ///< "packed": 2 x 32 bits a corner that hold its place in the chart, too
};
inline constexpr std::array<ChartTransport, 4> kChartTransports = {ChartTransport::kTable, ChartTransport::kUniform,
                                                                   ChartTransport::kAttribute, ChartTransport::kPacked};

std::string_view chart_transport_name(ChartTransport transport);
std::optional<ChartTransport> chart_transport_named(std::string_view name);
std::vector<std::string> chart_transport_names();

}  // namespace citystream::client
