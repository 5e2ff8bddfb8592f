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

/// Most steps of a layer: as many as the builder finds to pay, or so many wherever there can be.
enum class StepChoice : uint8_t { kBest, kOne, kTwo, kThree };
inline constexpr std::array<StepChoice, 4> kStepChoices = {StepChoice::kBest, StepChoice::kOne, StepChoice::kTwo,
                                                           StepChoice::kThree};

/// A layer in steps. Bytes of positions are those of points in the first step, and all of further steps.
struct PositionSteps {
    std::vector<uint32_t> dropped;  ///< bits, by step
    std::vector<double> bytes;      ///< of positions, up to the end of each step
    double other = 0;               ///< bytes of everything else

    /// The first that drops no more than `granted` bits, else the last.
    size_t step_for(uint32_t granted) const;
};

/// The mesh of one tile.
class PositionCosts {
  public:
    /// Decodes the tile's mesh layer. `record` outlives the object.
    static Result<PositionCosts> of_tile(const SampleCity& city, const tiles::tileset::TileRecord& record);

    const tiles::tileset::TileRecord& record() const { return *record_; }
    const codec::mesh::MeshTile& mesh() const { return mesh_; }
    /// Of a coordinate with nothing dropped.
    uint32_t full_bits() const { return full_bits_; }
    const PositionSteps& steps(StepChoice choice) const { return steps_[static_cast<size_t>(choice)]; }
    /// In one step that drops `dropped` bits; no fewer than the geometry is worth. Encodes when asked for the first
    /// time.
    double fixed_bytes(uint32_t dropped);
    uint32_t finest_dropped() const { return steps(StepChoice::kOne).dropped.back(); }

  private:
    const tiles::tileset::TileRecord* record_ = nullptr;
    codec::mesh::MeshTile mesh_;
    uint32_t full_bits_ = 0;
    std::array<PositionSteps, kStepChoices.size()> steps_;
    std::map<uint32_t, double> fixed_;
};

}  // namespace citystream::bench
