#include "client/light/sun_position.h"

#include <cmath>
#include <numbers>

namespace citystream::client {

double sun_declination(double day_of_year) {
    const double day_angle = 2 * std::numbers::pi * (day_of_year - 1) / 365;
    return 0.006918 - 0.399912 * std::cos(day_angle) + 0.070257 * std::sin(day_angle) -
           0.006758 * std::cos(2 * day_angle) + 0.000907 * std::sin(2 * day_angle) -
           0.002697 * std::cos(3 * day_angle) + 0.00148 * std::sin(3 * day_angle);
}

Direction sun_direction(double latitude_degrees, double day_of_year, double solar_hour) {
    const double latitude = latitude_degrees * std::numbers::pi / 180;
    const double declination = sun_declination(day_of_year + solar_hour / 24);
    const double hour_angle = (solar_hour - 12) * std::numbers::pi / 12;
    const double across = std::cos(declination) * std::cos(hour_angle);
    return {-std::cos(declination) * std::sin(hour_angle),
            std::cos(latitude) * std::sin(declination) - std::sin(latitude) * across,
            std::sin(latitude) * std::sin(declination) + std::cos(latitude) * across};
}

}  // namespace citystream::client
