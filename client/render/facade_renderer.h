// The ways to draw facade relief that --facade-renderer chooses from: those of the paper's Table 2, maximum mips, and
// our own.
#pragma once

#include <array>
#include <optional>
#include <string_view>

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

std::string_view facade_renderer_name(FacadeRenderer renderer);
std::optional<FacadeRenderer> facade_renderer_named(std::string_view name);
/// The form its maps must have; empty: the one in which they arrive. A map that the form refuses is drawn raw by the
/// uncompressed renderer with the same stepper.
std::optional<codec::facade::FacadeForm> form_for(FacadeRenderer renderer);

/// Whether it steps through boxes of free space: raw words for it have them.
constexpr bool steps_through_boxes(FacadeRenderer renderer) {
    return renderer == FacadeRenderer::kFdm || renderer == FacadeRenderer::kCfdm || renderer == FacadeRenderer::kBcfdm;
}

}  // namespace citystream::client
