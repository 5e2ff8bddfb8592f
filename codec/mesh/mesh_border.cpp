#include "codec/mesh/mesh_border.h"

namespace citystream::codec::mesh {

uint32_t MeshBorder::add_vertex() {
    vertices_.emplace_back();
    return vertex_count() - 1;
}

uint32_t MeshBorder::add_gate(uint32_t from, uint32_t to, uint32_t opposite) {
    const auto index = static_cast<uint32_t>(gates_.size());
    const uint32_t older = vertices_[from].newest;
    gates_.push_back({from, to, opposite, index, index, older, kNone, GateState::kWaiting});
    if (older != kNone) gates_[older].newer = index;
    vertices_[from].newest = index;
    return index;
}

void MeshBorder::link(uint32_t first, uint32_t second) {
    gates_[first].next = second;
    gates_[second].previous = first;
}

void MeshBorder::forget(uint32_t index) {
    Gate& gate = gates_[index];
    if (gate.older != kNone) gates_[gate.older].newer = gate.newer;
    if (gate.newer != kNone)
        gates_[gate.newer].older = gate.older;
    else
        vertices_[gate.from].newest = gate.older;
    gate.state = GateState::kJoined;
}

uint32_t MeshBorder::waiting_gate(uint32_t from, uint32_t to) const {
    uint32_t index = vertices_[from].newest;
    for (uint32_t seen = 0; index != kNone && seen < kMostOutgoing; ++seen, index = gates_[index].older) {
        if (gates_[index].to == to && gates_[index].state == GateState::kWaiting) return index;
    }
    return kNone;
}

/// The gate that leaves `apex` where the region meets the new triangle: on this loop at its ends if it is there, else
/// the newest.
uint32_t MeshBorder::gate_in_loop_from(uint32_t index, uint32_t apex) const {
    const Gate& gate = gates_[index];
    if (gates_[gate.next].to == apex) return gates_[gate.next].next;
    if (gates_[gate.previous].from == apex) return gate.previous;
    return vertices_[apex].newest;
}

void MeshBorder::join_with_opposite(uint32_t index) {
    const uint32_t other = waiting_gate(gates_[index].to, gates_[index].from);
    if (other == kNone) return;
    const uint32_t before = gates_[index].previous, after = gates_[other].next;
    const uint32_t before_other = gates_[other].previous, after_this = gates_[index].next;
    link(before, after);
    link(before_other, after_this);
    forget(index);
    forget(other);
}

void MeshBorder::start(const std::array<uint32_t, 3>& t) {
    std::array<uint32_t, 3> gates{};
    for (size_t i = 0; i < 3; ++i) {
        gates[i] = add_gate(t[i], t[(i + 1) % 3], t[(i + 2) % 3]);
        ++vertices_[t[i]].triangles;
    }
    for (size_t i = 0; i < 3; ++i) link(gates[i], gates[(i + 1) % 3]);
    for (size_t i = 0; i < 3; ++i) {
        stack_.push_back(gates[i]);
        join_with_opposite(gates[i]);
    }
}

uint32_t MeshBorder::next_gate() {
    while (!stack_.empty()) {
        if (gates_[stack_.back()].state == GateState::kWaiting) return stack_.back();
        stack_.pop_back();
    }
    return kNone;
}

void MeshBorder::attach(uint32_t index, uint32_t apex) {
    const Gate gate = gates_[index];
    const uint32_t met = gate_in_loop_from(index, apex);
    const uint32_t left = add_gate(gate.from, apex, gate.to), right = add_gate(apex, gate.to, gate.from);
    link(left, right);
    if (gate.next == index) {
        link(right, left);
    } else {
        link(gate.previous, left);
        link(right, gate.next);
    }
    forget(index);
    if (met != kNone) {
        const uint32_t before = gates_[met].previous;
        link(before, right);
        link(left, met);
    }
    for (const uint32_t v : {gate.from, gate.to, apex}) ++vertices_[v].triangles;
    stack_.push_back(left);
    stack_.push_back(right);
    join_with_opposite(left);
    join_with_opposite(right);
}

}  // namespace citystream::codec::mesh
