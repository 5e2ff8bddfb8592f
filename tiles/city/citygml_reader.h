// CityGML 2.0 and 3.0, streamed.
//
// Buildings in full: parts, boundary surfaces (wall, roof, ground, closure, outer floor and ceiling), openings (2.0
// Window and Door, 3.0 WindowSurface and DoorSurface), installations; Solid, CompositeSurface, MultiSurface,
// MultiGeometry, TriangulatedSurface, OrientableSurface; references (xlink:href) to surfaces earlier or later in the
// same feature. Of a LoD the boundary surfaces are taken where there are any, else the solid or multi-surface; a
// surface referred to from both is drawn once. Appearance: X3DMaterial (diffuseColor) and ParameterizedTexture
// (imageURI, wrapMode, coordinates per ring) inside the feature, or of the whole model anywhere in the file; the first
// that names a surface wins, front before back. Other features (roads, water, vegetation, land use, bridges, relief,
// furniture, generics) are drawn from the same kinds of geometry. Reported with counts, not drawn: rooms and other
// interiors, implicit geometries, generated texture coordinates, groups. The file is read twice (model-wide appearance
// first); memory holds that appearance and one top-level feature.
#pragma once

#include "codec/result.h"
#include "tiles/city/city_reading.h"
#include "tiles/city/text_source.h"

namespace citystream::tiles::city {

/// Error: not well-formed XML (with line and byte), no CityGML, another CRS, a document type declaration (refused),
/// nesting beyond 256 levels, a feature beyond 2^26 points. The features before the fault have been sent.
Status read_citygml(TextSource& source, CityReading& reading);

}  // namespace citystream::tiles::city
