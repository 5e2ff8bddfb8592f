#include "tiles/quadtree/build_object.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

namespace citystream::tiles::quadtree {
namespace {

template <typename T>
void put(std::vector<std::byte>& out, const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const size_t at = out.size();
    out.resize(at + sizeof(T));
    std::memcpy(out.data() + at, &value, sizeof(T));
}

/// Takes values off the front of the bytes; remembers when there were too few.
class Reader {
  public:
    explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}
    template <typename T>
    T take() {
        static_assert(std::is_trivially_copyable_v<T>);
        T value{};
        if (bytes_.size() < sizeof(T)) {
            failed_ = true;
            return value;
        }
        std::memcpy(&value, bytes_.data(), sizeof(T));
        bytes_ = bytes_.subspan(sizeof(T));
        return value;
    }
    /// A count of items that take at least `least` bytes each.
    uint32_t take_count(size_t least) {
        const auto count = take<uint32_t>();
        if (count * least > bytes_.size()) failed_ = true;
        return failed_ ? 0 : count;
    }
    bool failed() const { return failed_; }
    bool empty() const { return bytes_.empty(); }

  private:
    std::span<const std::byte> bytes_;
    bool failed_ = false;
};

bool has_texcoords(const Paint& paint) {
    return paint.kind != PaintKind::kFlat;
}

/// Smallest texture coordinate of the textured triangles, in whole repeats, so that the rest fits 32 bits.
std::array<int64_t, 2> texcoord_anchor(const BuildObject& object) {
    std::array<int64_t, 2> anchor = {INT64_MAX, INT64_MAX};
    for (const BuildTriangle& triangle : object.triangles) {
        if (!has_texcoords(object.paints[triangle.paint])) continue;
        for (const auto& texcoord : triangle.texcoord) {
            for (size_t axis = 0; axis < 2; ++axis) anchor[axis] = std::min(anchor[axis], texcoord[axis]);
        }
    }
    for (int64_t& axis : anchor) axis = axis == INT64_MAX ? 0 : (axis >> 16) << 16;
    return anchor;
}

int32_t clamped(int64_t value) {
    return static_cast<int32_t>(std::clamp<int64_t>(value, INT32_MIN, INT32_MAX));
}

void serialise_triangle(const BuildObject& object, const BuildTriangle& triangle, const std::array<int64_t, 2>& anchor,
                        std::vector<std::byte>& out) {
    put(out, triangle.vertex);
    put(out, static_cast<uint16_t>(triangle.paint));
    put(out, static_cast<uint8_t>(triangle.surface));
    if (!has_texcoords(object.paints[triangle.paint])) return;
    for (const auto& texcoord : triangle.texcoord) {
        put(out, clamped(texcoord[0] - anchor[0]));
        put(out, clamped(texcoord[1] - anchor[1]));
    }
}

bool read_triangle(Reader& reader, const BuildObject& object, const std::array<int64_t, 2>& anchor,
                   BuildTriangle& triangle) {
    triangle.vertex = reader.take<std::array<uint32_t, 3>>();
    triangle.paint = reader.take<uint16_t>();
    triangle.surface = static_cast<city::SurfaceKind>(reader.take<uint8_t>());
    if (reader.failed() || triangle.paint >= object.paints.size()) return false;
    for (uint32_t vertex : triangle.vertex) {
        if (vertex >= object.vertices.size()) return false;
    }
    if (!has_texcoords(object.paints[triangle.paint])) return true;
    for (auto& texcoord : triangle.texcoord) {
        texcoord[0] = anchor[0] + reader.take<int32_t>();
        texcoord[1] = anchor[1] + reader.take<int32_t>();
    }
    return !reader.failed();
}

bool read_object(Reader& reader, BuildObject& object) {
    object.kind = static_cast<city::ObjectKind>(reader.take<uint8_t>());
    object.block = reader.take<uint8_t>() != 0;
    object.error = reader.take<float>();
    const auto base = reader.take<GridPoint>();
    const auto anchor = reader.take<std::array<int64_t, 2>>();
    object.vertices.resize(reader.take_count(12));
    for (GridPoint& vertex : object.vertices) {
        const auto offset = reader.take<std::array<int32_t, 3>>();
        vertex = {base.x + offset[0], base.y + offset[1], base.z + offset[2]};
    }
    object.paints.resize(reader.take_count(sizeof(Paint)));
    for (Paint& paint : object.paints) paint = reader.take<Paint>();
    object.triangles.resize(reader.take_count(15));
    for (BuildTriangle& triangle : object.triangles) {
        if (!read_triangle(reader, object, anchor, triangle)) return false;
    }
    object.facades.resize(reader.take_count(sizeof(BuildFacade)));
    for (BuildFacade& facade : object.facades) facade = reader.take<BuildFacade>();
    return !reader.failed();
}

}  // namespace

std::array<GridPoint, 4> BuildFacade::corners() const {
    const GridPoint right{origin.x + along[0], origin.y + along[1], origin.z};
    const int64_t top = origin.z + height;
    return {origin, right, GridPoint{right.x, right.y, top}, GridPoint{origin.x, origin.y, top}};
}

void GridBox::add(const GridPoint& point) {
    lo = {std::min(lo.x, point.x), std::min(lo.y, point.y), std::min(lo.z, point.z)};
    hi = {std::max(hi.x, point.x), std::max(hi.y, point.y), std::max(hi.z, point.z)};
}

void GridBox::add(const GridBox& box) {
    if (box.empty()) return;
    add(box.lo);
    add(box.hi);
}

GridBox BuildObject::box() const {
    GridBox box;
    for (const GridPoint& vertex : vertices) box.add(vertex);
    for (const BuildFacade& facade : facades) {
        for (const GridPoint& corner : facade.corners()) box.add(corner);
    }
    return box;
}

uint32_t BuildObject::paint_index(const Paint& paint) {
    const auto found = std::find(paints.begin(), paints.end(), paint);
    if (found != paints.end()) return static_cast<uint32_t>(found - paints.begin());
    paints.push_back(paint);
    return static_cast<uint32_t>(paints.size() - 1);
}

bool BuildObject::ground() const {
    return kind == city::ObjectKind::kTerrain || kind == city::ObjectKind::kLandUse ||
           kind == city::ObjectKind::kRoad || kind == city::ObjectKind::kWater;
}

std::array<double, 3> triangle_normal(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
    const auto ux = static_cast<double>(b.x - a.x), uy = static_cast<double>(b.y - a.y),
               uz = static_cast<double>(b.z - a.z);
    const auto vx = static_cast<double>(c.x - a.x), vy = static_cast<double>(c.y - a.y),
               vz = static_cast<double>(c.z - a.z);
    return {uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx};
}

void serialise(const BuildObject& object, std::vector<std::byte>& out) {
    GridPoint base;
    if (!object.vertices.empty()) {
        base = object.box().lo;
    }
    const std::array<int64_t, 2> anchor = texcoord_anchor(object);
    put(out, static_cast<uint8_t>(object.kind));
    put(out, static_cast<uint8_t>(object.block));
    put(out, object.error);
    put(out, base);
    put(out, anchor);
    put(out, static_cast<uint32_t>(object.vertices.size()));
    for (const GridPoint& vertex : object.vertices) {
        put(out,
            std::array<int32_t, 3>{clamped(vertex.x - base.x), clamped(vertex.y - base.y), clamped(vertex.z - base.z)});
    }
    put(out, static_cast<uint32_t>(object.paints.size()));
    for (const Paint& paint : object.paints) put(out, paint);
    put(out, static_cast<uint32_t>(object.triangles.size()));
    for (const BuildTriangle& triangle : object.triangles) serialise_triangle(object, triangle, anchor, out);
    put(out, static_cast<uint32_t>(object.facades.size()));
    for (const BuildFacade& facade : object.facades) put(out, facade);
}

Result<std::vector<BuildObject>> deserialise_all(std::span<const std::byte> bytes) {
    Reader reader(bytes);
    std::vector<BuildObject> objects;
    while (!reader.empty()) {
        BuildObject object;
        if (!read_object(reader, object)) return Error{"temporary object file is damaged"};
        objects.push_back(std::move(object));
    }
    return objects;
}

}  // namespace citystream::tiles::quadtree
