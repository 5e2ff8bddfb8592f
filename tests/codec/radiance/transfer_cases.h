// Transfer matrices for the tests of biclusters and of their wires.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "codec/radiance/transfer.h"
#include "tests/codec/radiance/radiance_scenes.h"

namespace citystream::codec::radiance {

/// Of dense rows of quarters.
inline Transfer from_dense(uint32_t columns, const std::vector<std::vector<int>>& rows) {
    Transfer t{columns, {0}, {}, {}};
    for (const auto& row : rows) {
        for (uint32_t k = 0; k < columns; ++k) {
            if (row[k] == 0) continue;
            t.column.push_back(static_cast<uint16_t>(k));
            t.quarters.push_back(static_cast<int8_t>(row[k]));
        }
        t.row_begin.push_back(static_cast<uint32_t>(t.column.size()));
    }
    return t;
}

inline Transfer random_transfer(uint32_t rows, uint32_t columns, uint32_t filled_percent, int values, uint64_t seed) {
    std::mt19937_64 random(seed);
    std::vector<std::vector<int>> dense(rows, std::vector<int>(columns, 0));
    for (auto& row : dense) {
        for (int& v : row) {
            if (random() % 100 >= filled_percent) continue;
            v = 1 + static_cast<int>(random() % static_cast<uint64_t>(values));
            if (random() % 7 == 0) v = -v;
        }
    }
    return from_dense(columns, dense);
}

struct TransferCase {
    std::string name;
    uint32_t local_count;
    Transfer transfer;
};

/// All that is awkward, and small scenes.
inline std::vector<TransferCase> transfer_cases() {
    std::vector<TransferCase> cases;
    const auto add = [&](const char* name, const Transfer& t) { cases.push_back({name, 1, t}); };
    add("no rows", from_dense(6, {}));
    add("nothing seen", from_dense(6, {{0, 0, 0, 0, 0, 0}, {0, 0, 0, 0, 0, 0}}));
    add("one entry", from_dense(6, {{0, 0, 3, 0, 0, 0}}));
    add("all equal", from_dense(4, std::vector<std::vector<int>>(9, {4, 4, 4, 4})));
    std::vector<std::vector<int>> identity(12, std::vector<int>(12, 0)), checks = identity, growing = identity;
    for (int j = 0; j < 12; ++j) {
        for (int k = 0; k < 12; ++k) {
            identity[j][k] = j == k ? 4 : 0;
            checks[j][k] = (j + k) % 2 == 0 ? 4 : 0;
            growing[j][k] = (j * k) % 3 == 0 ? 127 : (j + k) % 5 == 0 ? -127 : 100;
        }
    }
    add("identity", from_dense(12, identity));
    add("checks", from_dense(12, checks));
    add("values at the ends of int8", from_dense(12, growing));
    add("random", random_transfer(30, 40, 40, 4, 1));
    add("random and large", random_transfer(30, 40, 60, 127, 2));
    add("full of noise", random_transfer(60, 30, 100, 4, 3));
    const auto add_scene = [&](const char* name, const VisibilityTile& tile, uint32_t local_side) {
        cases.push_back({name, local_side * local_side, make_transfer(tile, LocalDirections(local_side))});
    };
    add_scene("sphere", open_sphere(24, 8), 4);
    add_scene("city", first_receivers(TowerCity().visibility(32, 8), 150), 4);
    add_scene("turned city", first_receivers(TowerCity().visibility(64, 8, 0.3), 60), 4);
    add_scene("fence", fence(20, 8), 3);
    add_scene("noise", noise(6, 6, 9), 8);
    VisibilityTile doubles = open_sphere(6, 8);
    for (uint32_t r = 0; r < 6; ++r) {
        doubles.frame_of.push_back(doubles.frame_of[r]);
        for (uint32_t w = 0; w < doubles.words_a_receiver(); ++w) doubles.words.push_back(doubles.of(r)[w]);
    }
    add_scene("every receiver twice", doubles, 4);
    add_scene("one direction and six texels", open_sphere(7, 1), 1);
    return cases;
}

}  // namespace citystream::codec::radiance
