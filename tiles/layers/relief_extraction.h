// Facades out of detailed models: finds the walls of LoD3 buildings, turns the geometry near them (windows, doors,
// reveals, sills, balconies) into displacement and material maps (city::FacadeWall), and takes the triangles that the
// relief shows out of the mesh. What a height field cannot hold stays mesh: floating parts that are seen from behind or
// below, sloped and curved parts beyond the tolerance, everything outside the depth window.
//
// How, file by file (all relief_extraction_*): _frame finds the planes of the walls; _parts sorts the triangles near
// one into fronts, sides and the rest, and joins fronts to patches of one depth; _cells cuts the wall where patches
// begin and end and draws every triangle into the cells; _decision finds the patches whose sides the model does not
// have (_surroundings) and says which triangles the others show or hide; _pictures and _palette choose the colours;
// _map makes the map (_ledges: its sides' colours), on texels of 1 mm (coarser along sides of more than 8 m), which the
// facade stretches to the wall; _views looks at it from outside, and what is not seen as before is given back.
//
// Errors: a front that was taken out lies within `tolerance` of the relief's depth; slanting outlines become steps of
// 15 mm at most (more on walls of millions of cells); the sides that a relief draws are the model's within the sum of
// both, but for at most a quarter of a patch's sides where the model has a gap instead. Images become the mean colour
// of what a surface shows of them, but wide surfaces of strong pattern stay mesh. Nothing is shown twice: a triangle is
// either relief or mesh, and the relief shows what is behind it, or is open, where the mesh shows a surface.

#pragma once

#include <cstdint>
#include <memory>

#include "tiles/city/city_model.h"

namespace citystream::tiles::layers {

struct ReliefExtractionOptions {
    double tolerance = 0.02;      ///< metres between a replaced triangle and the relief
    double depth_behind = 1.5;    ///< metres behind a wall's plane that still belong to its relief
    double depth_before = 2.0;    ///< metres in front
    double least_area = 6;        ///< square metres of wall, window and door polygons that make a facade
    uint32_t least_replaced = 8;  ///< triangles that a facade must take out of the mesh, or it is not made
    double most_wrong = 0.008;    ///< share of the checked rays that may see something else than before
};

/// Sums over all buildings.
struct ReliefExtractionReport {
    uint64_t buildings = 0;  ///< buildings looked at
    uint64_t buildings_with_relief = 0;
    uint64_t candidate_planes = 0;      ///< walls large enough
    uint64_t facades = 0;               ///< of these, made
    uint64_t facades_given_back = 0;    ///< not made, because too many rays saw something else
    uint64_t rays = 0, rays_wrong = 0;  ///< that looked at the facades made, and saw something else than before
    uint64_t triangles_before = 0;      ///< of all buildings
    uint64_t triangles_after = 0;       ///< kept as mesh
    uint64_t triangles_hidden = 0;      ///< of those taken out: inside the solid, seen from nowhere
    uint64_t materials_merged = 0;      ///< materials shown by another's colour, because a palette has 16 slots
    uint64_t textures_flattened = 0;    ///< triangles shown in the mean colour of their image
    double largest_error = 0;           ///< metres between a replaced triangle and its relief
    double mean_error = 0;              ///< metres, mean over the area of what was replaced
    double facade_area = 0;             ///< square metres of the facades' rectangles
};

/// Call from one thread at a time; the result depends only on the objects and their order.
class ReliefExtractor {
  public:
    /// `catalog` must outlive the extractor; it receives maps, palettes and materials.
    ReliefExtractor(city::CityCatalog& catalog, ReliefExtractionOptions options);
    ~ReliefExtractor();
    ReliefExtractor(const ReliefExtractor&) = delete;
    ReliefExtractor& operator=(const ReliefExtractor&) = delete;

    /// Replaces what it can of a building; leaves other objects, and buildings that carry facades, as they are. Never
    /// fails: what cannot be understood stays mesh.
    void extract(city::CityObject& object);

    ReliefExtractionReport report() const;

  private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace citystream::tiles::layers
