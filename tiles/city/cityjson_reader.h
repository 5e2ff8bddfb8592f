// CityJSON 1.0, 1.1 and 2.0 (one document) and CityJSONSeq (one feature a line).
//
// Read: MultiSurface, CompositeSurface, Solid, MultiSolid, CompositeSolid, GeometryInstance (templates, matrix,
// reference point); LoD choice (numbers of 1.0 too); semantic surfaces; transform; materials (diffuseColor) and
// textures (image, wrapMode, coordinates per ring) of the default theme, else of the first one; parents and children;
// referenceSystem; extension types ("+X") as other objects. Reported, not drawn: MultiPoint and MultiLineString;
// surfaces with vertex indices out of range; objects without geometry of the LoD asked for. A document is held in
// memory whole (about ten times its size at the peak); a sequence only one feature at a time.
#pragma once

#include "codec/result.h"
#include "tiles/city/city_reading.h"
#include "tiles/city/text_source.h"

namespace citystream::tiles::city {

/// Reads one file into the city. Error: not well-formed (with line and byte), no CityJSON, unknown version, another
/// CRS; of a sequence what came before has been sent.
Status read_cityjson(TextSource& source, CityReading& reading);

}  // namespace citystream::tiles::city
