// The resident forms of a facade map: what random access and ray casting read, in GPU memory as in tests. All are
// exact. A city carries patch, quotient or tiled maps (facade_wire.h); the others are made where a renderer asks for
// them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "codec/facade/facade_form_layout.h"
#include "codec/facade/run_grid.h"
#include "codec/result.h"

namespace citystream::codec::facade {

enum class FacadeForm : uint32_t {
    kPatch = FACADE_FORM_PATCH,        ///< bands of stripes of patches (patch_map.h)
    kQuotient = FACADE_FORM_QUOTIENT,  ///< distinct rows x distinct columns (quotient_map.h)
    kTiled = FACADE_FORM_TILED,        ///< quotient in pooled tiles (tiled_map.h)
    kRaw = FACADE_FORM_RAW,            ///< plain D, M and box index A (raw_map.h)
    kMaxMip = FACADE_FORM_MAX_MIP,     ///< plain D and M with a pyramid of maxima (max_mip_map.h)
    kSvd = FACADE_FORM_SVD,            ///< singular value factors of D, M and A (singular_value_map.h)
    kBinary = FACADE_FORM_BINARY,      ///< binary factors of D, M and A (binary_map.h)
};
inline constexpr std::array<FacadeForm, 7> kFacadeForms = {
    FacadeForm::kPatch,  FacadeForm::kQuotient, FacadeForm::kTiled, FacadeForm::kRaw,
    FacadeForm::kMaxMip, FacadeForm::kSvd,      FacadeForm::kBinary};

/// "patch", "quotient", "tiled", "raw", "max-mip", "svd", "binary".
std::string_view form_name(FacadeForm form);
std::optional<FacadeForm> form_named(std::string_view name);

/// What every form's head says.
struct FormHead {
    FacadeForm form = FacadeForm::kPatch;
    uint32_t width = 0, height = 0;  ///< texels
    DepthRange depths;
};
Result<FormHead> read_form_head(std::span<const uint32_t> words);

/// Encodes. Fails, saying why, where the form does not pay (svd and binary refuse what would be larger than raw).
Result<std::vector<uint32_t>> encode_form(FacadeForm form, const RunGrid& grid);

/// Checks all that lookups and ray casting rely on: afterwards no reader leaves the words. For untrusted bytes.
Status check_form(std::span<const uint32_t> words);

/// Checks and decodes any form, to the coarsest grid.
Result<RunGrid> decode_form(std::span<const uint32_t> words);

}  // namespace citystream::codec::facade
