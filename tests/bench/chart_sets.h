// The sets of charts that the packing bench measures: as many as in the paper's Table 14, for pages of the same sizes.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "codec/atlas/rectangle_packing_atlas.h"

namespace citystream::bench {

/// Columns of Table 14; percent of the page.
struct PrintedPacking {
    size_t charts;
    uint32_t side;
    double metres_per_texel;
    double plain, fill, optimised, both;
};
constexpr std::array<PrintedPacking, 5> kTable14 = {{{192, 2048, 0.02, 72.37, 78.14, 89.48, 100},
                                                     {378, 2048, 0.03, 81.85, 85.44, 95.29, 100},
                                                     {1107, 4096, 0.03, 75.56, 77.96, 95.34, 100},
                                                     {1689, 4096, 0.04, 83.65, 85.58, 96.36, 100},
                                                     {2897, 4096, 0.05, 92.20, 94.32, 96.96, 100}}};

/// Sizes of all images below some folders, sorted by path; images that cannot be opened or are smaller than 16 texels
/// on a side are left out. Only their headers are read.
std::vector<codec::atlas::RectangleSize> image_sizes(const std::vector<std::string>& folders_and_files);

/// Folders of ../shared/data beside the source tree with textures of buildings.
std::vector<std::string> texture_folders();

/// One set. Each chart shows an image (they are taken in turn; without any, made sizes) on a wall some metres wide, at
/// metres per texel that make the charts, with border and alignment, cover `printed.plain` percent of the page: then
/// the predicted page is the one of the table. The most that a chart may grow to is its image's size. Deterministic.
std::vector<codec::atlas::ChartRequest> table_14_set(const PrintedPacking& printed,
                                                     const std::vector<codec::atlas::RectangleSize>& images,
                                                     const codec::atlas::AtlasPackingOptions& options);

}  // namespace citystream::bench
