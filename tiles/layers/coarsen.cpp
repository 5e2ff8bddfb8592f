#include "tiles/layers/coarsen.h"

#include <algorithm>
#include <cmath>

#include "tiles/layers/block.h"
#include "tiles/layers/cutout.h"
#include "tiles/layers/decimate.h"
#include "tiles/layers/ground.h"

namespace citystream::tiles::layers {
namespace {

using quadtree::BuildFacade;
using quadtree::BuildObject;
using quadtree::BuildTriangle;
using quadtree::Paint;
using quadtree::PaintKind;

constexpr double kErrorGrowth = 1.6;  // a try that does not fit is repeated with this much more error
constexpr int kMostTries = 24;
constexpr uint64_t kGroundShare = 3;  // the ground may take a third of the triangles
constexpr size_t kDetailed = 60;      // objects with more triangles than this are decimated when no block will do
constexpr double kFacadeErrors = 3;   // a facade no larger than this many times the error is one colour

uint64_t triangle_count(const std::vector<BuildObject>& objects) {
    uint64_t count = 0;
    for (const BuildObject& object : objects) count += object.triangles.size() + 2 * object.facades.size();
    return count;
}

class Coarsener {
  public:
    Coarsener(const CoarsenSpec& spec, const TileWorkshop& workshop, double error)
        : spec_(spec), workshop_(workshop), error_(error) {}

    std::vector<BuildObject> run(std::vector<BuildObject> objects) const {
        merge_crowds(objects, std::max<int64_t>(1, std::llround(error_ / 2 * kGridUnitsPerMetre)), workshop_.images,
                     workshop_.facades);
        for (BuildObject& object : objects) {
            coarsen_object(object);
        }
        return objects;
    }

  private:
    double allowed(const BuildObject& object) const { return error_ - static_cast<double>(object.error); }

    void coarsen_object(BuildObject& object) const {
        if (allowed(object) <= 0) return;
        if (see_through(object, workshop_.images)) {
            if (auto thin = thin_faces(object, allowed(object), workshop_.images)) object = std::move(*thin);
        } else if (!shows_pictures(object)) {
            if (auto block = make_block(object, allowed(object), workshop_.images, workshop_.facades)) {
                object = std::move(*block);
                return;
            }
        }
        flatten_facades(object);
        blur_small_facades(object);
        if (object.triangles.size() > kDetailed) decimate(object, allowed(object) / 2);
    }

    /// Facades whose relief is below what the object may still lose become flat.
    void flatten_facades(BuildObject& object) const {
        std::vector<BuildFacade> kept;
        double lost = 0;
        for (const BuildFacade& facade : object.facades) {
            const FacadeFacts& facts = workshop_.facades.facts(facade.map);
            if (kReliefWeight * facts.flat_loss() > allowed(object)) {
                kept.push_back(facade);
                continue;
            }
            lost = std::max(lost, facts.flat_loss());
            add_flat_wall(object, facade, facts.flat, {PaintKind::kFacade, facade.map, facade.palette});
        }
        object.facades = std::move(kept);
        object.error += static_cast<float>(lost);
    }

    bool is_one_colour(uint32_t map) const {
        const FacadeFacts& facts = workshop_.facades.facts(map);
        return std::max(facts.width_metres, facts.height_metres) <= kFacadeErrors * error_;
    }

    /// Whether a wall of the object shows windows, which a block would lose.
    bool shows_pictures(const BuildObject& object) const {
        return std::any_of(object.facades.begin(), object.facades.end(),
                           [&](const BuildFacade& facade) { return !is_one_colour(facade.map); }) ||
               std::any_of(object.paints.begin(), object.paints.end(), [&](const Paint& paint) {
                   return paint.kind == PaintKind::kFacade && !is_one_colour(paint.a);
               });
    }

    /// Flat facades of which only a few pixels would be seen take their mean colour.
    void blur_small_facades(BuildObject& object) const {
        for (Paint& paint : object.paints) {
            if (paint.kind == PaintKind::kFacade && is_one_colour(paint.a))
                paint = Paint::flat(workshop_.facades.mean_colour(paint.a, paint.b));
        }
    }

    const CoarsenSpec& spec_;
    const TileWorkshop& workshop_;
    double error_;
};

}  // namespace

CoarseContent coarsen(TileContent children, const CoarsenSpec& spec, const TileWorkshop& workshop) {
    std::vector<BuildObject> ground, things;
    for (BuildObject& object : children.objects)
        (object.ground() && object.facades.empty() ? ground : things).push_back(std::move(object));
    CoarseContent coarse;
    coarse.content.ground_pictures = std::move(children.ground_pictures);
    coarsen_ground(ground, coarse.content.ground_pictures,
                   {spec.corner, spec.side, spec.error_metres, spec.triangle_limit / kGroundShare}, workshop.images);
    if (ground.empty()) coarse.content.ground_pictures.clear();
    const uint64_t ground_triangles = triangle_count(ground),
                   limit = std::max(spec.triangle_limit, 2 * ground_triangles);
    double error = spec.error_metres;
    std::vector<BuildObject> result = Coarsener(spec, workshop, error).run(things);
    for (int i = 0; i < kMostTries && triangle_count(result) + ground_triangles > limit; ++i) {
        error *= kErrorGrowth;
        result = Coarsener(spec, workshop, error).run(std::move(result));
    }
    coarse.allowed_error = error;
    for (const BuildObject& object : ground) coarse.error = std::max(coarse.error, object.error);
    for (const BuildObject& object : result) coarse.error = std::max(coarse.error, object.error);
    coarse.content.objects = std::move(ground);
    coarse.content.objects.insert(coarse.content.objects.end(), std::make_move_iterator(result.begin()),
                                  std::make_move_iterator(result.end()));
    return coarse;
}

}  // namespace citystream::tiles::layers
