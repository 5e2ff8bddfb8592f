// The chart in pages that a corner of a mesh triangle shows, and its place in it, by the transport that the pipeline is made for
// (client/render/chart_transport.h). Made on the CPU: client/render/chart_coordinates.h.
#ifndef CITYSTREAM_PAGE_CORNER_GLSL
#define CITYSTREAM_PAGE_CORNER_GLSL

#include "shaders/mesh_corner.glsl"
#include "shaders/page_chart.glsl"

struct PageCorner {
    PageSurface surface;
    vec2 place;  // repeats
};

PageCorner corner_by_table(Pages pages, uvec2 mesh, MeshDrawConstants draw, MeshCorner shown) {
    uint chart_word = layer_word(mesh, shown.chart_entry + RESIDENT_CHART_WORD);
    if ((chart_word & CHART_WORD_COLOUR) != 0u) return PageCorner(surface_of_word(pages, chart_word), vec2(0.0));
    PagedChart chart = paged_chart(pages, chart_word);
    bvec2 repeats = bvec2((chart.flags & PAGES_CHART_REPEAT_U) != 0u, (chart.flags & PAGES_CHART_REPEAT_V) != 0u);
    return PageCorner(surface_of(pages, chart), mesh_place(mesh, draw, shown, repeats));
}

PageCorner corner_by_uniform(Pages pages, uvec2 mesh, MeshDrawConstants draw, MeshCorner shown) {
    uvec2 words = uvec2(constants.tile.shared_charts[0], constants.tile.shared_charts[1]);
    uint flags = words.y & WRAP_PLACE_MASK;
    PagedChart chart = PagedChart(flags | (words.x & WRAP_PLACE_MASK) << 16, words.x, words.y);
    bvec2 repeats = bvec2((flags & PAGES_CHART_REPEAT_U) != 0u, (flags & PAGES_CHART_REPEAT_V) != 0u);
    return PageCorner(surface_of(pages, chart), mesh_place(mesh, draw, shown, repeats));
}

// `corner`: of all ranges.
PageCorner corner_by_attribute(Pages pages, uvec2 mesh, MeshDrawConstants draw, uint corner, MeshCorner shown) {
    vec4 frame = uintBitsToFloat(layer_words4(layer_reference(constants.tile.shared_charts), corner));
    if (frame.z == 0.0) return PageCorner(flat_surface(uint(frame.x)), vec2(0.0));
    uint page = uint(frame.x) / uint(COORDINATE_PAGE_STEP);
    vec2 place = mesh_place(mesh, draw, shown, greaterThan(frame.zw, vec2(0.0)));
    frame.x -= float(page * uint(COORDINATE_PAGE_STEP));
    return PageCorner(page_surface(pages, page, frame), place);
}

PageCorner corner_by_packed(Pages pages, uint corner) {
    uvec2 layer = layer_reference(constants.tile.shared_charts);
    uint triangle = corner / 3u;
    uint first = triangle * uint(COORDINATE_TRIANGLE_WORDS);
    uint word = first + 1u + 2u * (corner - 3u * triangle);
    PagedChart chart = PagedChart(layer_word(layer, first), layer_word(layer, word), layer_word(layer, word + 1u));
    return PageCorner(surface_of(pages, chart), wrap_place(uvec2(chart.u, chart.v)));
}

// Precondition: has_atlas(), and it is in pages.
PageCorner page_corner(uvec2 mesh, MeshDrawConstants draw, uint corner, MeshCorner shown) {
    Pages pages = pages_of(layer_reference(constants.tile.atlas));
    if (kTransport == CHART_TRANSPORT_TABLE) return corner_by_table(pages, mesh, draw, shown);
    if (kTransport == CHART_TRANSPORT_UNIFORM) return corner_by_uniform(pages, mesh, draw, shown);
    uint of_all = 3u * draw.first_triangle + corner;
    if (kTransport == CHART_TRANSPORT_ATTRIBUTE) return corner_by_attribute(pages, mesh, draw, of_all, shown);
    return corner_by_packed(pages, of_all);
}

#endif
