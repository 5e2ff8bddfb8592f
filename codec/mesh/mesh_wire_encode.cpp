#include <algorithm>
#include <cassert>
#include <utility>

#include "codec/bits/range_coder.h"
#include "codec/mesh/mesh_wire.h"
#include "codec/mesh/mesh_wire_header.h"
#include "codec/mesh/point_levels.h"
#include "codec/mesh/prism_code.h"
#include "codec/mesh/prism_colours.h"
#include "codec/mesh/prism_planes.h"
#include "codec/mesh/surface_writer.h"

namespace citystream::codec::mesh {

namespace {

GridMesh mesh_of(const MeshContent& content) {
    GridMesh mesh{content.points, {}};
    mesh.triangles.reserve(content.triangles.size());
    for (const MeshTriangle& t : content.triangles)
        mesh.triangles.push_back({t.corners[0].point, t.corners[1].point, t.corners[2].point});
    return mesh;
}

/// Directory entries of steps have to grow; a reader reads zeros past the end anyway.
std::vector<std::byte> bytes_of_step(bits::RangeEncoder& coder) {
    std::vector<std::byte> bytes = coder.finish();
    if (bytes.empty()) bytes.push_back(std::byte{0});
    return bytes;
}

class LayerWriter {
  public:
    LayerWriter(const MeshContent& content, KnownLattices* known)
        : content_(content),
          known_(known),
          mesh_(mesh_of(content)),
          welded_(mesh_),
          header_(header_of()),
          writer_(welded_, header_.box, header_.dropped[0]) {}
    MeshWire write() {
        write_first_step();
        for (size_t s = 1; s < header_.dropped.size(); ++s) write_step(s);
        const std::vector<std::span<const std::byte>> steps(result_.steps.begin(), result_.steps.end());
        auto content = decode_mesh_wire(steps, {~0u, ~0u});
        assert(content.ok());
        result_.content = std::move(*content);
        return std::move(result_);
    }

  private:
    MeshWireHeader header_of() const;
    void write_first_step();
    void write_step(size_t s);
    void write_prisms(bits::RangeEncoder& coder);
    void write_surface(bits::RangeEncoder& coder);
    void take_most_dropped();
    std::vector<MeshTriangle> walked_triangles() const;
    /// Of a point in the order of the walk, from the walk's lowest.
    GridPoint whole_point(uint32_t index) const;

    const MeshContent& content_;
    KnownLattices* known_;
    const GridMesh mesh_;
    const WeldedSurface welded_;
    const MeshWireHeader header_;
    SurfaceWriter writer_;
    PointLevels levels_;
    std::vector<GridPoint> whole_;
    std::vector<Prism> shapes_;  ///< as told, with all bits
    std::vector<HiddenLattice> lattices_;
    MeshWire result_;
};

MeshWireHeader LayerWriter::header_of() const {
    MeshWireHeader header;
    header.dropped = content_.dropped;
    header.normal_bits = content_.normal_bits;
    header.topology = content_.topology;
    header.has_prisms = !content_.prisms.empty();
    header.has_surface = !content_.triangles.empty();
    header.has_most_dropped = header.has_surface && !content_.most_dropped.empty();
    if (header.has_surface) header.box = box_of(welded_, header.dropped[0]);
    return header;
}

GridPoint LayerWriter::whole_point(uint32_t index) const {
    GridPoint point = welded_.points[writer_.points()[index]];
    for (size_t k = 0; k < 3; ++k) point[k] -= static_cast<int32_t>(int64_t{header_.box.low[k]} << header_.dropped[0]);
    return point;
}

void LayerWriter::write_first_step() {
    bits::RangeEncoder coder;
    MeshWireHeader header = header_;
    [[maybe_unused]] const bool written = code_header(coder, header);
    assert(written);
    result_.bits.header = coder.cost();
    if (header_.has_prisms) write_prisms(coder);
    if (header_.has_surface) write_surface(coder);
    result_.steps.push_back(bytes_of_step(coder));
}

void LayerWriter::write_prisms(bits::RangeEncoder& coder) {
    double before = coder.cost();
    std::vector<Prism> given;
    for (const MeshPrism& prism : content_.prisms) given.push_back(prism.shape);
    PrismTree tree;
    shapes_ = encode_prisms(coder, given, header_.dropped[0], &tree, known_);
    lattices_ = std::move(tree.lattices);
    result_.bits.prisms = coder.cost() - before;
    before = coder.cost();
    std::vector<MeshPrism> prisms;
    for (const uint32_t source : tree.source) prisms.push_back(content_.prisms[source]);
    [[maybe_unused]] const bool coloured = code_prism_colours(coder, tree, prisms);
    assert(coloured);
    result_.bits.prism_colours = coder.cost() - before;
}

/// In the order of the walk; of welded points the least counts.
void LayerWriter::take_most_dropped() {
    std::vector<uint8_t> of_welded(welded_.points.size(), kMeshGridBits);
    for (size_t i = 0; i < welded_.point_of.size(); ++i) {
        uint8_t& most = of_welded[welded_.point_of[i]];
        most = std::min(most, content_.most_dropped[i]);
    }
    for (const uint32_t point : writer_.points()) levels_.most_dropped.push_back(of_welded[point]);
    levels_.find_least();
}

/// In the order of the walk, turned as it turns them.
std::vector<MeshTriangle> LayerWriter::walked_triangles() const {
    std::vector<MeshTriangle> result;
    const auto& walked = writer_.walk().triangles();
    for (size_t i = 0; i < walked.size(); ++i) {
        MeshTriangle triangle = content_.triangles[writer_.triangles()[i]];
        const auto fits = [&] {
            for (size_t c = 0; c < 3; ++c) {
                if (welded_.point_of[triangle.corners[c].point] != writer_.points()[walked[i][c]]) return false;
            }
            return true;
        };
        for (int turn = 0; turn < 2 && !fits(); ++turn)
            std::rotate(triangle.corners.begin(), triangle.corners.begin() + 1, triangle.corners.end());
        for (size_t c = 0; c < 3; ++c) triangle.corners[c].point = walked[i][c];
        result.push_back(triangle);
    }
    return result;
}

void LayerWriter::write_surface(bits::RangeEncoder& coder) {
    double before = coder.cost();
    writer_.write(coder);
    const SurfaceWalk& walk = writer_.walk();
    MeshWireBits& bits = result_.bits;
    bits.positions = walk.position_bits();
    bits.topology = coder.cost() - before - bits.positions;
    for (uint32_t i = 0; i < walk.points().size(); ++i) whole_.push_back(whole_point(i));
    levels_.points = walk.points();
    make_room(levels_.points, header_.dropped[0]);
    if (header_.has_most_dropped) {
        before = coder.cost();
        take_most_dropped();
        code_most_dropped(coder, walk.origins(), levels_.most_dropped);
        bits.most_dropped = coder.cost() - before;
        levels_.code_first(coder, walk.origins(), header_.dropped[0], whole_);
        bits.positions += coder.cost() - before - bits.most_dropped;
    }
    bits.attributes =
        encode_attributes(coder, {levels_.points, walk.triangles()}, header_.normal_bits, walked_triangles());
}

void LayerWriter::write_step(size_t s) {
    bits::RangeEncoder coder;
    const uint32_t before = header_.dropped[s - 1], after = header_.dropped[s];
    if (header_.has_prisms) encode_prism_planes(coder, shapes_, lattices_, before - after, after);
    levels_.code_step(coder, writer_.walk().origins(), before, after, whole_);
    result_.bits.refinement += coder.cost();
    result_.steps.push_back(bytes_of_step(coder));
}

}  // namespace

MeshWire encode_mesh_wire(const MeshContent& content, KnownLattices* known) {
    assert(!content.dropped.empty() && content.dropped.size() <= kMostMeshSteps);
    assert(content.most_dropped.empty() || content.most_dropped.size() == content.points.size());
    return LayerWriter(content, known).write();
}

}  // namespace citystream::codec::mesh
