// Meyer 2012, Tables 3.2 and 3.3 and section 3.7.1: what the thesis measured of adaptive (AP) and constrained precision
// (CAP), for printing beside our own figures.
#pragma once

#include <array>

namespace citystream::bench {

/// At an average bit level: positions in percent of float3, AP and CAP; milliseconds a frame with AP, CAP and floats
/// (1920 x 1080, 16 samples, GeForce GTX 580).
struct ThesisPrecision {
    double level;
    std::array<double, 2> car_percent, david_percent;
    std::array<double, 3> car_milliseconds, david_milliseconds;
};

inline constexpr std::array<ThesisPrecision, 8> kThesisPrecision = {{
    {5, {14.9, 37.8}, {16.0, 26.3}, {10.6, 16.0, 16.4}, {22.6, 28.9, 68.5}},
    {6, {18.0, 38.0}, {19.0, 26.8}, {10.6, 16.3, 16.7}, {22.4, 28.6, 68.7}},
    {7, {20.7, 38.1}, {22.2, 28.1}, {10.6, 16.1, 16.2}, {22.3, 28.1, 66.9}},
    {8, {24.2, 38.4}, {25.3, 30.0}, {10.8, 16.3, 16.2}, {22.4, 27.9, 58.1}},
    {9, {28.3, 39.1}, {28.4, 32.4}, {12.3, 17.4, 17.0}, {22.5, 37.0, 50.4}},
    {10, {31.2, 39.8}, {31.4, 35.0}, {15.8, 20.4, 19.8}, {27.6, 39.6, 38.9}},
    {11, {34.5, 41.2}, {34.6, 38.0}, {19.9, 22.6, 21.3}, {30.6, 31.3, 29.6}},
    {12, {37.5, 43.0}, {37.5, 40.7}, {16.9, 18.8, 16.9}, {27.4, 28.1, 26.1}},
}};

/// Decibels of the pictures to those of floats.
struct ThesisPicture {
    const char* model;
    double adaptive_db, constrained_db;
};
inline constexpr std::array<ThesisPicture, 2> kThesisPictures = {{{"Car", 31, 45}, {"David", 31, 42}}};

}  // namespace citystream::bench
