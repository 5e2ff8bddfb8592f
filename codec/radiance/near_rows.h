// A matrix that may miss each row by a stated bound: what a row's error is counted in, and rows that are nearly the
// same made the same. Neighbouring receivers see nearly the same, so this leaves far fewer rows; what a row then has
// left of its bound goes to residuals of the search (bicluster.h).
//
// A quarter q left out at row j and texel k changes the row's light by q / 4 L_k (Sun et al. 2011, equation 2), L_k
// being radiance times solid angle dw_k. So with no texel of more than radiance R a row is wrong by at most
//   R sum over k of |q_k| / 4 dw_k.
// A *row error* X bounds this sum by X 2 pi / M: by the part X of what a local direction gets from an even sky of
// radiance R when nothing stands around it, M of them sharing the hemisphere. So the light of all rows of a receiver is
// wrong by at most X of that sky's, as by a layer's steps of this error (radiance_layer.h).
//
// Quarters are only ever left out, never added: a row keeps 0 to all of what it sees of a texel. So light does not leak
// into what lies in the shadow however bright a texel is, and no sum grows beyond what whole light has room for
// (source_light.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/radiance/transfer.h"

namespace citystream::codec::radiance {

/// A row error in whole numbers: units of a 256th of the greatest texel's quarter.
struct RowBound {
    std::vector<uint32_t> weights;  ///< of each texel: units that a quarter of it takes, rounded up
    uint32_t most = 0;              ///< units by which a row may be wrong
    double unit = 0;                ///< row error that one of them is
};
/// `side`: source texels on a side. `local_count`: M. `row_error`: 0..1; others are taken for the nearest of these.
RowBound row_bound(uint32_t side, uint32_t local_count, double row_error);

struct NearRows {
    DistinctRows distinct;         ///< of the same whole
    std::vector<uint32_t> missed;  ///< of each row: units that the rows it stands for have more than it, the most
    uint64_t quarters = 0;         ///< that rows have more than what stands for them, each distinct row once
};
/// Each row in turn joins one of the last 256 groups before it that began with a row first used by the same local
/// direction, or begins one. A group keeps what all its rows have, none of which may miss it by more than the bound; of
/// the groups that can take a row it joins the one which that costs the fewest units. Deterministic. 2 us a distinct
/// row.
NearRows merge_near_rows(const DistinctRows& distinct, uint32_t local_count, const RowBound& bound);

}  // namespace citystream::codec::radiance
