// The facades that benches measure: made ones of the four sizes of the paper's Table 1, and rasters from files.
#pragma once

#include <string>
#include <vector>

#include "codec/facade/run_grid.h"
#include "codec/result.h"

namespace citystream::bench {

struct BenchFacade {
    std::string name;
    codec::facade::RunGrid grid;
};

enum class FacadeStyle {
    kRegular,    ///< equal windows with frames, mullions and sills, dentils, a ground floor of shops
    kIrregular,  ///< jittered windows of many kinds, balconies with bars, blinds, quoins
    kOrnate,     ///< irregular with arches, gables, discs and a diagonal: the bad case
};

/// F1 600 x 1000, F2 1536 x 2048, F3 1024 x 768, F4 930 x 1166 texels (Table 1 and Fig. 12 of the paper; its pictures
/// are not public). The same maps from every standard library.
std::vector<BenchFacade> paper_facades(FacadeStyle style);

/// One facade from two grey images of one size. 16-bit displacement: millimetres = value - 32768, 0 means no surface;
/// 8-bit: the value. Material: the value. Displacements are rounded to multiples of `step_mm`.
Result<BenchFacade> read_facade(const std::string& displacement_file, const std::string& material_file,
                                int step_mm = 1);

/// All FOLDER/NAME_depth.png with FOLDER/NAME_material.png, sorted by name; empty when there is no such folder.
std::vector<BenchFacade> raster_facades(const std::string& folder, int step_mm = 1);

/// ../shared/data/ingolstadt_facade_rasters beside the source tree.
std::string surveyed_facades_folder();

}  // namespace citystream::bench
