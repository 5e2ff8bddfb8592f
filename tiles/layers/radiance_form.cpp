#include "tiles/layers/radiance_form.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace citystream::tiles::layers {

bool radiance_can_be_built() {
#ifdef CITYSTREAM_HAS_EMBREE
    return true;
#else
    return false;
#endif
}

Status check_radiance_form(const RadianceForm& form) {
    if (!radiance_can_be_built())
        return Error{"this citystream-build was made without Embree, which bakes the radiance layer"};
    const uint32_t metres = form.lattice_metres;
    if (!std::has_single_bit(metres) || metres > kMostLatticeMetres)
        return Error{fmt::format("a lattice of {} m; it is 1, 2, 4, 8 or {} m", metres, kMostLatticeMetres)};
    if (form.texels_across < 1 || form.texels_across > codec::radiance::kMostCubeSide)
        return Error{fmt::format("{} source directions across; 1 to {} are possible", form.texels_across,
                                 codec::radiance::kMostCubeSide)};
    if (form.local_across < 1 || form.local_across > codec::radiance::kMostLocalSide)
        return Error{fmt::format("{} local directions across; 1 to {} are possible", form.local_across,
                                 codec::radiance::kMostLocalSide)};
    if (!(form.error >= 0 && form.error <= 1))
        return Error{fmt::format("a radiance error of {}; 0 to 1 is possible", form.error)};
    return Done{};
}

std::string to_string(const RadianceForm& form) {
    std::string text = fmt::format(" lattice={}m directions={} local-directions={}", form.lattice_metres,
                                   form.texels_across, form.local_across);
    if (form.error > 0) text += fmt::format(" radiance-error={}", form.error);
    if (form.transport != RadianceForm().transport)
        text += fmt::format(" radiance-transport={}", name_of(form.transport));
    return text;
}

uint32_t lattice_of_tile(const RadianceForm& form, uint64_t side_metres, bool leaf) {
    if (side_metres > kWidestRadianceTileMetres) return 0;
    const auto least = static_cast<uint32_t>(std::min<uint64_t>(side_metres / kLatticeColumns, kWidestLatticeMetres));
    return std::max(leaf ? form.lattice_metres : 2 * form.lattice_metres, least);
}

}  // namespace citystream::tiles::layers
