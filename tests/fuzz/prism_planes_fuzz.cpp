// Any bytes as the lower bits of some prisms: the bits known before stay, and what is read can be written.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "codec/mesh/prism_planes.h"

namespace {

namespace bits = citystream::codec::bits;
namespace mesh = citystream::codec::mesh;
using mesh::WallKind;

std::vector<mesh::Prism> known_prisms() {
    mesh::Prism house;
    house.rings = {{{{0, 0}, {100, 3}, {98, 60}, {-2, 57}}}, {{{20, 20}, {20, 30}, {40, 30}}}};
    house.base = -5;
    house.top = 40;
    house.walls.assign(7, {WallKind::kRising, -5});
    house.walls[2] = {WallKind::kFalling, 12};
    house.walls[5] = {WallKind::kOpen, -5};
    mesh::Prism end = house;
    end.rings = {{{{(1 << 30) - 1, 0}, {(1 << 30) - 1, 9}, {5, 5}}}};
    end.walls.resize(3);
    return {house, house, end};
}

bool same(const mesh::Prism& a, const mesh::Prism& b) {
    if (a.base != b.base || a.top != b.top || a.walls != b.walls || a.rings.size() != b.rings.size()) return false;
    for (size_t r = 0; r < a.rings.size(); ++r) {
        if (a.rings[r].points != b.rings[r].points) return false;
    }
    return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    if (size == 0) return 0;
    const uint32_t count = 1 + data[0] % 8;
    auto prisms = known_prisms();
    const size_t end_of_grid = prisms.size() - 1;
    // Coordinates at the end of the grid have no room for more bits.
    if (data[0] < 128) prisms.resize(end_of_grid);
    const auto coarse = prisms;
    bits::RangeDecoder decoder(std::as_bytes(std::span(data, size).subspan(1)));
    if (!mesh::decode_prism_planes(decoder, prisms, count)) return 0;
    bits::RangeEncoder encoder;
    for (size_t i = 0; i < prisms.size(); ++i) {
        const mesh::Prism shifted = mesh::without_low_bits(prisms[i], count);
        if (shifted.base != coarse[i].base) std::abort();
        for (size_t r = 0; r < shifted.rings.size(); ++r) {
            if (shifted.rings[r].points != coarse[i].rings[r].points) std::abort();
        }
        // A damaged top or wall may have been brought back into order; then there is nothing to write.
        if (!same(shifted, coarse[i])) return 0;
    }
    mesh::encode_prism_planes(encoder, prisms, {}, count, 0);
    const auto bytes = encoder.finish();
    bits::RangeDecoder again(bytes);
    auto read = coarse;
    if (!mesh::decode_prism_planes(again, read, count) || !again.finish().ok()) std::abort();
    for (size_t i = 0; i < read.size(); ++i) {
        if (!same(read[i], prisms[i])) std::abort();
    }
    return 0;
}
