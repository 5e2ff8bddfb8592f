#include "codec/mesh/surface_reader.h"

#include <string>

namespace citystream::codec::mesh {

namespace {

Error damaged(const bits::RangeDecoder& decoder, const char* what) {
    return {std::string("mesh surface: ") + what, decoder.position()};
}

Status read_piece(bits::RangeDecoder& decoder, SurfaceWalk& walk) {
    if (!walk.code_start(decoder)) return damaged(decoder, "the first triangle of a piece is none");
    for (uint32_t gate = walk.gate(); gate != MeshBorder::kNone; gate = walk.gate()) {
        if (!walk.code_gate(decoder, gate)) return damaged(decoder, "there is no such triangle, or too many");
        if (!decoder.ok()) return damaged(decoder, "ends too early");
    }
    return Done{};
}

}  // namespace

Status read_surface(bits::RangeDecoder& decoder, SurfaceWalk& walk) {
    while (walk.code_more(decoder)) {
        Status piece = read_piece(decoder, walk);
        if (!piece) return piece;
    }
    while (walk.code_more(decoder)) {
        if (!walk.code_flat(decoder) || !decoder.ok())
            return damaged(decoder, "a flat triangle is none, or ends early");
    }
    return Done{};
}

}  // namespace citystream::codec::mesh
