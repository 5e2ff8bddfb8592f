// What the positions of a city's tiles take on the wire, in steps and at any fixed number of bits.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "codec/mesh/mesh_tile.h"
#include "codec/result.h"
#include "tests/bench/sample_city.h"

namespace citystream::bench {

/// The mesh of one tile. Bytes are of positions alone: those of points in the first step, and all of further steps.
class PositionCosts {
  public:
    /// Decodes the tile's mesh layer. `record` outlives the object.
    static Result<PositionCosts> of_tile(const SampleCity& city, const tiles::tileset::TileRecord& record);

    const tiles::tileset::TileRecord& record() const { return *record_; }
    const codec::mesh::MeshTile& mesh() const { return mesh_; }
    /// Of a coordinate with nothing dropped.
    uint32_t full_bits() const { return full_bits_; }
    /// Bits that each step drops, and bytes up to its end.
    const std::vector<uint32_t>& dropped() const { return dropped_; }
    const std::vector<double>& step_bytes() const { return step_bytes_; }
    /// Bytes of everything else, which is the same whatever positions drop.
    double other_bytes() const { return other_bytes_; }
    /// In one step that drops `dropped` bits; no fewer than the geometry is worth. Encodes when asked for the first
    /// time.
    double fixed_bytes(uint32_t dropped);
    uint32_t finest_dropped() const { return dropped_.back(); }

  private:
    const tiles::tileset::TileRecord* record_ = nullptr;
    codec::mesh::MeshTile mesh_;
    uint32_t full_bits_ = 0;
    std::vector<uint32_t> dropped_;
    std::vector<double> step_bytes_;
    double other_bytes_ = 0;
    std::map<uint32_t, double> fixed_;
};

}  // namespace citystream::bench
