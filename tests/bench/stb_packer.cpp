#include "tests/bench/stb_packer.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_RECT_PACK_IMPLEMENTATION
#define STBRP_STATIC
#include <stb/stb_rect_pack.h>
#pragma GCC diagnostic pop

namespace citystream::bench {

std::vector<codec::atlas::Rectangle> pack_with_stb(std::span<const codec::atlas::RectangleSize> sizes,
                                                   codec::atlas::RectangleSize bin, StbHeuristic heuristic) {
    std::vector<stbrp_rect> rectangles(sizes.size());
    for (size_t i = 0; i < sizes.size(); ++i) {
        rectangles[i].id = static_cast<int>(i);
        rectangles[i].w = static_cast<int>(sizes[i].width);
        rectangles[i].h = static_cast<int>(sizes[i].height);
    }
    stbrp_context context;
    std::vector<stbrp_node> nodes(bin.width);
    stbrp_init_target(&context, static_cast<int>(bin.width), static_cast<int>(bin.height), nodes.data(),
                      static_cast<int>(nodes.size()));
    stbrp_setup_heuristic(&context, heuristic == StbHeuristic::kBestFit ? STBRP_HEURISTIC_Skyline_BF_sortHeight
                                                                        : STBRP_HEURISTIC_Skyline_BL_sortHeight);
    stbrp_pack_rects(&context, rectangles.data(), static_cast<int>(rectangles.size()));
    std::vector<codec::atlas::Rectangle> places(sizes.size());
    for (const stbrp_rect& rectangle : rectangles) {
        if (rectangle.was_packed == 0) continue;
        places[static_cast<size_t>(rectangle.id)] = {
            static_cast<uint32_t>(rectangle.x), static_cast<uint32_t>(rectangle.y), static_cast<uint32_t>(rectangle.w),
            static_cast<uint32_t>(rectangle.h)};
    }
    return places;
}

}  // namespace citystream::bench
