#include "client/render/relief_shaders.h"

#include <array>

#include "client/render/facade_renderer_layout.h"
#include "shaders/btf_bcfdm.comp.h"
#include "shaders/btf_bcrm.comp.h"
#include "shaders/btf_cfdm.comp.h"
#include "shaders/btf_crm.comp.h"
#include "shaders/btf_fdm.comp.h"
#include "shaders/btf_max_mip.comp.h"
#include "shaders/btf_patch.comp.h"
#include "shaders/btf_quotient.comp.h"
#include "shaders/btf_rm.comp.h"
#include "shaders/relief_mask_bcfdm.comp.h"
#include "shaders/relief_mask_bcrm.comp.h"
#include "shaders/relief_mask_cfdm.comp.h"
#include "shaders/relief_mask_crm.comp.h"
#include "shaders/relief_mask_fdm.comp.h"
#include "shaders/relief_mask_max_mip.comp.h"
#include "shaders/relief_mask_patch.comp.h"
#include "shaders/relief_mask_quotient.comp.h"
#include "shaders/relief_mask_rm.comp.h"

namespace citystream::client {
namespace {

// In the order of facade_renderer_layout.h.
const std::array<ReliefShaders, FACADE_RENDERER_COUNT> kShaders = {{
    {k_relief_mask_patch_comp, k_btf_patch_comp},
    {k_relief_mask_max_mip_comp, k_btf_max_mip_comp},
    {k_relief_mask_rm_comp, k_btf_rm_comp},
    {k_relief_mask_fdm_comp, k_btf_fdm_comp},
    {k_relief_mask_crm_comp, k_btf_crm_comp},
    {k_relief_mask_bcrm_comp, k_btf_bcrm_comp},
    {k_relief_mask_cfdm_comp, k_btf_cfdm_comp},
    {k_relief_mask_bcfdm_comp, k_btf_bcfdm_comp},
    {k_relief_mask_quotient_comp, k_btf_quotient_comp},
}};

}  // namespace

ReliefShaders relief_shaders(uint32_t caster) {
    return kShaders[caster];
}

}  // namespace citystream::client
