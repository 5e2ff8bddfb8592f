#include "client/render/facade_shaders.h"

#include <array>

#include "client/render/facade_renderer_layout.h"
#include "shaders/facade_bcfdm.frag.h"
#include "shaders/facade_bcfdm.vert.h"
#include "shaders/facade_bcrm.frag.h"
#include "shaders/facade_bcrm.vert.h"
#include "shaders/facade_cfdm.frag.h"
#include "shaders/facade_cfdm.vert.h"
#include "shaders/facade_crm.frag.h"
#include "shaders/facade_crm.vert.h"
#include "shaders/facade_fdm.frag.h"
#include "shaders/facade_fdm.vert.h"
#include "shaders/facade_keyed_bcfdm.frag.h"
#include "shaders/facade_keyed_bcrm.frag.h"
#include "shaders/facade_keyed_cfdm.frag.h"
#include "shaders/facade_keyed_crm.frag.h"
#include "shaders/facade_keyed_fdm.frag.h"
#include "shaders/facade_keyed_lit_bcfdm.frag.h"
#include "shaders/facade_keyed_lit_bcrm.frag.h"
#include "shaders/facade_keyed_lit_cfdm.frag.h"
#include "shaders/facade_keyed_lit_crm.frag.h"
#include "shaders/facade_keyed_lit_fdm.frag.h"
#include "shaders/facade_keyed_lit_max_mip.frag.h"
#include "shaders/facade_keyed_lit_patch.frag.h"
#include "shaders/facade_keyed_lit_quotient.frag.h"
#include "shaders/facade_keyed_lit_rm.frag.h"
#include "shaders/facade_keyed_max_mip.frag.h"
#include "shaders/facade_keyed_patch.frag.h"
#include "shaders/facade_keyed_quotient.frag.h"
#include "shaders/facade_keyed_rm.frag.h"
#include "shaders/facade_lit_bcfdm.frag.h"
#include "shaders/facade_lit_bcfdm.vert.h"
#include "shaders/facade_lit_bcrm.frag.h"
#include "shaders/facade_lit_bcrm.vert.h"
#include "shaders/facade_lit_cfdm.frag.h"
#include "shaders/facade_lit_cfdm.vert.h"
#include "shaders/facade_lit_crm.frag.h"
#include "shaders/facade_lit_crm.vert.h"
#include "shaders/facade_lit_fdm.frag.h"
#include "shaders/facade_lit_fdm.vert.h"
#include "shaders/facade_lit_max_mip.frag.h"
#include "shaders/facade_lit_max_mip.vert.h"
#include "shaders/facade_lit_patch.frag.h"
#include "shaders/facade_lit_patch.vert.h"
#include "shaders/facade_lit_quotient.frag.h"
#include "shaders/facade_lit_quotient.vert.h"
#include "shaders/facade_lit_rm.frag.h"
#include "shaders/facade_lit_rm.vert.h"
#include "shaders/facade_max_mip.frag.h"
#include "shaders/facade_max_mip.vert.h"
#include "shaders/facade_patch.frag.h"
#include "shaders/facade_patch.vert.h"
#include "shaders/facade_quotient.frag.h"
#include "shaders/facade_quotient.vert.h"
#include "shaders/facade_rm.frag.h"
#include "shaders/facade_rm.vert.h"

namespace citystream::client {

FacadeShaders facade_shaders(uint32_t caster, bool lit) {
    static const std::array<FacadeShaders, FACADE_RENDERER_COUNT> shaders = {{
        {k_facade_patch_vert, k_facade_patch_frag, k_facade_keyed_patch_frag},
        {k_facade_max_mip_vert, k_facade_max_mip_frag, k_facade_keyed_max_mip_frag},
        {k_facade_rm_vert, k_facade_rm_frag, k_facade_keyed_rm_frag},
        {k_facade_fdm_vert, k_facade_fdm_frag, k_facade_keyed_fdm_frag},
        {k_facade_crm_vert, k_facade_crm_frag, k_facade_keyed_crm_frag},
        {k_facade_bcrm_vert, k_facade_bcrm_frag, k_facade_keyed_bcrm_frag},
        {k_facade_cfdm_vert, k_facade_cfdm_frag, k_facade_keyed_cfdm_frag},
        {k_facade_bcfdm_vert, k_facade_bcfdm_frag, k_facade_keyed_bcfdm_frag},
        {k_facade_quotient_vert, k_facade_quotient_frag, k_facade_keyed_quotient_frag},
    }};
    static const std::array<FacadeShaders, FACADE_RENDERER_COUNT> lit_shaders = {{
        {k_facade_lit_patch_vert, k_facade_lit_patch_frag, k_facade_keyed_lit_patch_frag},
        {k_facade_lit_max_mip_vert, k_facade_lit_max_mip_frag, k_facade_keyed_lit_max_mip_frag},
        {k_facade_lit_rm_vert, k_facade_lit_rm_frag, k_facade_keyed_lit_rm_frag},
        {k_facade_lit_fdm_vert, k_facade_lit_fdm_frag, k_facade_keyed_lit_fdm_frag},
        {k_facade_lit_crm_vert, k_facade_lit_crm_frag, k_facade_keyed_lit_crm_frag},
        {k_facade_lit_bcrm_vert, k_facade_lit_bcrm_frag, k_facade_keyed_lit_bcrm_frag},
        {k_facade_lit_cfdm_vert, k_facade_lit_cfdm_frag, k_facade_keyed_lit_cfdm_frag},
        {k_facade_lit_bcfdm_vert, k_facade_lit_bcfdm_frag, k_facade_keyed_lit_bcfdm_frag},
        {k_facade_lit_quotient_vert, k_facade_lit_quotient_frag, k_facade_keyed_lit_quotient_frag},
    }};
    return lit ? lit_shaders[caster] : shaders[caster];
}

}  // namespace citystream::client
