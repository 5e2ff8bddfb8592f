// EPSG codes from the many spellings of a coordinate reference system's name.
#pragma once

#include <cstdint>
#include <string_view>

namespace citystream::tiles::city {

/// "EPSG:32632", "urn:ogc:def:crs:EPSG::7415", "https://www.opengis.net/def/crs/EPSG/0/7415",
/// "http://www.opengis.net/gml/srs/epsg.xml#25832", compound "urn:ogc:def:crs,crs:EPSG::25832,crs:EPSG::5783" (the
/// first, horizontal one), "urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH". 0 when there is no code in it.
int32_t epsg_of(std::string_view name);

/// True for the common systems whose coordinates are degrees: they cannot be drawn as metres.
bool is_geographic(int32_t epsg);

}  // namespace citystream::tiles::city
