// What citystream-fly is asked for: its command line, and what that means.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "client/light/flight_light.h"
#include "client/path/frame_size.h"
#include "client/render/chart_transport.h"
#include "client/render/facade_renderer.h"
#include "client/render/vulkan_renderer.h"
#include "client/select/view_options.h"
#include "client/stream/city_streamer.h"
#include "client/stream/fetcher.h"
#include "codec/atlas/facade_tint.h"
#include "codec/result.h"

namespace citystream::client {

/// As it is typed; empty where nothing is.
struct FlyArguments {
    std::string place, path, reference, mode = "offline", network;
    std::string frames_folder, video, stats;
    double fps = 10;
    ViewArguments view;
    std::string occlusion = "on";
    uint32_t supersample = 1;
    std::string facade_renderer{facade_renderer_name(FacadeRenderer::kPatch)}, facade_tint = "0";
    uint32_t facade_samples = kFacadeSamples;
    std::string chart_transport{chart_transport_name(ChartTransport::kTable)};
    LightArguments light;
    std::string meso, btf_budget, btf_texels;
    std::string gpu_budget = "512MiB", index_arena = "64MiB", host_budget = "1GiB", device;
    bool list_devices = false, validation = false, json = false;
};

/// Options that bind to the arguments, in groups as --help lists them.
void add_fly_options(CLI::App& app, FlyArguments& arguments);

/// What is typed, and the parts of it that are texts as values.
struct FlyOptions : FlyArguments {
    FrameSize size;
    uint64_t gpu_bytes = 0, index_arena_bytes = 0, host_bytes = 0, btf_bytes = 0;
    std::optional<NetworkShape> shape;
    FacadeRenderer renderer = FacadeRenderer::kPatch;
    ChartTransport transport = ChartTransport::kTable;
    ReliefOptions relief;
    codec::atlas::FacadeTint tint;

    bool has_meso() const { return light.asked_for() && meso == "on"; }
};

/// Error: wrong usage, one line that names the option: a text that is no value, or options that do not go together.
Result<FlyOptions> read_fly_options(const FlyArguments& arguments);

/// The same for who draws and who streams.
RendererOptions renderer_options(const FlyOptions& options);
StreamerOptions streamer_options(const FlyOptions& options);

}  // namespace citystream::client
