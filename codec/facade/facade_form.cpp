#include "codec/facade/facade_form.h"

#include <algorithm>
#include <string>

#include "codec/facade/binary_map.h"
#include "codec/facade/max_mip_map.h"
#include "codec/facade/patch_map.h"
#include "codec/facade/quotient_map.h"
#include "codec/facade/raw_map.h"
#include "codec/facade/singular_value_map.h"
#include "codec/facade/tiled_map.h"

namespace citystream::codec::facade {

namespace {

struct FormCalls {
    FacadeForm form;
    std::string_view name;
    Result<std::vector<uint32_t>> (*encode)(const RunGrid&);
    Status (*check)(std::span<const uint32_t>);
    Result<RunGrid> (*decode)(std::span<const uint32_t>);
};

Result<std::vector<uint32_t>> encode_raw_with_boxes(const RunGrid& grid) {
    return encode_raw_map(grid);
}

Result<std::vector<uint32_t>> encode_paper_binary(const RunGrid& grid) {
    return encode_binary_map(grid);
}

constexpr FormCalls kForms[] = {
    {FacadeForm::kPatch, "patch", encode_patch_map, check_patch_map, decode_patch_map},
    {FacadeForm::kQuotient, "quotient", encode_quotient_map, check_quotient_map, decode_quotient_map},
    {FacadeForm::kTiled, "tiled", encode_tiled_map, check_tiled_map, decode_tiled_map},
    {FacadeForm::kRaw, "raw", encode_raw_with_boxes, check_raw_map, decode_raw_map},
    {FacadeForm::kMaxMip, "max-mip", encode_max_mip_map, check_max_mip_map, decode_max_mip_map},
    {FacadeForm::kSvd, "svd", encode_singular_value_map, check_singular_value_map, decode_singular_value_map},
    {FacadeForm::kBinary, "binary", encode_paper_binary, check_binary_map, decode_binary_map},
};
static_assert(std::size(kForms) == kFacadeForms.size());

const FormCalls& calls_of(FacadeForm form) {
    return *std::find_if(std::begin(kForms), std::end(kForms), [&](const FormCalls& f) { return f.form == form; });
}

}  // namespace

std::string_view form_name(FacadeForm form) {
    return calls_of(form).name;
}

std::optional<FacadeForm> form_named(std::string_view name) {
    for (const FormCalls& form : kForms) {
        if (form.name == name) return form.form;
    }
    return std::nullopt;
}

Result<FormHead> read_form_head(std::span<const uint32_t> words) {
    if (words.size() <= FACADE_FORM_WORD_DEPTHS) return Error{"facade map ends in its head", 4 * words.size()};
    const uint32_t first = words[FACADE_FORM_WORD_FORM], form = first >> 16;
    if ((first & 0xffffu) != FACADE_FORM_MAGIC) return Error{"not a facade map", 0};
    if (form < FACADE_FORM_PATCH || form > FACADE_FORM_BINARY)
        return Error{"facade map of unknown form " + std::to_string(form), 2};
    const uint32_t size = words[FACADE_FORM_WORD_SIZE], depths = words[FACADE_FORM_WORD_DEPTHS];
    const FormHead head = {static_cast<FacadeForm>(form), size & 0xffffu, size >> 16,
                           DepthRange{displacement_of(depths), displacement_of(depths >> 16)}};
    if (head.width == 0 || head.height == 0 || head.width > kMaxFacadeSide || head.height > kMaxFacadeSide) {
        return Error{"facade map of " + std::to_string(head.width) + " x " + std::to_string(head.height) +
                         " texels, allowed are 1.." + std::to_string(kMaxFacadeSide),
                     4 * FACADE_FORM_WORD_SIZE};
    }
    if (head.depths.min_mm > head.depths.max_mm || head.depths.min_mm == kOpenDisplacement)
        return Error{"facade map with an impossible range of displacements", 4 * FACADE_FORM_WORD_DEPTHS};
    return head;
}

Result<std::vector<uint32_t>> encode_form(FacadeForm form, const RunGrid& grid) {
    return calls_of(form).encode(grid);
}

Status check_form(std::span<const uint32_t> words) {
    const auto head = read_form_head(words);
    return head ? calls_of(head->form).check(words) : Status(head.error());
}

Result<RunGrid> decode_form(std::span<const uint32_t> words) {
    const auto head = read_form_head(words);
    return head ? calls_of(head->form).decode(words) : Result<RunGrid>(head.error());
}

}  // namespace citystream::codec::facade
