// The statistics of a flight: one record a frame, a summary, as JSON. client/README.md explains every field.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/render/frame.h"
#include "client/stream/city_streamer.h"
#include "client/stream/fetcher.h"

namespace citystream::client {

/// What lit a frame (client/light); without an environment the name is empty and all is 0.
struct FlightLighting {
    std::string environment;  ///< file or `sky`; of two that fade into each other the one with the greater share
    double share = 0;
    double rotation_degrees = 0;
    double hour = 0;      ///< of the analytic sky
    double exposure = 0;  ///< factor on radiance
    uint64_t number = 0;  ///< of the sky: light passes run where it changes
};

struct FlightFrame {
    uint64_t index = 0;
    double t = 0;  ///< seconds of the path
    StreamerFrame stream;
    FrameTimings timings;
    FrameCounts counts;
    FlightLighting lighting;
    double total_ms = 0;  ///< update and drawing
};

/// What was flown, and with what.
struct FlightDescription {
    std::string place, path, mode, device, network;
    std::string facade_renderer, map_level, chart_transport, facade_tint;  ///< as chosen by name
    double relief_tolerance_pixels = 0, texel_tolerance_pixels = 0, position_tolerance_pixels = 0;
    std::string environment, environment_path, matrix;  ///< empty without light
    double light_tolerance = 0;                         ///< relative radiance; 0 without light
    double matrix_error = 0;                            ///< the same, of rows
    bool meso = false;                                  ///< relief shades itself
    uint32_t facade_samples = 1;
    bool occlusion = true;
    uint32_t width = 0, height = 0;
    double tolerance_pixels = 0, frames_per_second = 0;
    uint64_t gpu_budget_bytes = 0, host_budget_bytes = 0;
};

struct FlightTotals {
    FetcherStatistics fetcher;
    uint64_t frame_buffer_bytes = 0, gpu_bytes_allocated = 0, validation_messages = 0;
    bool stopped_early = false;
    bool facade_pipeline = false;    ///< the renderer made one
    bool radiance_pipeline = false;  ///< the same of what light needs
};

/// Nearest-rank percentile (0..100) of values in any order; 0 of none.
double percentile(std::vector<double> values, double rank);

class FlightStatistics {
  public:
    explicit FlightStatistics(FlightDescription description) : description_(std::move(description)) {}
    /// Keeps the frame; its warnings are collected once each.
    void add(FlightFrame frame);
    const std::vector<FlightFrame>& frames() const { return frames_; }
    const std::vector<std::string>& warnings() const { return warnings_; }
    uint64_t gpu_bytes_max() const;
    uint64_t host_bytes_max() const;
    std::string json(const FlightTotals& totals) const;          ///< everything
    std::string summary_json(const FlightTotals& totals) const;  ///< without the frames

  private:
    FlightDescription description_;
    std::vector<FlightFrame> frames_;
    std::vector<std::string> warnings_;
};

}  // namespace citystream::client
