// The border of a mesh that is coded triangle by triangle: which edges still wait for the triangle beyond them.
//
// Writer and reader grow the same region. Each of its triangles stands counter-clockwise; an edge of one that has no
// neighbour yet is a gate from -> to, and gates follow each other in loops around what is open. A triangle attached at
// gate a -> b is (b, a, apex): the gate goes, a -> apex and apex -> b come. Wherever the region has a waiting gate that
// runs against a new one, both close. Nothing is assumed of the mesh: an edge of many faces only means that some of its
// gates are never joined, which costs bits and no triangle.
//
// Loops say which vertex is a likely apex (the one before, the one after); where three or more sheets meet they may be
// linked otherwise than a person would, alike on both sides. All calls take time O(1): where more than kMostOutgoing
// gates leave a vertex, the older ones are not looked at.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace citystream::codec::mesh {

class MeshBorder {
  public:
    static constexpr uint32_t kNone = ~uint32_t{0};
    static constexpr uint32_t kMostOutgoing = 64;

    enum class GateState : uint8_t { kWaiting, kEdgeOfMesh, kJoined };
    struct Gate {
        uint32_t from = 0, to = 0;
        uint32_t opposite = 0;  ///< third vertex of the triangle that it belongs to
        uint32_t previous = 0, next = 0;
        uint32_t older = kNone, newer = kNone;  ///< among those that leave `from`
        GateState state = GateState::kWaiting;
    };
    struct Vertex {
        uint32_t newest = kNone;  ///< gate that leaves it
        uint32_t triangles = 0;
    };

    uint32_t add_vertex();
    uint32_t vertex_count() const { return static_cast<uint32_t>(vertices_.size()); }
    const Vertex& vertex(uint32_t index) const { return vertices_[index]; }
    /// No gate leaves it: all its triangles may be known.
    bool enclosed(uint32_t vertex) const { return vertices_[vertex].newest == kNone; }
    const Gate& gate(uint32_t index) const { return gates_[index]; }

    /// The first triangle of a piece, of three different vertices.
    void start(const std::array<uint32_t, 3>& triangle);
    /// The waiting gate to go on with; kNone when none waits.
    uint32_t next_gate();
    /// Adds the triangle (to, from, apex) at a waiting gate; apex differs from both.
    void attach(uint32_t gate, uint32_t apex);
    /// Nothing comes beyond this gate.
    void leave(uint32_t gate) { gates_[gate].state = GateState::kEdgeOfMesh; }

  private:
    uint32_t add_gate(uint32_t from, uint32_t to, uint32_t opposite);
    void link(uint32_t first, uint32_t second);
    uint32_t gate_in_loop_from(uint32_t gate, uint32_t apex) const;
    uint32_t waiting_gate(uint32_t from, uint32_t to) const;
    void forget(uint32_t gate);
    void join_with_opposite(uint32_t gate);

    std::vector<Vertex> vertices_;
    std::vector<Gate> gates_;
    std::vector<uint32_t> stack_;
};

}  // namespace citystream::codec::mesh
