#include "tests/bench/glb_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/bench/meshopt_arrays.h"

namespace citystream::bench {

namespace {

using codec::mesh::GridMesh;
using codec::mesh::GridPoint;
using Json = nlohmann::json;

constexpr uint32_t kMagic = 0x46546c67, kVersion = 2, kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;
constexpr uint32_t kShort = 5123, kInt = 5125, kFloat = 5126;
constexpr uint32_t kArrayBuffer = 34962, kElementBuffer = 34963;
constexpr const char* kMeshopt = "EXT_meshopt_compression";

using ShortRow = std::array<uint16_t, 4>;
using FloatRow = std::array<float, 3>;

class GlbWriter {
  public:
    GlbWriter(const GridMesh& mesh, double step) : mesh_(mesh), step_(step) {}

    std::vector<std::byte> floats() {
        std::vector<FloatRow> places;
        for (const GridPoint& p : mesh_.points) {
            places.emplace_back();
            for (size_t c = 0; c < 3; ++c) places.back()[c] = static_cast<float>(p[c] * step_);
        }
        add_view(std::as_bytes(std::span(places)), kArrayBuffer);
        add_accessors(kFloat, places.size(), mesh_.triangles.size() * 3, step_);
        if (has_short_indices()) {
            std::vector<std::array<uint16_t, 3>> rows;
            for (const auto& t : mesh_.triangles)
                rows.push_back({static_cast<uint16_t>(t[0]), static_cast<uint16_t>(t[1]), static_cast<uint16_t>(t[2])});
            add_view(std::as_bytes(std::span(rows)), kElementBuffer);
        } else {
            add_view(std::as_bytes(std::span(mesh_.triangles)), kElementBuffer);
        }
        json_["buffers"] = Json::array({{{"byteLength", binary_.size()}}});
        return finish();
    }

    std::vector<std::byte> meshopt(uint32_t bits) {
        const bool is_short = bits <= 16;
        const MeshoptArrays arrays =
            is_short ? encode_meshopt_arrays<ShortRow>(mesh_) : encode_meshopt_arrays<FloatRow>(mesh_);
        const size_t row = is_short ? sizeof(ShortRow) : sizeof(FloatRow);
        const size_t index = has_short_indices() ? 2 : 4;
        add_compressed(arrays.vertices, arrays.vertex_count, row, "ATTRIBUTES", kArrayBuffer);
        add_compressed(arrays.indices, arrays.index_count, index, "TRIANGLES", kElementBuffer);
        add_accessors(is_short ? kShort : kFloat, arrays.vertex_count, arrays.index_count, 1);
        json_["buffers"] =
            Json::array({{{"byteLength", binary_.size()}},
                         {{"byteLength", decoded_}, {"extensions", {{kMeshopt, {{"fallback", true}}}}}}});
        json_["extensionsRequired"] = {kMeshopt};
        if (is_short) json_["extensionsRequired"].push_back("KHR_mesh_quantization");
        json_["extensionsUsed"] = json_["extensionsRequired"];
        json_["nodes"][0]["scale"] = {step_, step_, step_};
        return finish();
    }

  private:
    bool has_short_indices() const { return mesh_.points.size() <= 65535; }

    uint64_t append(std::span<const std::byte> bytes) {
        const uint64_t begin = binary_.size();
        binary_.insert(binary_.end(), bytes.begin(), bytes.end());
        binary_.resize((binary_.size() + 3) / 4 * 4);
        return begin;
    }
    void add_view(std::span<const std::byte> bytes, uint32_t target) {
        const uint64_t begin = append(bytes);
        json_["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", bytes.size()}, {"target", target}});
    }
    void add_compressed(const std::vector<unsigned char>& coded, size_t count, size_t stride, const char* mode,
                        uint32_t target) {
        const uint64_t begin = append(std::as_bytes(std::span(coded)));
        Json view = {{"buffer", 1}, {"byteOffset", decoded_}, {"byteLength", count * stride}, {"target", target}};
        if (target == kArrayBuffer) view["byteStride"] = stride;
        view["extensions"][kMeshopt] = {{"buffer", 0},          {"byteOffset", begin}, {"byteLength", coded.size()},
                                        {"byteStride", stride}, {"count", count},      {"mode", mode}};
        json_["bufferViews"].push_back(view);
        decoded_ += (count * stride + 3) / 4 * 4;
    }
    /// glTF wants the bounds of positions.
    void add_accessors(uint32_t type, size_t vertices, size_t indices, double unit) {
        std::array<double, 3> low{}, high{};
        for (size_t c = 0; c < 3; ++c) {
            const auto [least, most] =
                std::minmax_element(mesh_.points.begin(), mesh_.points.end(),
                                    [c](const GridPoint& a, const GridPoint& b) { return a[c] < b[c]; });
            low[c] = static_cast<float>((*least)[c] * unit);
            high[c] = static_cast<float>((*most)[c] * unit);
        }
        json_["accessors"] = {{{"bufferView", 0},
                               {"componentType", type},
                               {"count", vertices},
                               {"type", "VEC3"},
                               {"min", low},
                               {"max", high}},
                              {{"bufferView", 1},
                               {"componentType", has_short_indices() ? kShort : kInt},
                               {"count", indices},
                               {"type", "SCALAR"}}};
    }
    void put(uint32_t word) {
        const auto bytes = std::as_bytes(std::span(&word, 1));
        file_.insert(file_.end(), bytes.begin(), bytes.end());
    }
    std::vector<std::byte> finish() {
        json_["asset"] = {{"version", "2.0"}};
        json_["scene"] = 0;
        json_["scenes"] = Json::array({{{"nodes", {0}}}});
        json_["nodes"][0]["mesh"] = 0;
        json_["meshes"] =
            Json::array({{{"primitives", Json::array({{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}})}}});
        std::string text = json_.dump();
        text.resize((text.size() + 3) / 4 * 4, ' ');
        put(kMagic);
        put(kVersion);
        put(static_cast<uint32_t>(12 + 8 + text.size() + 8 + binary_.size()));
        put(static_cast<uint32_t>(text.size()));
        put(kJsonChunk);
        const auto characters = std::as_bytes(std::span(text));
        file_.insert(file_.end(), characters.begin(), characters.end());
        put(static_cast<uint32_t>(binary_.size()));
        put(kBinaryChunk);
        file_.insert(file_.end(), binary_.begin(), binary_.end());
        return std::move(file_);
    }

    const GridMesh& mesh_;
    const double step_;
    Json json_;
    std::vector<std::byte> binary_, file_;
    uint64_t decoded_ = 0;  ///< bytes of the views when they are decompressed
};

template <typename T>
std::vector<T> values_at(std::span<const std::byte> binary, const Json& view, size_t count) {
    std::vector<T> values(count);
    const auto bytes = binary.subspan(view.at("byteOffset"), count * sizeof(T));
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
}

bool read_meshopt(std::span<const std::byte> binary, const Json& file, GridMesh& out) {
    std::array<std::span<const unsigned char>, 2> coded;
    std::array<size_t, 2> counts{};
    for (size_t v = 0; v < 2; ++v) {
        const Json& view = file.at("bufferViews").at(v).at("extensions").at(kMeshopt);
        const auto bytes = binary.subspan(view.at("byteOffset"), view.at("byteLength"));
        coded[v] = {reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()};
        counts[v] = view.at("count");
    }
    const bool is_short = file.at("accessors").at(0).at("componentType") == kShort;
    return is_short ? decode_meshopt_arrays<ShortRow>(coded[0], counts[0], coded[1], counts[1], out)
                    : decode_meshopt_arrays<FloatRow>(coded[0], counts[0], coded[1], counts[1], out);
}

bool read_floats(std::span<const std::byte> binary, const Json& file, double step, GridMesh& out) {
    const auto& accessors = file.at("accessors");
    const size_t points = accessors.at(0).at("count"), indices = accessors.at(1).at("count");
    for (const FloatRow& place : values_at<FloatRow>(binary, file.at("bufferViews").at(0), points)) {
        out.points.emplace_back();
        for (size_t c = 0; c < 3; ++c) out.points.back()[c] = static_cast<int32_t>(std::lround(place[c] / step));
    }
    const Json& view = file.at("bufferViews").at(1);
    if (accessors.at(1).at("componentType") == kInt) {
        out.triangles = values_at<std::array<uint32_t, 3>>(binary, view, indices / 3);
        return true;
    }
    for (const auto& t : values_at<std::array<uint16_t, 3>>(binary, view, indices / 3))
        out.triangles.push_back({t[0], t[1], t[2]});
    return true;
}

}  // namespace

std::vector<std::byte> write_glb(const GridMesh& mesh, double step, uint32_t bits, GlbForm form) {
    GlbWriter writer(mesh, step);
    return form == GlbForm::kFloats ? writer.floats() : writer.meshopt(bits);
}

bool read_glb(std::span<const std::byte> bytes, double step, GridMesh& out) {
    std::array<uint32_t, 5> header{};
    if (bytes.size() < sizeof header) return false;
    std::memcpy(header.data(), bytes.data(), sizeof header);
    if (header[0] != kMagic || header[1] != kVersion || header[2] != bytes.size() || header[4] != kJsonChunk)
        return false;
    const auto text = bytes.subspan(sizeof header, header[3]);
    const Json file = Json::parse(reinterpret_cast<const char*>(text.data()),
                                  reinterpret_cast<const char*>(text.data()) + text.size());
    const auto binary = bytes.subspan(sizeof header + text.size() + 8);
    return file.contains("extensionsRequired") ? read_meshopt(binary, file, out) : read_floats(binary, file, step, out);
}

}  // namespace citystream::bench
