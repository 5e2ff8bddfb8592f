// What citystream-report is asked for: its command line, and what that means.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/light/flight_light.h"
#include "client/report/sweep.h"
#include "client/select/view_options.h"
#include "codec/result.h"

namespace citystream::client {

/// As it is typed; empty where nothing is.
struct ReportArguments {
    std::string city, path_file, folder, reference, device;
    uint32_t frames = SweepOptions().frames, supersample = SweepOptions().supersample;
    bool json = false;
    /// Knobs: every value of a list is a setting.
    std::vector<double> tolerances;  ///< kUsualTolerances when no knob is given
    std::vector<double> gpu_budgets_mib, relief_tolerances, texel_tolerances, position_tolerances;
    std::vector<uint32_t> rate_distortions, normal_bits;
    std::vector<std::string> saliencies, mesh_transports, mesh_topologies, precisions, mesh_steps;
    std::vector<std::string> map_levels, facade_renderers, facade_samples, also;
    std::vector<uint32_t> lattices, directions, local_directions;
    std::vector<double> light_tolerances, matrix_errors;
    std::vector<std::string> matrices, radiance_transports;
    /// Where the knobs that are not turned stand.
    ViewArguments view;
    std::string facade_renderer{facade_renderer_name(FacadeRenderer::kPatch)};
    LightArguments light;
    std::optional<uint32_t> reference_rays;
    std::vector<std::string> build;  ///< behind "--": what citystream-build is called with
};

/// Options that bind to the arguments, in groups as --help lists them.
void add_report_options(CLI::App& app, ReportArguments& arguments);

/// What a report is made of. The path and the light are yet to be read.
struct ReportPlan {
    SweepOptions sweep;
    std::vector<Setting> settings;  ///< in the order of the page
};

/// Error: wrong usage, one line that names the option: a text that is no value, or options that do not go together.
Result<ReportPlan> read_report_options(const ReportArguments& arguments);

}  // namespace citystream::client
