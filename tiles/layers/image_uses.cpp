#include "tiles/layers/image_uses.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include "tiles/layers/facade_picture.h"

namespace citystream::tiles::layers {
namespace {

using codec::atlas::ChartSize;
using codec::atlas::Coverage;
using codec::atlas::CoverageVertex;
using quadtree::BuildObject;
using quadtree::BuildTriangle;

constexpr size_t kObjectsPerPart = 4096;
constexpr uint32_t kGreatestSide = 8192;

void add(ImageUse& use, const ImageUse& other) {
    add_coverage(use.coverage, other.coverage);
    use.clamped = use.clamped || other.clamped;
    for (size_t axis = 0; axis < 2; ++axis) {
        use.lowest[axis] = std::min(use.lowest[axis], other.lowest[axis]);
        use.highest[axis] = std::max(use.highest[axis], other.highest[axis]);
    }
}

/// What a part of the objects shows. Parts do not depend on the threads, and are added up in their order.
struct PartUses {
    std::map<uint32_t, ImageUse> images;
    std::set<std::pair<uint32_t, uint32_t>> facades;  // map, palette
};

void note_triangle(const BuildObject& object, const BuildTriangle& triangle, ImageUse& use) {
    std::array<CoverageVertex, 3> corners;
    const GridPoint& first = object.vertices[triangle.vertex[0]];
    for (size_t k = 0; k < 3; ++k) {
        const GridPoint& at = object.vertices[triangle.vertex[k]];
        corners[k].position = {to_metres(at.x - first.x), to_metres(at.y - first.y), to_metres(at.z - first.z)};
        for (size_t axis = 0; axis < 2; ++axis) {
            const double t = static_cast<double>(triangle.texcoord[k][axis]) / quadtree::kTexcoordUnits;
            corners[k].texture[axis] = t;
            use.lowest[axis] = std::min(use.lowest[axis], t);
            use.highest[axis] = std::max(use.highest[axis], t);
        }
    }
    add_polygon(use.coverage, corners);
}

PartUses uses_of(const std::vector<BuildObject>& objects, const city::CityCatalog& catalog) {
    PartUses found;
    for (const BuildObject& object : objects) {
        for (const BuildTriangle& triangle : object.triangles) {
            const quadtree::Paint& paint = object.paints[triangle.paint];
            if (paint.kind != quadtree::PaintKind::kMaterial) continue;
            const city::Material& material = catalog.materials[paint.a];
            ImageUse& use = found.images[static_cast<uint32_t>(material.image)];
            use.clamped = use.clamped || !material.repeat;
            note_triangle(object, triangle, use);
        }
        for (const quadtree::BuildFacade& facade : object.facades) found.facades.emplace(facade.map, facade.palette);
    }
    return found;
}

/// Reads the parts on many threads.
Result<std::vector<PartUses>> read_parts(quadtree::ObjectSpool& objects, const city::CityCatalog& catalog,
                                         uint32_t jobs) {
    const size_t count = objects.index().size();
    std::vector<PartUses> parts((count + kObjectsPerPart - 1) / kObjectsPerPart);
    std::atomic<size_t> next = 0;
    std::mutex mutex;
    std::optional<Error> failed;
    const auto work = [&] {
        for (size_t i = next++; i < parts.size(); i = next++) {
            const auto read = objects.load(i * kObjectsPerPart, std::min(count, (i + 1) * kObjectsPerPart));
            if (read) {
                parts[i] = uses_of(*read, catalog);
                continue;
            }
            const std::lock_guard lock(mutex);
            failed = read.error();
        }
    };
    {
        std::vector<std::jthread> threads;
        for (uint32_t i = 1; i < std::min<size_t>(jobs, parts.size()); ++i) threads.emplace_back(work);
        work();
    }
    if (failed) return *failed;
    return parts;
}

uint32_t slots_of(const city::CityCatalog& catalog, uint32_t map) {
    uint32_t slots = 0;
    for (const uint32_t label : catalog.facade_maps.map(map).labels) slots |= 1U << slot_of(label);
    return slots;
}

/// A material of a palette is seen where the map uses its slot.
void note_palettes(const std::set<std::pair<uint32_t, uint32_t>>& facades, const city::CityCatalog& catalog,
                   std::vector<ImageUse>& uses) {
    std::map<uint32_t, uint32_t> slots;
    std::set<uint32_t> materials;
    for (const auto& [map, palette] : facades) {
        const auto [known, is_new] = slots.try_emplace(map, 0);
        if (is_new) known->second = slots_of(catalog, map);
        for (uint32_t slot = 0; slot < FACADE_PALETTE_SLOTS; ++slot) {
            if ((known->second >> slot) & 1U) materials.insert(catalog.palettes[palette].material[slot]);
        }
    }
    for (const uint32_t index : materials) {
        const city::Material& material = catalog.materials[index];
        if (material.image < 0 || static_cast<size_t>(material.image) >= uses.size()) continue;
        const double metres = material.metres_per_repeat > 0 ? static_cast<double>(material.metres_per_repeat) : 1.0;
        ImageUse& use = uses[static_cast<size_t>(material.image)];
        use.on_facades = true;
        add_coverage(use.coverage, {metres, metres, 1, 1, 1, 1, 0});
    }
}

uint32_t halved(uint32_t side, double metres, double texel_metres) {
    uint32_t size = side;
    while (size > 1 && (size > kGreatestSide || metres / size < texel_metres / kFinestShare)) size /= 2;
    return size;
}

}  // namespace

double ImageUse::shown_share() const {
    if (on_facades || !coverage.used()) return 1;
    double box = 1;
    for (size_t axis = 0; axis < 2; ++axis) {
        const double low = clamped ? std::clamp(lowest[axis], 0.0, 1.0) : lowest[axis];
        const double high = clamped ? std::clamp(highest[axis], 0.0, 1.0) : highest[axis];
        box *= std::clamp(high - low, 0.0, 1.0);
    }
    return std::min(box, coverage.repeats);
}

Result<std::vector<ImageUse>> find_image_uses(quadtree::ObjectSpool& objects, const city::CityCatalog& catalog,
                                              uint32_t jobs) {
    std::vector<ImageUse> uses(catalog.images.size());
    if (uses.empty()) return uses;
    const auto parts =
        read_parts(objects, catalog, jobs != 0 ? jobs : std::max(1U, std::thread::hardware_concurrency()));
    if (!parts) return parts.error();
    std::set<std::pair<uint32_t, uint32_t>> facades;
    for (const PartUses& part : *parts) {
        for (const auto& [image, use] : part.images) {
            if (image < uses.size()) add(uses[image], use);
        }
        facades.insert(part.facades.begin(), part.facades.end());
    }
    note_palettes(facades, catalog, uses);
    return uses;
}

ChartSize finest_size(ChartSize image, const ImageUse& use, double texel_metres) {
    const bool known = use.coverage.used();
    const double unknown = std::numeric_limits<double>::infinity();
    return {halved(image.width, known ? use.coverage.metres_u : unknown, texel_metres),
            halved(image.height, known ? use.coverage.metres_v : unknown, texel_metres)};
}

}  // namespace citystream::tiles::layers
