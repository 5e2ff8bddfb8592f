// Drone flights that were recorded elsewhere (../shared/data/flight_paths), moved onto a city.
#pragma once

#include <string>
#include <vector>

#include "codec/result.h"
#include "tests/bench/camera_tours.h"
#include "tests/bench/city_heights.h"
#include "tests/bench/sample_city.h"

namespace citystream::bench {

/// A track (CSV: t_s,lat,lon,alt_m and, where the log has them, gimbal angles) as a path of `cameras` cameras, evenly
/// spaced in time: its middle over that of the city, shrunk to a half of the city's sides where it is longer, its
/// lowest sample 2 m above the lowest point of the city, and cameras that would then be in or under something 2 m above
/// it. Without gimbal angles cameras look ahead and 15 degrees down.
Result<Tour> recorded_track(const SampleCity& city, const CityHeights& heights, const std::string& file, int cameras);

/// The three longest recorded tracks; where the data is not there the made-up tours_of instead.
std::vector<Tour> tracks_of(const SampleCity& city, const CityHeights& heights, int cameras = 24);

}  // namespace citystream::bench
