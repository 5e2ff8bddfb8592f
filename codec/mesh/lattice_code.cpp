#include "codec/mesh/lattice_code.h"

#include <algorithm>
#include <bit>

namespace citystream::codec::mesh {

namespace {

constexpr int64_t kCoordinateLimit = int64_t{1} << 30;
/// Places are in 2^-16 grid units.
constexpr int64_t kHalf = 1 << 15;

template <typename Coder>
int64_t code_term(Coder& coder, int64_t term, uint32_t dropped) {
    const auto size = static_cast<uint64_t>(term < 0 ? -term : term) >> dropped;
    const uint32_t width = coder.uniform(63 - dropped, static_cast<uint32_t>(std::bit_width(size)));
    if (width == 0) return 0;
    const uint32_t negative = coder.plain_bits(1, term < 0 ? 1 : 0);
    const uint32_t high_bits = width > 32 ? width - 32 : 0;
    const uint64_t high = coder.plain_bits(high_bits, static_cast<uint32_t>(size >> 32));
    const uint64_t told = high << 32 | coder.plain_bits(width - high_bits, static_cast<uint32_t>(size));
    const auto value = static_cast<int64_t>(told << dropped);
    return negative != 0 ? -value : value;
}

void take_numbers(std::vector<std::vector<LatticeCode::Point>>& rings, const HiddenLattice& lattice) {
    for (auto& ring : rings)
        for (LatticeCode::Point& point : ring) point = lattice.nearest(point);
}

}  // namespace

std::vector<HiddenLattice> LatticeCode::find_lattices(std::vector<std::vector<Point>> rings) {
    std::vector<HiddenLattice> lattices;
    while (lattices.size() < kMostLattices) {
        const auto lattice = find_hidden_lattice(rings);
        if (!lattice) break;
        lattices.push_back(*lattice);
        take_numbers(rings, *lattice);
    }
    return lattices;
}

void LatticeCode::find(std::vector<std::vector<Point>>& rings, uint32_t dropped, KnownLattices* known) {
    if (known != nullptr && known->rings == rings)
        take(known->lattices, dropped);
    else
        take(find_lattices(rings), dropped);
    if (known != nullptr) *known = {rings, lattices_};
    for (const HiddenLattice& lattice : lattices_) take_numbers(rings, lattice);
}

void LatticeCode::take(std::span<const HiddenLattice> found, uint32_t dropped) {
    dropped_ = dropped;
    lattices_.assign(found.begin(), found.end());
}

template <typename Coder>
void LatticeCode::code_lattices(Coder& coder) {
    lattices_.resize(coder.uniform(kMostLattices + 1, static_cast<uint32_t>(lattices_.size())));
    if (!lattices_.empty()) dropped_ = std::min(coder.uniform(32, dropped_), 30u);
    for (HiddenLattice& lattice : lattices_) {
        lattice.reach = std::min(coder.uniform(32, lattice.reach), 30u);
        for (auto& axis : lattice.axes)
            for (size_t k = 0; k < axis.terms.size(); ++k)
                axis.terms[k] = code_term(coder, axis.terms[k], lattice.dropped_bits(k));
    }
}

template <typename Coder>
bool LatticeCode::code_point(Coder& coder, Point number, Point point, Point& told) {
    std::array<Point, kMostLattices + 1> chain = {point};
    if (!Coder::kDecodes)
        for (size_t l = 0; l + 1 < lattices_.size(); ++l) chain[l + 1] = lattices_[l].nearest(chain[l]);
    chain[0] = {point[0] >> dropped_, point[1] >> dropped_};
    for (size_t l = lattices_.size(); l-- > 0;) {
        const HiddenLattice::Place place = lattices_[l].place_of(number);
        for (size_t axis = 0; axis < 2; ++axis) {
            const int64_t at = (place[axis] + kHalf) >> (l == 0 ? dropped_ : 0);
            const auto part = static_cast<uint32_t>(at >> 12 & 15);  // of a grid step
            off_.set_contexts(
                {part, (part >> 2) * 12 + static_cast<uint32_t>(l * 4 + axis), last_off_[axis] * 16 + part});
            const int64_t off = off_.code(coder, chain[l][axis] - (at >> 16));
            last_off_[axis] = std::min(static_cast<uint32_t>(std::bit_width(static_cast<uint64_t>(std::abs(off)))), 5u);
            const int64_t sum = (at >> 16) + off;
            if (std::abs(sum) >= kCoordinateLimit) return false;
            number[axis] = static_cast<int32_t>(sum);
        }
    }
    told = number;
    return true;
}

LatticeCode::Point LatticeCode::nearest_point(Point point) const {
    for (const HiddenLattice& lattice : lattices_) point = lattice.nearest(point);
    for (size_t l = lattices_.size(); l-- > 0;) {
        const HiddenLattice::Place place = lattices_[l].place_of(point);
        for (size_t axis = 0; axis < 2; ++axis) point[axis] = static_cast<int32_t>((place[axis] + kHalf) >> 16);
    }
    return point;
}

double LatticeCode::spacing() const {
    double spacing = 1;
    for (const HiddenLattice& lattice : lattices_) {
        const int64_t least = std::min(lattice.axes[0].terms[1], lattice.axes[1].terms[2]);
        spacing *= static_cast<double>(least) / 4294967296.0;  // 2^32
    }
    return spacing;
}

template void LatticeCode::code_lattices(bits::RangeEncoder&);
template void LatticeCode::code_lattices(bits::RangeDecoder&);
template bool LatticeCode::code_point(bits::RangeEncoder&, Point, Point, Point&);
template bool LatticeCode::code_point(bits::RangeDecoder&, Point, Point, Point&);

}  // namespace citystream::codec::mesh
