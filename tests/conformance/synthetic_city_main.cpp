// citystream-synthetic-city OUT.3tz [LEVELS [SUBTREE_LEVELS [SEED]]]: an archive with a random quadtree, for the
// conformance checks.
#include <cstdio>
#include <cstdlib>

#include "tests/tiles/tileset/synthetic_city.h"

int main(int argc, char** argv) {
    if (argc < 2 || argc > 5) {
        std::fprintf(stderr, "usage: citystream-synthetic-city OUT.3tz [LEVELS [SUBTREE_LEVELS [SEED]]]\n");
        return 2;
    }
    const auto argument = [&](int i, uint32_t otherwise) {
        return argc > i ? static_cast<uint32_t>(std::strtoul(argv[i], nullptr, 10)) : otherwise;
    };
    const uint32_t levels = argument(2, 6);
    const uint32_t subtree_levels = argument(3, 3);
    using namespace citystream::tiles::tileset;
    const SyntheticCity city = make_synthetic_city(argument(4, 1), levels, subtree_levels);
    if (const auto status = write_synthetic_city(city, argv[1]); !status) {
        std::fprintf(stderr, "citystream-synthetic-city: %s\n", status.error().text().c_str());
        return 1;
    }
    return 0;
}
