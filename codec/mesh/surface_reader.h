// Reads the triangles that a SurfaceWriter (surface_writer.h) has written.
#pragma once

#include "codec/bits/range_coder.h"
#include "codec/mesh/surface_walk.h"
#include "codec/result.h"

namespace citystream::codec::mesh {

/// All pieces and flat triangles. Error: a triangle is none, there are more than the walk's frame has room for, or the
/// bytes have run out.
Status read_surface(bits::RangeDecoder& decoder, SurfaceWalk& walk);

}  // namespace citystream::codec::mesh
