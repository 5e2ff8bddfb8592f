// Which maps of the catalog a city shows, and their numbers in the dictionary that travels: in order of first use by
// the objects along the Morton curve, so that the maps of a neighbourhood lie side by side. On request maps that are
// nearly equal become one.
#pragma once

#include <cstdint>
#include <vector>

#include "codec/result.h"
#include "tiles/city/facade_catalog.h"
#include "tiles/quadtree/object_spool.h"

namespace citystream::tiles::layers {

struct FacadeNumbers {
    static constexpr uint32_t kUnused = UINT32_MAX;
    std::vector<uint32_t> shown;   ///< by catalog map: the catalog map that stands for it; kUnused: no wall shows it
    std::vector<uint32_t> number;  ///< by catalog map, of those that stand for themselves: number in the dictionary
    std::vector<uint32_t> maps;    ///< by number: catalog map
    uint64_t merged = 0;           ///< maps that another stands for
    int32_t greatest_difference_mm = 0;  ///< between a map and the one that stands for it
};

/// `tolerance_mm` > 0: a map gives way to the first one before it that has the same size, materials and open cells and
/// displacements that nowhere differ by more. Reads the whole spool once (sorted before). Error: the disk.
/// Time of merging: O(maps x cells x maps of like mean displacement).
Result<FacadeNumbers> number_facades(quadtree::ObjectSpool& objects, const city::FacadeCatalog& catalog,
                                     uint32_t tolerance_mm);

}  // namespace citystream::tiles::layers
