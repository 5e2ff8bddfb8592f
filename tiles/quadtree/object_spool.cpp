#include "tiles/quadtree/object_spool.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace citystream::tiles::quadtree {
namespace {

constexpr double kGreatestMetres = 2147483648.0;
constexpr int64_t kGreatestSpan = int64_t{1}
                                  << 30;  // grid units: 1,048 km, what 32-bit offsets hold with room to spare
constexpr int64_t kGreatestCutCells = int64_t{1} << 22;  // ground over more cells than this is kept whole
constexpr size_t kGreatestPaints = 65535;

bool placeable(const city::Vec3& p) {
    return std::abs(p.x) < kGreatestMetres && std::abs(p.y) < kGreatestMetres && std::abs(p.z) < kGreatestMetres;
}

GridPoint on_grid(const city::Vec3& p) {
    return {to_grid(p.x), to_grid(p.y), to_grid(p.z)};
}

int64_t texcoord_units(double repeats) {
    return std::isfinite(repeats) ? std::llround(std::clamp(repeats, -1e9, 1e9) * kTexcoordUnits) : 0;
}

Paint paint_of(uint32_t material, const city::CityCatalog& catalog) {
    const city::Material& m = catalog.materials[material];
    return m.image < 0 ? Paint::flat(m.rgb) : Paint{PaintKind::kMaterial, material, 0};
}

bool add_triangles(const city::CityObject& object, const city::CityCatalog& catalog, BuildObject& out) {
    for (const city::Triangle& triangle : object.triangles) {
        if (triangle.material >= catalog.materials.size()) return false;
        BuildTriangle built;
        built.vertex = triangle.vertex;
        built.surface = triangle.surface;
        built.paint = out.paint_index(paint_of(triangle.material, catalog));
        if (built.paint >= kGreatestPaints) return false;
        for (size_t corner = 0; corner < 3; ++corner) {
            if (triangle.vertex[corner] >= object.vertices.size()) return false;
            built.texcoord[corner] = {texcoord_units(triangle.texcoord[corner].x),
                                      texcoord_units(triangle.texcoord[corner].y)};
        }
        const auto n = triangle_normal(out.vertices[built.vertex[0]], out.vertices[built.vertex[1]],
                                       out.vertices[built.vertex[2]]);
        if (n[0] != 0 || n[1] != 0 || n[2] != 0) out.triangles.push_back(built);
    }
    return true;
}

bool add_facades(const city::CityObject& object, const city::CityCatalog& catalog, BuildObject& out) {
    for (const city::FacadeWall& wall : object.facades) {
        const city::Vec3 far_corner{wall.lower_left.x + wall.along.x, wall.lower_left.y + wall.along.y,
                                    wall.lower_left.z + wall.height};
        if (!placeable(wall.lower_left) || !placeable(far_corner)) return false;
        if (wall.map >= catalog.facade_maps.size() || wall.palette >= catalog.palettes.size()) return false;
        const GridPoint a = on_grid(wall.lower_left), b = on_grid(far_corner);
        if (std::abs(b.x - a.x) > INT32_MAX || std::abs(b.y - a.y) > INT32_MAX || b.z - a.z > INT32_MAX) return false;
        if (b.z <= a.z || (a.x == b.x && a.y == b.y)) continue;  // thinner than the grid: nothing to see
        out.facades.push_back({a,
                               {static_cast<int32_t>(b.x - a.x), static_cast<int32_t>(b.y - a.y)},
                               static_cast<uint32_t>(b.z - a.z),
                               wall.map,
                               wall.palette});
    }
    return true;
}

/// A corner of a ground polygon while it is cut.
struct CutPoint {
    GridPoint position;
    std::array<int64_t, 2> texcoord{};
};
using CutPolygon = std::vector<CutPoint>;

int64_t coordinate(const GridPoint& p, int axis) {
    return axis == 0 ? p.x : p.y;
}

/// a + (b - a) * num / den, rounded half up; den > 0.
int64_t between(int64_t a, int64_t b, int64_t num, int64_t den) {
    const __int128 product = static_cast<__int128>(b - a) * num * 2 + den;
    const __int128 divisor = static_cast<__int128>(den) * 2;
    __int128 quotient = product / divisor;
    if (product % divisor < 0) --quotient;
    return a + static_cast<int64_t>(quotient);
}

/// Where edge pq crosses the line; the same for pq and qp, so that neighbours agree.
CutPoint crossing(const CutPoint& p, const CutPoint& q, int axis, int64_t line) {
    const bool swap = coordinate(p.position, axis) > coordinate(q.position, axis);
    const CutPoint& a = swap ? q : p;
    const CutPoint& b = swap ? p : q;
    const int64_t num = line - coordinate(a.position, axis),
                  den = coordinate(b.position, axis) - coordinate(a.position, axis);
    CutPoint cut;
    cut.position = {between(a.position.x, b.position.x, num, den), between(a.position.y, b.position.y, num, den),
                    between(a.position.z, b.position.z, num, den)};
    (axis == 0 ? cut.position.x : cut.position.y) = line;
    for (size_t k = 0; k < 2; ++k) cut.texcoord[k] = between(a.texcoord[k], b.texcoord[k], num, den);
    return cut;
}

/// The part of a convex polygon with coordinate >= line (keep_high) or <= line.
CutPolygon cut_half(const CutPolygon& polygon, int axis, int64_t line, bool keep_high) {
    CutPolygon out;
    const auto side = [&](const CutPoint& p) {
        const int64_t d = coordinate(p.position, axis) - line;
        return keep_high ? d : -d;
    };
    for (size_t i = 0; i < polygon.size(); ++i) {
        const CutPoint& p = polygon[i];
        const CutPoint& q = polygon[(i + 1) % polygon.size()];
        const int64_t sp = side(p), sq = side(q);
        if (sp >= 0) out.push_back(p);
        if ((sp > 0 && sq < 0) || (sp < 0 && sq > 0)) out.push_back(crossing(p, q, axis, line));
    }
    return out;
}

CutPolygon cut_band(const CutPolygon& polygon, int axis, int64_t low, int64_t high) {
    return cut_half(cut_half(polygon, axis, low, true), axis, high, false);
}

struct CellRange {
    int64_t first = 0, last = 0;
};

/// Cells that an interval touches with more than its ends.
CellRange cells_of(int64_t low, int64_t high) {
    const int64_t first = low >> kCellGridBits;
    const int64_t last = high > low ? (high - 1) >> kCellGridBits : first;
    return {first, std::max(first, last)};
}

uint32_t weld(BuildObject& object, const GridPoint& point) {
    // Ground pieces in one cell are small; looking back over the newest vertices finds nearly all repeats.
    const size_t look_back = std::min<size_t>(object.vertices.size(), 64);
    for (size_t i = 0; i < look_back; ++i) {
        const size_t at = object.vertices.size() - 1 - i;
        if (object.vertices[at] == point) return static_cast<uint32_t>(at);
    }
    object.vertices.push_back(point);
    return static_cast<uint32_t>(object.vertices.size() - 1);
}

void add_polygon(BuildObject& piece, const CutPolygon& polygon, const Paint& paint, city::SurfaceKind surface) {
    const uint32_t paint_index = piece.paint_index(paint);
    for (size_t i = 2; i < polygon.size(); ++i) {
        const std::array<const CutPoint*, 3> corners = {&polygon[0], &polygon[i - 1], &polygon[i]};
        const auto n = triangle_normal(corners[0]->position, corners[1]->position, corners[2]->position);
        if (n[0] == 0 && n[1] == 0 && n[2] == 0) continue;
        BuildTriangle triangle;
        triangle.paint = paint_index;
        triangle.surface = surface;
        for (size_t k = 0; k < 3; ++k) {
            triangle.vertex[k] = weld(piece, corners[k]->position);
            triangle.texcoord[k] = corners[k]->texcoord;
        }
        piece.triangles.push_back(triangle);
    }
}

}  // namespace

uint64_t morton(uint32_t x, uint32_t y) {
    const auto spread = [](uint64_t v) {
        v = (v | v << 16) & 0x0000ffff0000ffffULL;
        v = (v | v << 8) & 0x00ff00ff00ff00ffULL;
        v = (v | v << 4) & 0x0f0f0f0f0f0f0f0fULL;
        v = (v | v << 2) & 0x3333333333333333ULL;
        return (v | v << 1) & 0x5555555555555555ULL;
    };
    return spread(x) | spread(y) << 1;
}

std::vector<BuildObject> cut_at_cells(const BuildObject& object) {
    const GridBox box = object.box();
    const CellRange all_x = cells_of(box.lo.x, box.hi.x), all_y = cells_of(box.lo.y, box.hi.y);
    const auto columns = static_cast<size_t>(all_x.last - all_x.first + 1),
               rows = static_cast<size_t>(all_y.last - all_y.first + 1);
    std::vector<BuildObject> pieces(columns * rows);
    for (const BuildTriangle& triangle : object.triangles) {
        CutPolygon whole(3);
        GridBox bounds;
        for (size_t k = 0; k < 3; ++k) {
            whole[k] = {object.vertices[triangle.vertex[k]], triangle.texcoord[k]};
            bounds.add(whole[k].position);
        }
        const CellRange xs = cells_of(bounds.lo.x, bounds.hi.x), ys = cells_of(bounds.lo.y, bounds.hi.y);
        for (int64_t x = xs.first; x <= xs.last; ++x) {
            const CutPolygon column =
                xs.first == xs.last ? whole : cut_band(whole, 0, x << kCellGridBits, (x + 1) << kCellGridBits);
            for (int64_t y = ys.first; y <= ys.last; ++y) {
                const CutPolygon part =
                    ys.first == ys.last ? column : cut_band(column, 1, y << kCellGridBits, (y + 1) << kCellGridBits);
                BuildObject& piece =
                    pieces[static_cast<size_t>(y - all_y.first) * columns + static_cast<size_t>(x - all_x.first)];
                piece.kind = object.kind;
                add_polygon(piece, part, object.paints[triangle.paint], triangle.surface);
            }
        }
    }
    std::erase_if(pieces, [](const BuildObject& piece) { return piece.triangles.empty(); });
    return pieces;
}

Result<std::unique_ptr<ObjectSpool>> ObjectSpool::create(const std::string& folder) {
    auto file = SpoolFile::create((std::filesystem::path(folder) / "objects").string());
    if (!file) return file.error();
    return std::unique_ptr<ObjectSpool>(new ObjectSpool(std::move(file).value()));
}

Status ObjectSpool::add(const city::CityObject& object, const city::CityCatalog& catalog, city::CityReport& report) {
    const auto refuse = [&](const char* why) {
        report.add({object.id, why, "object", true});
        return Done{};
    };
    BuildObject built;
    built.kind = object.kind;
    built.vertices.reserve(object.vertices.size());
    for (const city::Vec3& vertex : object.vertices) {
        if (!placeable(vertex)) return refuse("a coordinate is no number or out of range; object left out");
        built.vertices.push_back(on_grid(vertex));
    }
    if (!add_triangles(object, catalog, built) || !add_facades(object, catalog, built)) {
        return refuse("an index or a size is out of range; object left out");
    }
    if (built.triangles.empty() && built.facades.empty()) {
        return refuse("nothing left of it on the 1 mm grid; object left out");
    }
    const GridBox box = built.box();
    if (box.hi.x - box.lo.x > kGreatestSpan || box.hi.y - box.lo.y > kGreatestSpan ||
        box.hi.z - box.lo.z > kGreatestSpan) {
        return refuse("wider than 1000 km; object left out");
    }
    extent_.add(box);
    facades_ += built.facades.size();
    has_ground_ = has_ground_ || built.ground();
    return built.ground() && built.facades.empty() ? store_cut(built, box) : store(built, box);
}

Status ObjectSpool::store_cut(const BuildObject& object, const GridBox& box) {
    const CellRange xs = cells_of(box.lo.x, box.hi.x), ys = cells_of(box.lo.y, box.hi.y);
    const int64_t cells = (xs.last - xs.first + 1) * (ys.last - ys.first + 1);
    if (cells == 1 || cells > kGreatestCutCells) return store(object, box);
    for (const BuildObject& piece : cut_at_cells(object)) {
        if (Status status = store(piece, piece.box()); !status) return status;
    }
    return Done{};
}

Status ObjectSpool::store(const BuildObject& object, const GridBox& box) {
    scratch_.clear();
    serialise(object, scratch_);
    if (scratch_.size() > UINT32_MAX) return Error{"an object is larger than 4 GiB"};
    auto range = file_->append(scratch_);
    if (!range) return range.error();
    SpooledObject entry;
    entry.cell_x = static_cast<int32_t>((box.lo.x + (box.hi.x - box.lo.x) / 2) >> kCellGridBits);
    entry.cell_y = static_cast<int32_t>((box.lo.y + (box.hi.y - box.lo.y) / 2) >> kCellGridBits);
    entry.offset = range->offset;
    entry.size = static_cast<uint32_t>(range->size);
    entry.weight = static_cast<uint32_t>(object.triangles.size() + 2 * object.facades.size());
    index_.push_back(entry);
    return Done{};
}

void ObjectSpool::sort(const GridPoint& origin, int64_t root_cells) {
    const int64_t x0 = origin.x >> kCellGridBits, y0 = origin.y >> kCellGridBits;
    for (SpooledObject& object : index_) {
        object.cell_x = static_cast<int32_t>(std::clamp<int64_t>(object.cell_x, x0, x0 + root_cells - 1));
        object.cell_y = static_cast<int32_t>(std::clamp<int64_t>(object.cell_y, y0, y0 + root_cells - 1));
    }
    const auto key = [&](const SpooledObject& object) {
        return morton(static_cast<uint32_t>(object.cell_x - x0), static_cast<uint32_t>(object.cell_y - y0));
    };
    std::sort(index_.begin(), index_.end(), [&](const SpooledObject& a, const SpooledObject& b) {
        const uint64_t ka = key(a), kb = key(b);
        return ka != kb ? ka < kb : a.offset < b.offset;
    });
}

Result<std::vector<BuildObject>> ObjectSpool::load(size_t begin, size_t end) {
    std::vector<std::byte> bytes;
    for (size_t i = begin; i < end; ++i) {
        SpoolRange range{index_[i].offset, index_[i].size};
        while (i + 1 < end && index_[i + 1].offset == range.offset + range.size) range.size += index_[++i].size;
        if (Status status = file_->read(range, bytes); !status) return status.error();
    }
    return deserialise_all(bytes);
}

}  // namespace citystream::tiles::quadtree
