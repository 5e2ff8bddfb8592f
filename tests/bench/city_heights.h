// How high a city's surfaces are: where cameras may stand.
#pragma once

#include <array>
#include <vector>

#include "codec/mesh/mesh_tile.h"
#include "codec/result.h"
#include "tests/bench/sample_city.h"

namespace citystream::bench {

/// All steps of a tile's mesh layer.
Result<codec::mesh::MeshTile> mesh_of(const SampleCity& city, const tiles::tileset::TileRecord& record);

class CityHeights {
  public:
    /// Decodes the meshes of all leaves.
    static Result<CityHeights> of_city(const SampleCity& city);

    /// Metres: of the highest surface above or below (x, y) in the city's coordinates; the lowest point of the city
    /// where there is none. O(triangles of the leaf there).
    double highest_at(double x, double y) const;

  private:
    struct Leaf {
        std::array<double, 2> low, high;  ///< x, y, metres
        std::array<double, 3> origin;
        codec::mesh::MeshTile mesh;
    };
    std::vector<Leaf> leaves_;
    double lowest_ = 0;
};

}  // namespace citystream::bench
