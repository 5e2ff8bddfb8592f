#include "tests/bench/haar_rows.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <memory>
#include <numbers>

#include "codec/radiance/source_light.h"
#include "codec/radiance/transfer_product.h"
#include "tests/bench/coded_halves.h"

namespace citystream::bench {

namespace {

using namespace codec::radiance;

/// One level of a square of `across` numbers in rows of `stride`: averages to the front, details behind, along rows and
/// then along columns.
void transform_level(std::span<float> face, uint32_t stride, uint32_t across, std::vector<float>& line) {
    constexpr float kHalf = std::numbers::sqrt2_v<float> / 2;
    for (const bool columns : {false, true}) {
        for (uint32_t i = 0; i < across; ++i) {
            const uint32_t first = columns ? i : i * stride, step = columns ? stride : 1;
            for (uint32_t k = 0; k < across / 2; ++k) {
                const float a = face[first + 2 * k * step], b = face[first + (2 * k + 1) * step];
                line[k] = (a + b) * kHalf;
                line[across / 2 + k] = (a - b) * kHalf;
            }
            for (uint32_t k = 0; k < across; ++k) face[first + k * step] = line[k];
        }
    }
}

/// In place, face by face.
void transform(std::span<float> cube, uint32_t side) {
    std::vector<float> line(side);
    for (uint32_t face = 0; face < kCubeFaces; ++face) {
        const auto square = cube.subspan(size_t{face} * side * side, size_t{side} * side);
        for (uint32_t across = side; across > 1; across /= 2) transform_level(square, side, across, line);
    }
}

struct Terms {
    std::vector<uint32_t> row_begin{0};
    std::vector<uint16_t> number, half;
};

Terms greatest_terms(const Transfer& rows, uint32_t side, uint32_t most) {
    Terms terms;
    std::vector<float> cube(rows.columns);
    std::vector<uint32_t> order;
    for (uint32_t j = 0; j < rows.rows(); ++j) {
        std::fill(cube.begin(), cube.end(), 0.0F);
        for (uint32_t i = rows.row_begin[j]; i < rows.row_begin[j + 1]; ++i)
            cube[rows.column[i]] = kQuarter * rows.quarters[i];
        transform(cube, side);
        order.clear();
        for (uint32_t k = 0; k < cube.size(); ++k) {
            if (cube[k] != 0) order.push_back(k);
        }
        const auto greatest = order.begin() + static_cast<std::ptrdiff_t>(std::min<size_t>(most, order.size()));
        std::partial_sort(order.begin(), greatest, order.end(), [&](uint32_t a, uint32_t b) {
            const float size_a = std::abs(cube[a]), size_b = std::abs(cube[b]);
            return size_a != size_b ? size_a > size_b : a < b;
        });
        std::sort(order.begin(), greatest);
        for (auto k = order.begin(); k != greatest; ++k) {
            terms.number.push_back(static_cast<uint16_t>(*k));
            terms.half.push_back(to_half(cube[*k]));
        }
        terms.row_begin.push_back(static_cast<uint32_t>(terms.number.size()));
    }
    return terms;
}

}  // namespace

IrradianceModel haar_rows(const RadianceSample& sample, uint32_t local_side, uint32_t terms) {
    const uint32_t side = sample.visibility.side;
    assert(std::has_single_bit(side));
    const LocalDirections local(local_side);
    const DistinctRows distinct = distinct_rows(make_transfer(sample.visibility, local));
    const Terms kept = greatest_terms(distinct.rows, side, terms);
    const uint64_t bytes = coded_bytes(kept.number) + coded_bytes(kept.half) + coded_bytes(distinct.row_of);
    const RowProduct product = [side, kept, row_of = distinct.row_of](std::span<const std::array<double, 3>> texels) {
        std::array<std::vector<float>, 3> light;
        for (size_t c = 0; c < 3; ++c) {
            for (const auto& value : texels) light[c].push_back(static_cast<float>(value[c]));
            transform(light[c], side);
        }
        std::vector<std::array<double, 3>> rows(kept.row_begin.size() - 1);
        for (size_t j = 0; j < rows.size(); ++j) {
            for (uint32_t i = kept.row_begin[j]; i < kept.row_begin[j + 1]; ++i) {
                const double value = from_half(kept.half[i]);
                for (size_t c = 0; c < 3; ++c) rows[j][c] += value * light[c][kept.number[i]];
            }
        }
        return spread_rows<double>(row_of, rows);
    };
    return {"haar-" + std::to_string(terms), bytes,
            [side, product, normals = receiver_normals(sample.visibility)](std::span<const Rgb> radiance) {
                return irradiance_by_vectors(normals, radiance, side, product);
            }};
}

}  // namespace citystream::bench
