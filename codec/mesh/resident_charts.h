// The chart table and the face table of a mesh layer in GPU memory (RESIDENT.md).
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <map>
#include <vector>

#include "codec/mesh/mesh_content.h"

namespace citystream::codec::mesh {

/// Charts by number: those of images first, then colours (those of prisms before others), both in order of first use.
class ResidentCharts {
  public:
    /// O(triangles log charts).
    explicit ResidentCharts(const MeshContent& content);

    uint32_t count() const { return static_cast<uint32_t>(charts_.size()); }
    uint32_t images() const { return images_; }
    /// Of a word that the content has.
    uint32_t number(uint32_t chart_word) const { return numbers_.at(chart_word); }
    /// q_u | q_v << 16 of a place in the chart; 0 for a colour.
    uint32_t texcoord(uint32_t number, const std::array<int32_t, 2>& place) const;
    /// RESIDENT_FRAME_* that all images have, or RESIDENT_FRAMES_OF_THEIR_OWN.
    std::array<uint32_t, 3> frame() const;
    /// The chart table.
    std::vector<uint32_t> words() const;

  private:
    struct Chart {
        uint32_t word = 0;
        std::array<int32_t, 2> low{}, high{};
        std::array<uint32_t, 2> shift{};
    };
    static std::array<uint32_t, 3> frame_of(const Chart& chart);
    Chart& chart_of(uint32_t chart_word);

    std::vector<Chart> charts_;
    std::map<uint32_t, uint32_t> numbers_;
    uint32_t images_ = 0;
};

/// What is the same for a whole triangle; of ranges whose vertices have normals the chart alone.
struct SurfaceFace {
    uint32_t chart = 0;   ///< number
    uint32_t normal = 0;  ///< code
    auto operator<=>(const SurfaceFace&) const = default;
};

/// The face table. Faces that are looked up have one entry each, those of runs one a run.
class ResidentFaces {
  public:
    /// By first use.
    uint32_t number(const SurfaceFace& face);
    void append(const SurfaceFace& face) { faces_.push_back(face); }
    bool contains(const SurfaceFace& face) const { return numbers_.contains(face); }
    uint32_t count() const { return static_cast<uint32_t>(faces_.size()); }
    /// Fields of `chart_bits`, then `code_bits`.
    std::vector<uint32_t> words(uint32_t chart_bits, uint32_t code_bits) const;

  private:
    std::vector<SurfaceFace> faces_;
    std::map<SurfaceFace, uint32_t> numbers_;
};

}  // namespace citystream::codec::mesh
