// The knobs of a report that are turned when a city is built (saliency, rate-distortion strength, the form of
// meshes and of radiance): builds the city once per setting with citystream-build, so that a sweep can fly the archives
// side by side.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "client/report/sweep.h"
#include "codec/result.h"

namespace citystream::client {

struct VariantOptions {
    std::string builder;                 ///< the program citystream-build
    std::vector<std::string> arguments;  ///< that the city is built with: inputs and options, without -o
    std::string folder;                  ///< for the archives; made when it is not there
    std::function<void(const std::string& line)> progress;
};

/// Whether a knob's settings are archives of their own: "saliency", "rate-distortion", "mesh-transport", "normal-bits",
/// "mesh-topology", "precision", "mesh-steps", "lattice", "directions", "local-directions" and
/// "radiance-transport", each the name of an option of citystream-build.
bool is_built(const std::string& knob);

/// citystream-build beside the running program; its plain name (to be found by PATH) where there is none.
std::string find_builder();

/// What citystream-build is called with for a setting: `arguments`, the setting's option behind them, and the output.
std::vector<std::string> build_command(const VariantOptions& options, const Setting& setting,
                                       const std::string& archive);

/// Builds an archive for every setting whose knob is_built, one after the other, and sets its `place`. Error: the
/// folder, or a builder that fails (its own line says why).
Status build_variants(const VariantOptions& options, std::vector<Setting>& settings);

}  // namespace citystream::client
