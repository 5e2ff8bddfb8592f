// The ways to draw facade relief that --facade-renderer chooses from: those of the paper's Table 2, maximum mips, and
// our own.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/render/facade_renderer_layout.h"
#include "codec/facade/facade_form.h"

namespace citystream::client {

enum class FacadeRenderer {
    kPatch,   ///< "patch": marches maps in the form in which they arrive (patch, quotient or tiled); the default
    kMaxMip,  ///< "max-mip": uncompressed, pyramid of maxima
    kRm,      ///< "rm": relief mapping, 20 linear and 6 binary steps, uncompressed
    kFdm,     ///< "fdm": boxes of free space, uncompressed
    kCrm,     ///< "crm": relief mapping on singular value factors
    kBcrm,    ///< "bcrm": relief mapping on binary factors
    kCfdm,    ///< "cfdm": boxes on singular value factors
    kBcfdm,   ///< "bcfdm": boxes on binary factors
};
inline constexpr std::array<FacadeRenderer, 8> kFacadeRenderers = {
    FacadeRenderer::kPatch, FacadeRenderer::kMaxMip, FacadeRenderer::kRm,   FacadeRenderer::kFdm,
    FacadeRenderer::kCrm,   FacadeRenderer::kBcrm,   FacadeRenderer::kCfdm, FacadeRenderer::kBcfdm};

/// What --facade-samples takes: rays of a pixel that covers more than the finest parts of its facade.
inline constexpr std::array<uint32_t, 3> kFacadeSampleCounts = {1, FACADE_SAMPLES, FACADE_MOST_SAMPLES};
/// Where nothing is asked for: one ray through the pixel's centre, as triangles are sampled here and by the reference.
inline constexpr uint32_t kFacadeSamples = 1;
std::vector<std::string> facade_sample_names();
std::optional<uint32_t> facade_samples_named(std::string_view name);

std::string_view facade_renderer_name(FacadeRenderer renderer);
std::optional<FacadeRenderer> facade_renderer_named(std::string_view name);
std::vector<std::string> facade_renderer_names();
/// The form its maps must have; empty: the one in which they arrive. A map that the form refuses is drawn raw by the
/// uncompressed renderer with the same stepper.
std::optional<codec::facade::FacadeForm> form_for(FacadeRenderer renderer);

/// Whether it steps through boxes of free space: raw words for it have them.
constexpr bool steps_through_boxes(FacadeRenderer renderer) {
    return renderer == FacadeRenderer::kFdm || renderer == FacadeRenderer::kCfdm || renderer == FacadeRenderer::kBcfdm;
}

}  // namespace citystream::client
