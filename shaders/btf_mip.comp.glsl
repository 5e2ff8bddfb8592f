#version 460
// Makes one mip of a BTF from the finer one (codec/radiance/btf.h): a thread a word of a record, or the coverage of four records.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/btf_words.glsl"

// First texel of a mip in its view.
uint first_of(Btf btf, uint mip) { return ((4u << (2u * btf.patch_log2)) - (4u << (2u * (btf.patch_log2 - mip)))) / 3u; }

// Record k of the four that a record is made from.
uint finer_record(Btf btf, uint view, uint texel, uint k) {
    uint side_log2 = btf.patch_log2 - constants.mip;
    uint x = 2u * (texel & ((1u << side_log2) - 1u)) + (k & 1u);
    uint y = 2u * (texel >> side_log2) + (k >> 1);
    return view * btf.texels_a_view + first_of(btf, constants.mip - 1u) + (y << (side_log2 + 1u)) + x;
}

uint coverage_byte(Btf btf, uint record) {
    if (btf.coverage == 0u) return 255u;
    return layer_word(btf.layer, btf.coverage + (record >> 2)) >> (8u * (record & 3u)) & 255u;
}

uint record_word(Btf btf, uint record, uint word) { return layer_word(btf.layer, btf.records + record * uint(BTF_RECORD_WORDS) + word); }

uvec4 bytes_of(uint word) { return uvec4(word, word >> 8, word >> 16, word >> 24) & 255u; }

// Rounded up from a half or from three quarters in turns: the mean of many stays as it is.
uvec4 mean_light(Btf btf, uvec4 finer, uint word) {
    uvec4 sum = uvec4(0u);
    uint covered = 0u;
    for (uint k = 0u; k < 4u; ++k) {
        uint share = coverage_byte(btf, finer[k]);
        sum += share * bytes_of(record_word(btf, finer[k], word));
        covered += share;
    }
    return covered == 0u ? uvec4(0u) : (4u * sum + covered * uvec4(1u, 2u, 1u, 2u)) / (4u * covered);
}

// By all light of each.
uvec4 mean_slots(Btf btf, uvec4 finer, uint word) {
    uvec4 sum = uvec4(0u);
    uint all_light = 0u;
    for (uint k = 0u; k < 4u; ++k) {
        uint light = 1u;
        for (uint i = 0u; i < uint(BTF_RECORD_SLOTS); ++i) {
            uvec4 bytes = bytes_of(record_word(btf, finer[k], i));
            light += bytes.x + bytes.y + bytes.z + bytes.w;
        }
        light *= coverage_byte(btf, finer[k]);
        sum += light * bytes_of(record_word(btf, finer[k], word));
        all_light += light;
    }
    return all_light == 0u ? uvec4(0u) : (sum + all_light / 2u) / all_light;
}

void make_record_word(Btf btf, uint view, uint texel, uint word) {
    uvec4 finer;
    for (uint k = 0u; k < 4u; ++k) finer[k] = finer_record(btf, view, texel, k);
    uvec4 bytes = word < uint(BTF_RECORD_SLOTS) ? mean_light(btf, finer, word) : mean_slots(btf, finer, word);
    uint record = view * btf.texels_a_view + first_of(btf, constants.mip) + texel;
    write_word(btf.records + record * uint(BTF_RECORD_WORDS) + word, packed(bytes));
}

void make_coverage_word(Btf btf, uint view, uint first_texel, uint texels) {
    uint value = 0u;
    for (uint i = 0u; i < min(4u, texels - first_texel); ++i) {
        uint covered = 0u;
        for (uint k = 0u; k < 4u; ++k) covered += coverage_byte(btf, finer_record(btf, view, first_texel + i, k));
        value |= (covered + 2u >> 2) << (8u * i);
    }
    write_word(btf.coverage + (view * btf.texels_a_view + first_of(btf, constants.mip) + first_texel >> 2), value);
}

void main() {
    uint group = gl_WorkGroupID.y * uint(RELIEF_PASS_ROW_GROUPS) + gl_WorkGroupID.x;
    if (group >= constants.groups) return;
    Btf btf = btf_at(layer_reference(constants.btf));
    uint item = group * uint(BTF_GROUP) + gl_LocalInvocationID.x;
    uint views = btf.views_across * btf.views_across;
    uint texels = 1u << (2u * (btf.patch_log2 - constants.mip));
    uint words_a_view = texels * uint(BTF_RECORD_WORDS);
    if (item < views * words_a_view) {
        uint record = item / uint(BTF_RECORD_WORDS);
        make_record_word(btf, record / texels, record % texels, item % uint(BTF_RECORD_WORDS));
        return;
    }
    item -= views * words_a_view;
    uint fours = (texels + 3u) / 4u;
    if (btf.coverage != 0u && item < views * fours) make_coverage_word(btf, item / fours, 4u * (item % fours), texels);
}
