#include "client/fly/fly_options.h"

#include <fmt/format.h>

#include "client/light/light_options.h"
#include "client/stream/byte_count.h"

namespace citystream::client {
namespace {

/// In realtime: an apartment block's mask takes some twenty frames, its BTF four.
constexpr uint64_t kReliefRaysOfAFrame = 65536;

/// What is flown and what comes of it.
void add_flight_options(CLI::App& app, FlyArguments& arguments) {
    app.add_option("place", arguments.place, "http://host:port[/city], a .3tz archive, or an unpacked folder");
    app.add_option("--path", arguments.path, "camera path: CSV with the columns t,x,y,z,yaw,pitch,fov");
    app.add_option("--reference", arguments.reference,
                   "draw this uncompressed city (.glb) with the reference renderer instead");
    app.add_option("--mode", arguments.mode,
                   "offline: each frame waits for all it asked for; realtime: draws what is there")
        ->capture_default_str()
        ->check(CLI::IsMember({"offline", "realtime"}));
    app.add_option("--fps", arguments.fps, "frames per second of the path")
        ->capture_default_str()
        ->check(command_line::number_from(0.001, 1000.0));
    app.add_option("--network", arguments.network, "shape the network: RATE,ROUNDTRIP, for example 5mbit,38ms");
    app.add_option("--frames", arguments.frames_folder, "folder for the frames (PNG)");
    app.add_option("--video", arguments.video, "film of the frames (MP4)");
    app.add_option("--stats", arguments.stats, "statistics of every frame (JSON)");
    app.add_flag("--json", arguments.json, "print the summary as JSON");
}

/// How exactly the city is shown, beside ViewArguments.
void add_quality_options(CLI::App& app, FlyArguments& arguments) {
    app.add_option("--occlusion", arguments.occlusion,
                   "on: what near surfaces hide is neither fetched nor drawn (offline mode)")
        ->capture_default_str()
        ->check(CLI::IsMember({"on", "off"}));
    app.add_option("--supersample", arguments.supersample, "samples per pixel and axis")
        ->capture_default_str()
        ->check(command_line::number_from(1, 2));
}

/// How facades and pictures are drawn.
void add_drawing_options(CLI::App& app, FlyArguments& arguments) {
    app.add_option("--facade-renderer", arguments.facade_renderer, "how relief is ray cast")
        ->capture_default_str()
        ->check(CLI::IsMember(facade_renderer_names()));
    app.add_option("--facade-samples", arguments.facade_samples,
                   "rays of a pixel that covers more than the finest parts of its facade: 5 and 13 keep far windows "
                   "from shimmering")
        ->capture_default_str()
        ->check(CLI::IsMember(facade_sample_names()));
    app.add_option("--facade-tint", arguments.facade_tint,
                   "STRENGTH[,METRES]: multiplies walls by a colour that changes over the city, 0 to 1, the next one "
                   "every METRES (40); the reference renderer does the same")
        ->capture_default_str();
    app.add_option("--chart-transport", arguments.chart_transport,
                   "how a triangle's chart in a page comes to the vertex shader (archives of --atlas-form pages): same "
                   "frames, other memory and time")
        ->capture_default_str()
        ->check(CLI::IsMember(chart_transport_names()));
}

/// Light on relief, beside LightArguments.
void add_meso_options(CLI::App& app, FlyArguments& arguments) {
    app.add_option("--meso", arguments.meso,
                   "on: relief of facades shades itself, near by masks, further away by BTFs, where walls have 8 x 8 "
                   "local directions (seconds a map on software drivers); off: it stands free (off)")
        ->check(CLI::IsMember({"on", "off"}));
    app.add_option("--btf-budget", arguments.btf_budget, "memory for BTFs, taken when the first is made (64MiB)");
    app.add_option(
           "--btf-texels", arguments.btf_texels,
           "texels of a BTF across: finer ones show finer relief from further away, in memory and time that grow "
           "as their square (16)")
        ->check(CLI::IsMember({"4", "8", "16", "32", "64"}));
}

/// What the machine has for it.
void add_machine_options(CLI::App& app, FlyArguments& arguments) {
    app.add_option("--gpu-budget", arguments.gpu_budget, "most GPU memory for tiles")->capture_default_str();
    app.add_option(
           "--index-arena", arguments.index_arena,
           "GPU memory beside the budget for decoded strip code (archives of --mesh-topology strip-code); a frame "
           "that needs more is drawn in rounds")
        ->capture_default_str();
    app.add_option("--host-budget", arguments.host_budget, "most host memory for tiles")->capture_default_str();
    app.add_option("--device", arguments.device, "part of a device's name, or its index");
    app.add_flag("--list-devices", arguments.list_devices, "list the devices and exit");
    app.add_flag("--validation", arguments.validation,
                 "run with the Vulkan validation layer; messages fail the flight");
}

Status check_light(const FlyArguments& arguments) {
    if (Status good = check_light_arguments(arguments.light); !good) return good;
    if (!arguments.light.asked_for()) {
        if (!arguments.meso.empty()) return needs_environment("--meso");
        if (!arguments.btf_budget.empty()) return needs_environment("--btf-budget");
        if (!arguments.btf_texels.empty()) return needs_environment("--btf-texels");
    } else if (!arguments.reference.empty()) {
        return Error{"--reference draws without the light of an environment: leave one of the two out"};
    }
    if (!arguments.btf_budget.empty() && arguments.meso != "on") return Error{"--btf-budget needs --meso on"};
    if (!arguments.btf_texels.empty() && arguments.meso != "on") return Error{"--btf-texels needs --meso on"};
    return Done{};
}

Status read_bytes(const char* option, const std::string& text, uint64_t& bytes) {
    const auto count = parse_byte_count(text);
    if (!count) return Error{std::string(option) + ": " + count.error().text()};
    bytes = *count;
    return Done{};
}

Status read_budgets(FlyOptions& options) {
    if (Status good = read_bytes("--gpu-budget", options.gpu_budget, options.gpu_bytes); !good) return good;
    if (Status good = read_bytes("--index-arena", options.index_arena, options.index_arena_bytes); !good) return good;
    if (Status good = read_bytes("--host-budget", options.host_budget, options.host_bytes); !good) return good;
    options.btf_bytes = RendererOptions().btf_budget_bytes;
    return options.btf_budget.empty() ? Status(Done{})
                                      : read_bytes("--btf-budget", options.btf_budget, options.btf_bytes);
}

Status read_drawing(FlyOptions& options) {
    const auto renderer = facade_renderer_named(options.facade_renderer);
    if (!renderer) return Error{"--facade-renderer: there is no " + options.facade_renderer};
    options.renderer = *renderer;
    const auto tint = codec::atlas::parse_facade_tint(options.facade_tint);
    if (!tint) return Error{"--facade-tint: " + tint.error().text()};
    options.tint = *tint;
    const auto transport = chart_transport_named(options.chart_transport);
    if (!transport) return Error{"--chart-transport: there is no " + options.chart_transport};
    options.transport = *transport;
    return Done{};
}

}  // namespace

void add_fly_options(CLI::App& app, FlyArguments& arguments) {
    add_flight_options(app, arguments);
    add_view_options(app, arguments.view);
    add_drawn_view_options(app, arguments.view);
    add_quality_options(app, arguments);
    add_drawing_options(app, arguments);
    add_environment_options(app, arguments.light);
    add_transfer_options(app, arguments.light);
    add_meso_options(app, arguments);
    add_machine_options(app, arguments);
}

Result<FlyOptions> read_fly_options(const FlyArguments& arguments) {
    FlyOptions options;
    static_cast<FlyArguments&>(options) = arguments;
    const auto size = read_size(options.view);
    if (!size) return size.error();
    options.size = *size;
    if (const Status budgets = read_budgets(options); !budgets) return budgets.error();
    if (!options.network.empty()) {
        const auto shape = NetworkShape::parse(options.network);
        if (!shape) return Error{"--network: " + shape.error().text()};
        options.shape = *shape;
    }
    if (const Status drawing = read_drawing(options); !drawing) return drawing.error();
    const auto relief = read_relief(options.view);
    if (!relief) return relief.error();
    options.relief = *relief;
    if (options.path.empty()) return Error{"--path PATH.csv is required"};
    if (const Status light = check_light(options); !light) return light.error();
    if (options.place.empty() && options.reference.empty()) return Error{"a URL, a .3tz file or a folder is required"};
    return options;
}

RendererOptions renderer_options(const FlyOptions& options) {
    RendererOptions renderer;
    renderer.width = options.size.width;
    renderer.height = options.size.height;
    renderer.gpu_budget_bytes = options.gpu_bytes;
    renderer.index_arena_bytes = options.index_arena_bytes;
    renderer.device = options.device;
    renderer.supersample = options.supersample;
    renderer.validation = options.validation;
    renderer.facade_renderer = options.renderer;
    renderer.facade_samples = options.facade_samples;
    renderer.chart_transport = options.transport;
    renderer.facade_tint = options.tint;
    renderer.meso = options.has_meso();
    renderer.btf_budget_bytes = options.btf_bytes;
    if (!options.btf_texels.empty()) renderer.btf_texels = static_cast<uint32_t>(std::stoul(options.btf_texels));
    if (options.mode == "realtime") renderer.relief_rays = kReliefRaysOfAFrame;
    return renderer;
}

StreamerOptions streamer_options(const FlyOptions& options) {
    StreamerOptions streamer;
    streamer.tolerance_pixels = options.view.tolerance_pixels;
    streamer.texel_tolerance_pixels = options.view.texel_tolerance_pixels;
    streamer.position_tolerance_pixels = options.view.position_tolerance_pixels;
    streamer.host_budget_bytes = options.host_bytes;
    streamer.wait_for_selection = options.mode == "offline";
    streamer.relief = options.relief;
    streamer.occlusion = options.occlusion == "on";
    streamer.facade_form = form_for(options.renderer);
    streamer.facade_boxes = steps_through_boxes(options.renderer);
    if (options.light.asked_for()) {
        const TransferQuality quality = transfer_quality(options.light);
        streamer.light_tolerance = quality.light_tolerance;
        streamer.matrix_form = quality.matrix;
        streamer.matrix_error = quality.matrix_error;
    }
    return streamer;
}

}  // namespace citystream::client
