// The options of LightArguments on a program's command line.
#pragma once

#include "client/light/flight_light.h"
#include "command_line/command_line.h"

namespace citystream::client {

inline void add_sky_options(CLI::App& app, LightArguments& light) {
    const LightSettings usual;
    app.add_option("--hour", light.hour, "true solar time of `sky` (12)")->check(command_line::number_from(0.0, 24.0));
    app.add_option("--latitude", light.latitude_degrees,
                   fmt::format("where `sky` is seen from, degrees, north above 0 ({:g})", usual.latitude_degrees))
        ->check(command_line::number_from(-90.0, 90.0));
    app.add_option("--day", light.day_of_year,
                   fmt::format("day of the year of `sky`, 1 the first of January ({:g}: 21 June)", usual.day_of_year))
        ->check(command_line::number_from(1.0, 366.0));
    app.add_option("--turbidity", light.turbidity,
                   fmt::format("haze of `sky`: 2 very clear to 10 ({:g})", usual.turbidity))
        ->check(command_line::number_from(2.0, 10.0));
}

inline void add_environment_options(CLI::App& app, LightArguments& light) {
    app.add_option(
        "--environment", light.environment,
        "light the city by a picture of what is around it (.exr, .hdr: latitude and longitude, or a cube), or "
        "by `sky`, an analytic one");
    app.add_option("--environment-rotation", light.rotation_degrees, "turns it clockwise seen from above, degrees (0)")
        ->check(command_line::number_from(-36000.0, 36000.0));
    add_sky_options(app, light);
    app.add_option("--environment-path", light.environment_path,
                   "how the environment changes with the path's time: CSV with the columns time_s,environment and "
                   "rotation_degrees,hour");
    app.add_option("--exposure", light.exposure,
                   "auto: level white ground is white, dusk and night darker; or stops: radiance times 2^STOPS (auto)");
    app.add_option("--sun", light.sun,
                   "apart: the sun is taken out of the environment and lights on its own; map: it stays in (apart)")
        ->check(CLI::IsMember({"apart", "map"}));
}

}  // namespace citystream::client
