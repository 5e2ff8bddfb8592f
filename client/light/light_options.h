// The options of LightArguments on a program's command line.
#pragma once

#include <string>
#include <vector>

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
           "by `sky`, an analytic one")
        ->check(command_line::not_empty());
    app.add_option("--environment-rotation", light.rotation_degrees, "turns it clockwise seen from above, degrees (0)")
        ->check(command_line::number_from(-36000.0, 36000.0));
    add_sky_options(app, light);
    app.add_option("--environment-path", light.environment_path,
                   "how the environment changes with the path's time: CSV with the columns time_s,environment and "
                   "rotation_degrees,hour")
        ->check(command_line::not_empty());
    app.add_option("--exposure", light.exposure,
                   "auto: level white ground is white, dusk and night darker; or stops: radiance times 2^STOPS (auto)");
    app.add_option("--sun", light.sun,
                   "apart: the sun is taken out of the environment and lights on its own; map: it stays in (apart)")
        ->check(CLI::IsMember({"apart", "map"}));
}

inline CLI::Validator matrix_forms() {
    return CLI::IsMember(std::vector<std::string>(kMatrixFormNames.begin(), kMatrixFormNames.end()));
}

/// Of cities with radiance layers.
inline void add_transfer_options(CLI::App& app, LightArguments& light) {
    const TransferQuality usual;
    app.add_option("--light-tolerance", light.light_tolerance,
                   fmt::format("part of an even sky's light that a place may get wrong ({:g})", usual.light_tolerance))
        ->check(command_line::number_from(0.0, 1.0));
    app.add_option("--matrix", light.matrix,
                   fmt::format("how what is seen from where is kept in GPU memory: biclusters or rows; same frames, "
                               "other memory and time ({})",
                               matrix_form_name(usual.matrix)))
        ->check(matrix_forms());
    app.add_option(
           "--matrix-error", light.matrix_error,
           fmt::format("part of an even sky's light by which each row of it may be too low, for less memory and time "
                       "({:g})",
                       usual.matrix_error))
        ->check(command_line::number_from(0.0, 1.0));
}

}  // namespace citystream::client
