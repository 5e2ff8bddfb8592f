// Any bytes as range coded prisms: what is read can be written, and is read again as the same prisms.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <utility>

#include "codec/mesh/prism_code.h"
#include "codec/mesh/ring_triangles.h"

namespace {

namespace bits = citystream::codec::bits;
namespace mesh = citystream::codec::mesh;

constexpr mesh::PrismLimits kLimits{4096};

/// Whether the encoder may be given it: a decoder's triangles need not meet all rings.
bool complete(const mesh::Prism& prism) {
    auto floor = prism.floor_triangles;
    for (auto& t : floor) std::swap(t[1], t[2]);
    return mesh::is_ring_triangulation(prism.rings, prism.top_triangles) &&
           (!prism.has_floor || mesh::is_ring_triangulation(prism.rings, floor));
}

void check(const mesh::Prism& prism) {
    size_t points = 0;
    for (const mesh::Ring& ring : prism.rings) {
        if (ring.points.size() < 3) std::abort();
        points += ring.points.size();
    }
    if (prism.rings.empty() || prism.walls.size() != points || prism.base > prism.top) std::abort();
    for (const auto* triangles : {&prism.top_triangles, &prism.floor_triangles}) {
        for (const auto& t : *triangles) {
            for (const uint32_t corner : t) {
                if (corner >= points) std::abort();
            }
        }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    bits::RangeDecoder decoder(std::as_bytes(std::span(data, size)));
    auto prisms = mesh::decode_prisms(decoder, kLimits);
    if (!prisms) return 0;
    for (const mesh::Prism& prism : *prisms) {
        check(prism);
        if (!complete(prism)) return 0;
    }
    bits::RangeEncoder encoder;
    const auto told = mesh::encode_prisms(encoder, *prisms);
    const auto bytes = encoder.finish();
    bits::RangeDecoder again(bytes);
    const auto same = mesh::decode_prisms(again, kLimits);
    if (!same || !again.finish().ok() || same->size() != told.size()) std::abort();
    for (size_t i = 0; i < told.size(); ++i) {
        const mesh::Prism &a = told[i], &b = (*same)[i];
        if (a.base != b.base || a.top != b.top || a.walls != b.walls || a.rings.size() != b.rings.size()) std::abort();
        for (size_t r = 0; r < a.rings.size(); ++r) {
            if (a.rings[r].points != b.rings[r].points) std::abort();
        }
    }
    return 0;
}
