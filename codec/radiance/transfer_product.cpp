#include "codec/radiance/transfer_product.h"

namespace citystream::codec::radiance {

std::vector<int8_t> dense_quarters(const Transfer& transfer) {
    std::vector<int8_t> dense(size_t{transfer.rows()} * transfer.columns, 0);
    for (uint32_t j = 0; j < transfer.rows(); ++j) {
        for (uint32_t i = transfer.row_begin[j]; i < transfer.row_begin[j + 1]; ++i)
            dense[size_t{j} * transfer.columns + transfer.column[i]] = transfer.quarters[i];
    }
    return dense;
}

}  // namespace citystream::codec::radiance
