#include "codec/mesh/mesh_wire.h"

#include <cassert>
#include <cstdlib>
#include <string>
#include <utility>

#include "codec/bits/range_coder.h"
#include "codec/mesh/mesh_wire_header.h"
#include "codec/mesh/point_levels.h"
#include "codec/mesh/prism_code.h"
#include "codec/mesh/prism_colours.h"
#include "codec/mesh/prism_planes.h"
#include "codec/mesh/surface_reader.h"

namespace citystream::codec::mesh {

namespace {

Error damaged(const bits::RangeDecoder& decoder, const char* what) {
    return {std::string("mesh layer: ") + what, decoder.position()};
}

bool is_on_grid(const Prism& prism, uint32_t dropped) {
    const int32_t limit = (1 << 30) >> dropped;
    const auto is_inside = [=](int32_t value) { return std::abs(value) < limit; };
    if (!is_inside(prism.base) || !is_inside(prism.top)) return false;
    for (const PrismWall& wall : prism.walls) {
        if (!is_inside(wall.base)) return false;
    }
    for (const Ring& ring : prism.rings) {
        for (const auto& point : ring.points) {
            if (!is_inside(point[0]) || !is_inside(point[1])) return false;
        }
    }
    return true;
}

class LayerReader {
  public:
    explicit LayerReader(const MeshLimits& limits) : left_(limits) {}
    Result<MeshContent> read(std::span<const std::span<const std::byte>> steps);

  private:
    Status read_first_step(std::span<const std::byte> bytes);
    Status read_step(std::span<const std::byte> bytes, size_t s);
    Status read_prisms(bits::RangeDecoder& decoder);
    Status read_surface(bits::RangeDecoder& decoder);
    Status finish_prisms(uint32_t dropped);

    MeshLimits left_;
    MeshWireHeader header_;
    std::vector<Prism> shapes_;
    PointLevels levels_;
    std::vector<Origin> origins_;
    MeshContent content_;
};

Status LayerReader::read_prisms(bits::RangeDecoder& decoder) {
    PrismTree tree;
    auto shapes = decode_prisms_within(decoder, left_.points, left_.triangles, &tree);
    if (!shapes) return shapes.error();
    shapes_ = std::move(*shapes);
    content_.prisms.resize(shapes_.size());
    for (size_t i = 0; i < shapes_.size(); ++i) content_.prisms[i].shape.has_floor = shapes_[i].has_floor;
    if (!code_prism_colours(decoder, tree, content_.prisms)) return damaged(decoder, "a prism has no colour");
    return Done{};
}

Status LayerReader::read_surface(bits::RangeDecoder& decoder) {
    SurfaceWalk walk(header_.box.frame(left_.points, left_.triangles));
    Status read = mesh::read_surface(decoder, walk);
    if (!read) return read;
    levels_.points = walk.points();
    origins_ = walk.origins();
    make_room(levels_.points, header_.dropped[0]);
    if (header_.has_most_dropped) {
        levels_.most_dropped.resize(levels_.points.size());
        code_most_dropped(decoder, origins_, levels_.most_dropped);
        levels_.find_least();
        levels_.code_first(decoder, origins_, header_.dropped[0]);
    }
    if (!decoder.ok()) return damaged(decoder, "ends too early");
    content_.triangles = decode_attributes(decoder, {levels_.points, walk.triangles()}, header_.normal_bits);
    return Done{};
}

Status LayerReader::read_first_step(std::span<const std::byte> bytes) {
    bits::RangeDecoder decoder(bytes);
    if (!code_header(decoder, header_) || !decoder.ok()) return damaged(decoder, "no header of a known version");
    if (header_.has_prisms) {
        Status read = read_prisms(decoder);
        if (!read) return read;
    }
    if (header_.has_surface) {
        Status read = read_surface(decoder);
        if (!read) return read;
    }
    return decoder.finish();
}

Status LayerReader::read_step(std::span<const std::byte> bytes, size_t s) {
    bits::RangeDecoder decoder(bytes);
    const uint32_t before = header_.dropped[s - 1], after = header_.dropped[s];
    if (header_.has_prisms) {
        Status planes = decode_prism_planes(decoder, shapes_, before - after);
        if (!planes) return planes;
    }
    levels_.code_step(decoder, origins_, before, after);
    return decoder.finish();
}

Status LayerReader::finish_prisms(uint32_t dropped) {
    for (size_t i = 0; i < shapes_.size(); ++i) {
        if (!is_on_grid(shapes_[i], dropped)) return Error{"mesh layer: a prism lies outside the grid"};
        content_.prisms[i].shape = with_low_bits(std::move(shapes_[i]), dropped);
    }
    return Done{};
}

Result<MeshContent> LayerReader::read(std::span<const std::span<const std::byte>> steps) {
    Status read = read_first_step(steps[0]);
    if (!read) return read.error();
    if (steps.size() > header_.dropped.size()) return Error{"mesh layer: more steps than the first one announces"};
    for (size_t s = 1; s < steps.size(); ++s) {
        read = read_step(steps[s], s);
        if (!read) return read.error();
    }
    const Status finished = finish_prisms(header_.dropped[steps.size() - 1]);
    if (!finished) return finished.error();
    content_.points = levels_.absolute_points(header_.box.low, header_.dropped[0]);
    content_.most_dropped = std::move(levels_.most_dropped);
    content_.dropped = header_.dropped;
    content_.normal_bits = header_.normal_bits;
    content_.topology = header_.topology;
    return std::move(content_);
}

}  // namespace

Result<MeshContent> decode_mesh_wire(std::span<const std::span<const std::byte>> steps, const MeshLimits& limits) {
    assert(!steps.empty());
    return LayerReader(limits).read(steps);
}

}  // namespace citystream::codec::mesh
