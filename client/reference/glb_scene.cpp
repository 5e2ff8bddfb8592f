#include "client/reference/glb_scene.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#include <tiny_gltf.h>
#pragma GCC diagnostic pop

namespace citystream::client {
namespace {

using Matrix = std::array<double, 16>;  // column-major 4 x 4

Matrix multiply(const Matrix& a, const Matrix& b) {
    Matrix out{};
    for (size_t column = 0; column < 4; ++column)
        for (size_t row = 0; row < 4; ++row)
            for (size_t k = 0; k < 4; ++k) out[column * 4 + row] += a[k * 4 + row] * b[column * 4 + k];
    return out;
}

Matrix from_trs(const double t[3], const double q[4], const double s[3]) {
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    return {(1 - 2 * (y * y + z * z)) * s[0],
            2 * (x * y + z * w) * s[0],
            2 * (x * z - y * w) * s[0],
            0,
            2 * (x * y - z * w) * s[1],
            (1 - 2 * (x * x + z * z)) * s[1],
            2 * (y * z + x * w) * s[1],
            0,
            2 * (x * z + y * w) * s[2],
            2 * (y * z - x * w) * s[2],
            (1 - 2 * (x * x + y * y)) * s[2],
            0,
            t[0],
            t[1],
            t[2],
            1};
}

Matrix local_matrix(const tinygltf::Node& node) {
    if (node.matrix.size() == 16) {
        Matrix out;
        std::copy(node.matrix.begin(), node.matrix.end(), out.begin());
        return out;
    }
    double t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    if (node.translation.size() == 3) std::copy(node.translation.begin(), node.translation.end(), t);
    if (node.rotation.size() == 4) std::copy(node.rotation.begin(), node.rotation.end(), q);
    if (node.scale.size() == 3) std::copy(node.scale.begin(), node.scale.end(), s);
    return from_trs(t, q, s);
}

// glTF is y up; the city is z up: (x, y, z) of glTF is (x, -z, y) here.
GlbTransform to_z_up(const Matrix& m) {
    GlbTransform out;
    for (size_t column = 0; column < 4; ++column) {
        out[column * 3 + 0] = static_cast<float>(m[column * 4 + 0]);
        out[column * 3 + 1] = static_cast<float>(-m[column * 4 + 2]);
        out[column * 3 + 2] = static_cast<float>(m[column * 4 + 1]);
    }
    return out;
}

float encode_srgb(double linear) {
    linear = std::clamp(linear, 0.0, 1.0);
    return static_cast<float>(linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055);
}

class Loader {
  public:
    Result<GlbScene> load(const std::string& path);

  private:
    bool read_floats(int accessor_index, size_t components, std::vector<float>& out);
    bool read_indices(int accessor_index, size_t vertex_count, std::vector<uint32_t>& out);
    bool read_primitive(const tinygltf::Primitive& in, GlbPrimitive& out);
    bool read_geometry(const std::array<int, 4>& accessors, GlbGeometry& out);
    bool read_instances(const tinygltf::Value& extension, const Matrix& parent, GlbDraw& draw);
    bool visit(int node_index, const Matrix& parent, int depth);
    void read_materials();
    const uint8_t* element_bytes(int accessor_index, size_t components, int component_type, size_t& stride,
                                 size_t& count);
    bool fail(const std::string& what) {
        error_ = what;
        return false;
    }

    tinygltf::Model model_;
    GlbScene scene_;
    std::map<std::array<int, 4>, uint32_t> geometry_of_;
    std::string error_;
};

const uint8_t* Loader::element_bytes(int accessor_index, size_t components, int component_type, size_t& stride,
                                     size_t& count) {
    if (accessor_index < 0 || static_cast<size_t>(accessor_index) >= model_.accessors.size()) return nullptr;
    const tinygltf::Accessor& accessor = model_.accessors[static_cast<size_t>(accessor_index)];
    if (accessor.bufferView < 0 || static_cast<size_t>(accessor.bufferView) >= model_.bufferViews.size())
        return nullptr;
    const tinygltf::BufferView& view = model_.bufferViews[static_cast<size_t>(accessor.bufferView)];
    if (view.buffer < 0 || static_cast<size_t>(view.buffer) >= model_.buffers.size()) return nullptr;
    const std::vector<unsigned char>& buffer = model_.buffers[static_cast<size_t>(view.buffer)].data;
    const size_t element =
        components * static_cast<size_t>(tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(component_type)));
    if (accessor.componentType != component_type ||
        tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type)) != static_cast<int>(components))
        return nullptr;
    stride = view.byteStride ? view.byteStride : element;
    count = accessor.count;
    const size_t begin = view.byteOffset + accessor.byteOffset;
    if (count == 0 || begin > buffer.size() || buffer.size() - begin < element ||
        (buffer.size() - begin - element) / stride < count - 1)
        return nullptr;
    return buffer.data() + begin;
}

bool Loader::read_floats(int accessor_index, size_t components, std::vector<float>& out) {
    size_t stride = 0, count = 0;
    const uint8_t* bytes = element_bytes(accessor_index, components, TINYGLTF_COMPONENT_TYPE_FLOAT, stride, count);
    if (!bytes) return fail("accessor " + std::to_string(accessor_index) + " is not a float array inside its buffer");
    out.resize(count * components);
    for (size_t i = 0; i < count; ++i)
        std::memcpy(&out[i * components], bytes + i * stride, components * sizeof(float));
    return true;
}

bool Loader::read_indices(int accessor_index, size_t vertex_count, std::vector<uint32_t>& out) {
    size_t stride = 0, count = 0;
    if (const uint8_t* wide = element_bytes(accessor_index, 1, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, stride, count)) {
        out.resize(count);
        for (size_t i = 0; i < count; ++i) std::memcpy(&out[i], wide + i * stride, 4);
    } else if (const uint8_t* narrow =
                   element_bytes(accessor_index, 1, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, stride, count)) {
        out.resize(count);
        for (size_t i = 0; i < count; ++i) {
            uint16_t index = 0;
            std::memcpy(&index, narrow + i * stride, 2);
            out[i] = index;
        }
    } else {
        return fail("accessor " + std::to_string(accessor_index) + " is not an index array inside its buffer");
    }
    for (const uint32_t index : out)
        if (index >= vertex_count)
            return fail("index beyond the vertices in accessor " + std::to_string(accessor_index));
    return true;
}

bool Loader::read_geometry(const std::array<int, 4>& accessors, GlbGeometry& out) {
    std::vector<float> positions, normals, texcoords;
    if (!read_floats(accessors[0], 3, positions)) return false;
    if (accessors[1] < 0) return fail("a primitive has no NORMAL");
    if (!read_floats(accessors[1], 3, normals)) return false;
    if (accessors[2] >= 0 && !read_floats(accessors[2], 2, texcoords)) return false;
    const size_t count = positions.size() / 3;
    if (normals.size() != positions.size() || (!texcoords.empty() && texcoords.size() != 2 * count))
        return fail("attributes of a primitive differ in length");
    out.vertices.resize(count);
    out.minimum = {1e30f, 1e30f, 1e30f};
    out.maximum = {-1e30f, -1e30f, -1e30f};
    for (size_t i = 0; i < count; ++i) {
        GlbVertex& vertex = out.vertices[i];
        for (size_t axis = 0; axis < 3; ++axis) {
            vertex.position[axis] = positions[3 * i + axis];
            vertex.normal[axis] = normals[3 * i + axis];
            out.minimum[axis] = std::min(out.minimum[axis], vertex.position[axis]);
            out.maximum[axis] = std::max(out.maximum[axis], vertex.position[axis]);
        }
        for (size_t axis = 0; axis < 2; ++axis) vertex.texcoord[axis] = texcoords.empty() ? 0 : texcoords[2 * i + axis];
    }
    return read_indices(accessors[3], count, out.indices);
}

bool Loader::read_primitive(const tinygltf::Primitive& in, GlbPrimitive& out) {
    if (in.mode != TINYGLTF_MODE_TRIANGLES && in.mode != -1) return fail("a primitive is not made of triangles");
    const auto attribute = [&](const char* name) {
        const auto found = in.attributes.find(name);
        return found == in.attributes.end() ? -1 : found->second;
    };
    const std::array<int, 4> accessors = {attribute("POSITION"), attribute("NORMAL"), attribute("TEXCOORD_0"),
                                          in.indices};
    const auto [known, is_new] = geometry_of_.try_emplace(accessors, static_cast<uint32_t>(scene_.geometries.size()));
    if (is_new && !read_geometry(accessors, scene_.geometries.emplace_back())) return false;
    out.geometry = known->second;
    const bool has_material = in.material >= 0 && static_cast<size_t>(in.material) < model_.materials.size();
    out.material = static_cast<uint32_t>(has_material ? static_cast<size_t>(in.material) : model_.materials.size());
    return true;
}

bool Loader::read_instances(const tinygltf::Value& extension, const Matrix& parent, GlbDraw& draw) {
    const tinygltf::Value& attributes = extension.Get("attributes");
    std::vector<float> t, q, s;
    const auto read = [&](const char* name, size_t components, std::vector<float>& out) {
        return !attributes.Has(name) || read_floats(attributes.Get(name).GetNumberAsInt(), components, out);
    };
    if (!read("TRANSLATION", 3, t) || !read("ROTATION", 4, q) || !read("SCALE", 3, s)) return false;
    const size_t count = std::max({t.size() / 3, q.size() / 4, s.size() / 3});
    if ((!t.empty() && t.size() != 3 * count) || (!q.empty() && q.size() != 4 * count) ||
        (!s.empty() && s.size() != 3 * count))
        return fail("instance attributes differ in length");
    draw.instances.reserve(count);
    for (size_t i = 0; i < count; ++i) {
        double translation[3] = {0, 0, 0}, rotation[4] = {0, 0, 0, 1}, scale[3] = {1, 1, 1};
        if (!t.empty()) std::copy_n(&t[3 * i], 3, translation);
        if (!q.empty()) std::copy_n(&q[4 * i], 4, rotation);
        if (!s.empty()) std::copy_n(&s[3 * i], 3, scale);
        draw.instances.push_back(to_z_up(multiply(parent, from_trs(translation, rotation, scale))));
    }
    return true;
}

bool Loader::visit(int node_index, const Matrix& parent, int depth) {
    if (depth > 32 || node_index < 0 || static_cast<size_t>(node_index) >= model_.nodes.size())
        return fail("bad node tree");
    const tinygltf::Node& node = model_.nodes[static_cast<size_t>(node_index)];
    const Matrix world = multiply(parent, local_matrix(node));
    if (node.mesh >= 0 && static_cast<size_t>(node.mesh) < model_.meshes.size()) {
        GlbDraw draw;
        draw.mesh = static_cast<uint32_t>(node.mesh);
        const auto instancing = node.extensions.find("EXT_mesh_gpu_instancing");
        if (instancing != node.extensions.end()) {
            if (!read_instances(instancing->second, world, draw)) return false;
        } else {
            draw.instances.push_back(to_z_up(world));
        }
        scene_.draws.push_back(std::move(draw));
    }
    for (const int child : node.children)
        if (!visit(child, world, depth + 1)) return false;
    return true;
}

void Loader::read_materials() {
    for (const tinygltf::Material& in : model_.materials) {
        GlbMaterial out;
        const tinygltf::PbrMetallicRoughness& pbr = in.pbrMetallicRoughness;
        for (size_t i = 0; i < 3 && i < pbr.baseColorFactor.size(); ++i)
            out.srgb[i] = encode_srgb(pbr.baseColorFactor[i]);
        if (in.alphaMode == "MASK") out.alpha_cutoff = static_cast<float>(in.alphaCutoff);
        const int texture = pbr.baseColorTexture.index;
        if (texture >= 0 && static_cast<size_t>(texture) < model_.textures.size()) {
            const tinygltf::Texture& t = model_.textures[static_cast<size_t>(texture)];
            if (t.source >= 0 && static_cast<size_t>(t.source) < scene_.images.size()) out.image = t.source;
            if (t.sampler >= 0 && static_cast<size_t>(t.sampler) < model_.samplers.size()) {
                const tinygltf::Sampler& sampler = model_.samplers[static_cast<size_t>(t.sampler)];
                out.repeat_u = sampler.wrapS == TINYGLTF_TEXTURE_WRAP_REPEAT;
                out.repeat_v = sampler.wrapT == TINYGLTF_TEXTURE_WRAP_REPEAT;
            }
            const auto transform = pbr.baseColorTexture.extensions.find("KHR_texture_transform");
            if (transform != pbr.baseColorTexture.extensions.end()) {
                for (int i = 0; i < 2; ++i) {
                    const tinygltf::Value& value = transform->second;
                    if (value.Has("scale"))
                        out.texcoord_scale[static_cast<size_t>(i)] =
                            static_cast<float>(value.Get("scale").Get(i).GetNumberAsDouble());
                    if (value.Has("offset"))
                        out.texcoord_offset[static_cast<size_t>(i)] =
                            static_cast<float>(value.Get("offset").Get(i).GetNumberAsDouble());
                }
            }
        }
        scene_.materials.push_back(out);
    }
    scene_.materials.emplace_back();
}

bool decode_image(GlbImage& out, const unsigned char* bytes, int size) {
    OIIO::Filesystem::IOMemReader memory(const_cast<unsigned char*>(bytes), static_cast<size_t>(size));
    const bool png = size > 4 && bytes[0] == 0x89 && bytes[1] == 'P';
    OIIO::ImageSpec wishes;
    wishes.attribute("oiio:UnassociatedAlpha", 1);
    OIIO::Filesystem::IOProxy* proxy = &memory;
    wishes.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);  // open() takes it from there when there are wishes
    auto input = OIIO::ImageInput::open(png ? "image.png" : "image.jpg", &wishes, &memory);
    if (!input) return false;
    const OIIO::ImageSpec& spec = input->spec();
    const auto channels = static_cast<size_t>(spec.nchannels);
    std::vector<uint8_t> raw(static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height) * channels);
    const bool alpha = spec.alpha_channel >= 0 && spec.alpha_channel < spec.nchannels;
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, raw.data())) return false;
    out.width = static_cast<uint32_t>(spec.width);
    out.height = static_cast<uint32_t>(spec.height);
    out.rgba.assign(size_t{4} * out.width * out.height, 255);
    for (size_t i = 0; i < size_t{out.width} * out.height; ++i) {
        for (size_t c = 0; c < 3; ++c) out.rgba[4 * i + c] = raw[i * channels + (channels >= 3 ? c : 0)];
        if (alpha) out.rgba[4 * i + 3] = raw[i * channels + static_cast<size_t>(spec.alpha_channel)];
    }
    return true;
}

Result<GlbScene> Loader::load(const std::string& path) {
    tinygltf::TinyGLTF reader;
    reader.SetImageLoader(
        [](tinygltf::Image*, const int index, std::string* error, std::string*, int, int, const unsigned char* bytes,
           int size, void* self) {
            auto& scene = static_cast<Loader*>(self)->scene_;
            if (index < 0) return false;
            if (scene.images.size() <= static_cast<size_t>(index)) scene.images.resize(static_cast<size_t>(index) + 1);
            if (decode_image(scene.images[static_cast<size_t>(index)], bytes, size)) return true;
            *error += "image " + std::to_string(index) + " cannot be decoded";
            return false;
        },
        this);
    std::string error, warning;
    if (!reader.LoadBinaryFromFile(&model_, &error, &warning, path))
        return Error{path + ": no readable binary glTF: " + error};
    const tinygltf::Value& extras = model_.asset.extras;
    if (extras.Has("citystream") && extras.Get("citystream").Has("origin"))
        for (int i = 0; i < 3; ++i)
            scene_.origin[static_cast<size_t>(i)] = extras.Get("citystream").Get("origin").Get(i).GetNumberAsDouble();
    read_materials();
    scene_.meshes.resize(model_.meshes.size());
    for (size_t i = 0; i < model_.meshes.size(); ++i) {
        for (const tinygltf::Primitive& primitive : model_.meshes[i].primitives) {
            GlbPrimitive out;
            if (!read_primitive(primitive, out)) return Error{path + ": mesh " + std::to_string(i) + ": " + error_};
            scene_.meshes[i].push_back(out);
        }
    }
    const Matrix identity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    if (model_.scenes.empty()) return Error{path + ": the file has no scene"};
    const auto scene_index =
        static_cast<size_t>(std::clamp(model_.defaultScene, 0, static_cast<int>(model_.scenes.size()) - 1));
    for (const int node : model_.scenes[scene_index].nodes)
        if (!visit(node, identity, 0)) return Error{path + ": " + error_};
    return std::move(scene_);
}

}  // namespace

Result<GlbScene> load_glb(const std::string& path) {
    return Loader().load(path);
}

}  // namespace citystream::client
