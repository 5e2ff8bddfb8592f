// Flies a city once per setting of a knob and measures what each setting costs and how far its pictures are from the
// reference.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "client/light/flight_light.h"
#include "client/path/camera_path.h"
#include "client/render/facade_renderer.h"
#include "client/render/frame.h"
#include "client/report/image_metrics.h"
#include "client/report/radiance_cost.h"
#include "client/select/facade_dictionary.h"
#include "codec/radiance/radiance_layer.h"
#include "codec/result.h"

namespace citystream::client {

/// One setting of one knob; all others stay at the defaults of SweepOptions.
struct Setting {
    /// "tolerance", "relief-tolerance", "texel-tolerance" or "position-tolerance" (pixels), "gpu-budget" (MiB),
    /// "map-level", "facade-renderer" or "facade-samples" (names as citystream-fly takes them); of light
    /// "light-tolerance" and "matrix-error" (relative radiance), "matrix" (a name as citystream-fly takes it); of the
    /// archive that is flown "saliency" (a name as citystream-build takes it), "rate-distortion" and "normal-bits"
    /// (numbers), "mesh-transport", "mesh-topology", "precision", "mesh-steps" and "radiance-transport" (names as
    /// citystream-build takes them), "lattice" (metres), "directions" and "local-directions" (on a side), "archive" (a
    /// name of its own).
    std::string knob;
    double value = 0;   ///< of a knob that has numbers
    std::string name;   ///< of a knob that has names
    std::string place;  ///< of the archive; empty: SweepOptions::city
    bool is_named() const { return !name.empty(); }
    /// "1.5 px", "64 MiB", "4 m", "16", "fdm".
    std::string label() const;
    /// The value or the name as the programs' options take it: "1.5", "fdm".
    std::string value_text() const;
    /// Knob and value, as part of file names.
    std::string file_prefix() const;
    /// What is joined by a line in plots: the knob, and of saliency its metric. Empty: of all metrics (saliency none).
    std::string series() const;
};

/// Whether a knob makes sense of lit frames alone.
bool is_of_light(const std::string& knob);

struct SweepOptions {
    std::string city;       ///< any place that Fetcher::open takes
    std::string reference;  ///< .glb of the same city
    CameraPath path;
    uint32_t frames = 8;  ///< cameras, evenly spaced in time along the path
    uint32_t width = 1280, height = 720;
    uint32_t supersample = 1;
    double tolerance_pixels = 1;
    std::optional<double> texel_tolerance_pixels, position_tolerance_pixels;
    ReliefOptions relief;
    FacadeRenderer facade_renderer = FacadeRenderer::kPatch;
    uint32_t facade_samples = kFacadeSamples;
    uint64_t gpu_budget_bytes = 512ull << 20;
    uint64_t host_budget_bytes = 1ull << 30;
    FlightLight* light = nullptr;  ///< lights all settings; null: frames are lit by lighting_layout.h
    std::string environment;       ///< what the light is, for people
    double light_tolerance = kUsualLightTolerance;
    codec::radiance::MatrixForm matrix = codec::radiance::MatrixForm::kBiclusters;
    double matrix_error = 0;
    uint32_t reference_rays = 256;  ///< of a pixel of what lit frames are compared with, at least
    std::string device;
    std::string picture_folder;  ///< frames, references and FLIP maps are written here as PNG
    std::function<void(const std::string& line)> progress;
};

struct FrameRow {
    uint32_t frame = 0;
    double t = 0;
    double gpu_ms = 0, facade_ms = 0, select_ms = 0, decode_ms = 0;  ///< facade_ms: of gpu_ms
    uint64_t wire_bytes = 0;                                         ///< fetched for this frame
    uint64_t dictionary_bytes = 0;                                   ///< of wire_bytes: facade index and maps
    uint64_t atlas_bytes = 0;                                        ///< of wire_bytes: all that pictures take
    uint64_t mesh_bytes = 0;                                         ///< of wire_bytes
    uint64_t gpu_bytes = 0;                                          ///< layer slots in use
    /// Of lit frames: passes over all tiles drawn, as after a change of the light, which gpu_ms has not in it; the
    /// sun's shadow maps; decoding, all cores together.
    double light_ms = 0, shadow_ms = 0, light_decode_ms = 0;
    uint64_t radiance_bytes = 0;      ///< of wire_bytes
    uint64_t radiance_gpu_bytes = 0;  ///< of layers in GPU memory
    uint64_t receivers = 0;           ///< of tiles drawn
    double row_error = 0;             ///< of the worst row decoded: relative radiance
    uint64_t tiles = 0, relief_tiles = 0;
    double tolerance_used = 0, achieved_error_pixels = 0;
    double position_error_pixels = 0;  ///< of achieved_error_pixels: for want of low bits of positions
    double position_bits = 0;          ///< of a coordinate, average of triangles drawn
    ImageDifference difference;
    std::string picture;  ///< file name in picture_folder
    std::string flip_picture;
};

struct SettingResult {
    Setting setting;
    std::vector<FrameRow> frames;
    std::string build_options;  ///< of the city, as its manifest says
    uint64_t total_wire_bytes = 0, total_dictionary_bytes = 0, total_atlas_bytes = 0, total_mesh_bytes = 0;
    uint64_t total_radiance_bytes = 0;
    uint64_t largest_gpu_bytes = 0, largest_radiance_gpu_bytes = 0;
    std::optional<RadianceCost> radiance;  ///< of the archive, where frames are lit and it has the layer
    std::vector<std::string> warnings;
};

struct SweepResult {
    std::string device, reference_device;
    std::vector<std::string> reference_pictures;  ///< by frame
    std::vector<double> reference_ms;
    uint64_t reference_gpu_bytes = 0;
    std::vector<uint64_t> reference_triangles;
    bool lit = false;
    std::string environment;               ///< as in SweepOptions
    uint32_t rays_a_pixel = 0;             ///< of references of lit frames
    std::optional<RadianceCost> radiance;  ///< of the city, as in SettingResult
    std::vector<SettingResult> settings;
};

/// Draws the reference (lit: lit_reference.h, with the exposure that all settings then take) once per camera, then
/// every setting from a cold start (new connection, empty caches), offline, so that bytes and pictures repeat exactly.
Result<SweepResult> run_sweep(const SweepOptions& options, const std::vector<Setting>& settings);

/// Median of a column; 0 for no frames.
double median_of(const std::vector<FrameRow>& frames, const std::function<double(const FrameRow&)>& column);

}  // namespace citystream::client
