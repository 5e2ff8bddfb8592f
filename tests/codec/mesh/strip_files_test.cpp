// The strip codes on the meshes of ../shared/data.
#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <string>

#include "codec/mesh/local_strips.h"
#include "codec/mesh/strip_code.h"
#include "tests/codec/mesh/topology_meshes.h"
#include "tiles/city/text_source.h"

namespace citystream::codec::mesh {
namespace {

namespace city = tiles::city;

const std::string kMeshes = CITYSTREAM_SOURCE_DIR "/../shared/data/meshes/";

/// The vertex numbers of a line "f v/t/n v/t/n ...", from 0.
std::vector<uint32_t> face_of(std::string_view line) {
    std::vector<uint32_t> vertices;
    for (size_t at = line.find(' '); at != std::string_view::npos; at = line.find(' ', at + 1)) {
        uint32_t vertex = 0;
        const char* begin = line.data() + at + 1;
        if (std::from_chars(begin, line.data() + line.size(), vertex).ec == std::errc()) vertices.push_back(vertex - 1);
    }
    return vertices;
}

/// Faces of an OBJ file as fans.
Topology read_obj(const std::string& path) {
    auto source = city::TextSource::open(path);
    EXPECT_TRUE(source.ok());
    city::LineReader lines(*source);
    Topology mesh;
    std::string text;
    for (auto more = lines.next(text); more.ok() && *more; more = lines.next(text)) {
        mesh.vertices += text.starts_with("v ") ? 1 : 0;
        if (!text.starts_with("f ")) continue;
        const auto face = face_of(text);
        for (size_t i = 2; i < face.size(); ++i) mesh.triangles.push_back({face[0], face[i - 1], face[i]});
    }
    return mesh;
}

/// Bits per triangle of the file's strip code, and that both codes give the mesh back.
double bits_of_file(const std::string& path) {
    const Topology mesh = read_obj(path);
    EXPECT_GT(mesh.triangles.size(), 1000u) << path;
    const auto code = encode_strips(mesh.triangles, mesh.vertices);
    auto triangles = *decode_strips(code->words);
    for (auto& corners : triangles) {
        for (uint32_t& vertex : corners) vertex = code->vertices[vertex];
    }
    EXPECT_EQ(canonical(triangles, false), canonical(mesh.triangles, false)) << path;
    const auto local = encode_local_strips(mesh.triangles, mesh.vertices);
    auto same = *decode_local_strips(local->words);
    for (auto& corners : same) {
        for (uint32_t& vertex : corners) vertex = local->vertices[vertex];
    }
    EXPECT_EQ(canonical(same), canonical(mesh.triangles)) << path;
    return 32.0 * static_cast<double>(code->words.size()) / static_cast<double>(mesh.triangles.size());
}

TEST(StripFiles, TheArmadilloTakesAtMostTheBitsOfThePaper) {
    const std::string path = kMeshes + "armadillo.obj.xz";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
    EXPECT_LE(bits_of_file(path), 5.3);
}

TEST(StripFiles, TheAsianDragonTakesAtMostTheBitsOfThePaper) {
    const std::string path = kMeshes + "asian_dragon.obj.xz";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
    EXPECT_LE(bits_of_file(path), 4.0);
}

TEST(StripFiles, OtherScansComeBackInAtMostSixBits) {
    const char* names[] = {"hammer", "lionstatue", "mountain", "penguin_hr", "spot"};
    if (!std::filesystem::exists(kMeshes)) GTEST_SKIP() << "no " << kMeshes;
    for (const std::string name : names) EXPECT_LE(bits_of_file(kMeshes + name + ".obj.xz"), 6.0) << name;
}

}  // namespace
}  // namespace citystream::codec::mesh
