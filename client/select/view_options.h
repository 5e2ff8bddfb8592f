// What a viewer asks of a city, on the command lines of all programs that fly one.
#pragma once

#include <optional>
#include <string>

#include "client/path/frame_size.h"
#include "client/select/facade_dictionary.h"
#include "client/select/relief_arguments.h"
#include "command_line/command_line.h"

namespace citystream::client {

/// What is typed.
struct ViewArguments {
    std::string size = "1280x720", map_level = "auto";
    double tolerance_pixels = 1;
    std::optional<double> relief_tolerance_pixels, texel_tolerance_pixels, position_tolerance_pixels;
};

inline void add_view_options(CLI::App& app, ViewArguments& view) {
    app.add_option("--size", view.size, "frame size in pixels")->capture_default_str();
    app.add_option("--tolerance", view.tolerance_pixels, "largest error in pixels")
        ->capture_default_str()
        ->check(command_line::number_from(0.01, 1e6));
    app.add_option("--relief-tolerance", view.relief_tolerance_pixels,
                   "facade relief that projects to fewer pixels is drawn flat, and not fetched (default: --tolerance)")
        ->check(command_line::number_from(0.01, 1e6));
    app.add_option("--map-level", view.map_level,
                   "level of every facade map, 0 the coarsest; auto: as coarse as --tolerance lets it be")
        ->capture_default_str()
        ->check(CLI::IsMember(map_level_names()));
}

/// Of programs that draw.
inline void add_drawn_view_options(CLI::App& app, ViewArguments& view) {
    app.add_option("--texel-tolerance", view.texel_tolerance_pixels,
                   "largest size of a texel in pixels, of pictures that are not shown as fine as they are (default: "
                   "--tolerance)")
        ->check(command_line::number_from(0.01, 1e6));
    app.add_option("--position-tolerance", view.position_tolerance_pixels,
                   "pixels that a vertex may be off its place, for want of low bits of its position (default: a "
                   "thirty-second of --tolerance)")
        ->check(command_line::number_from(0.01, 1000.0));
}

/// Error: one line that names the option.
inline Result<FrameSize> read_size(const ViewArguments& view, uint32_t greatest_side = 16384) {
    auto size = parse_frame_size(view.size, greatest_side);
    if (!size) return Error{"--size: " + size.error().text()};
    return size;
}
inline Result<ReliefOptions> read_relief(const ViewArguments& view) {
    return parse_relief_options(view.map_level, view.relief_tolerance_pixels);
}

}  // namespace citystream::client
