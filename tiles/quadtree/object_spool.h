// Pass 1 of a build: city objects go to a spool file on the global grid, ground cut at 64 m cells, and an index says
// which cell each belongs to. Memory: 24 bytes an object, whatever its geometry.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tiles/city/city_model.h"
#include "tiles/quadtree/build_object.h"
#include "tiles/quadtree/spool_file.h"

namespace citystream::tiles::quadtree {

inline constexpr int kCellLog2Metres = 6;  ///< 64 m: the smallest leaf
inline constexpr int kCellGridBits = kCellLog2Metres + kGridBits;

struct SpooledObject {
    int32_t cell_x = 0, cell_y = 0;  ///< absolute, in cells
    uint64_t offset = 0;
    uint32_t size = 0;
    uint32_t weight = 0;  ///< triangles; a facade counts as two
};

class ObjectSpool {
  public:
    static Result<std::unique_ptr<ObjectSpool>> create(const std::string& folder);

    /// Quantises and stores one object; what cannot be placed (coordinates that are no numbers or beyond 2^31 m) is
    /// reported and left out. Ground that spans several cells is cut at their borders (both sides get the same points).
    /// Error: the disk.
    Status add(const city::CityObject& object, const city::CityCatalog& catalog, city::CityReport& report);

    /// Brings the index into Morton order of the cells counted from `origin` (grid units, a multiple of the cell),
    /// input order within a cell. Cells are held inside the root of `root_cells` x `root_cells` (an object flat on its
    /// far border belongs to the last cell).
    void sort(const GridPoint& origin, int64_t root_cells);

    /// Objects [begin, end) of the sorted index.
    Result<std::vector<BuildObject>> load(size_t begin, size_t end);

    const std::vector<SpooledObject>& index() const { return index_; }
    const GridBox& extent() const { return extent_; }
    bool has_ground() const { return has_ground_; }
    uint64_t facades() const { return facades_; }

  private:
    explicit ObjectSpool(std::unique_ptr<SpoolFile> file) : file_(std::move(file)) {}
    Status store(const BuildObject& object, const GridBox& box);
    Status store_cut(const BuildObject& object, const GridBox& box);

    std::unique_ptr<SpoolFile> file_;
    std::vector<SpooledObject> index_;
    std::vector<std::byte> scratch_;
    GridBox extent_;
    bool has_ground_ = false;
    uint64_t facades_ = 0;
};

/// The parts of a ground object in the cells it touches, in row order of the cells.
std::vector<BuildObject> cut_at_cells(const BuildObject& object);

/// Interleaves the low 32 bits of x (even bits) and y (odd bits).
uint64_t morton(uint32_t x, uint32_t y);

}  // namespace citystream::tiles::quadtree
