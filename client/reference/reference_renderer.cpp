#include "client/reference/reference_renderer.h"

#include <EGL/egl.h>
#include <GLES3/gl32.h>
// After the core header, whose types it uses.
#include <GLES2/gl2ext.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <utility>

#include "client/reference/glb_scene.h"
#include "client/reference/gles_context.h"
#include "client/render/lighting_layout.h"
#include "codec/atlas/alpha_mask.h"
#include "codec/atlas/tint_layout.h"

namespace citystream::client {
namespace {

/// Where a vertex attribute begins in the bound buffer: OpenGL takes the offset as a pointer.
const void* buffer_offset(size_t bytes) {
    return reinterpret_cast<const void*>(bytes);  // NOLINT(performance-no-int-to-ptr)
}

static_assert(TINT_COLOURS == 24, "as the shader below says");

constexpr const char* kVertexShader = R"(#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 texcoord;
layout(location = 3) in vec3 column0;
layout(location = 4) in vec3 column1;
layout(location = 5) in vec3 column2;
layout(location = 6) in vec3 column3;
uniform mat4 clip_from_view;
uniform mat3 view_from_world;
uniform vec4 texcoord_transform;
uniform vec2 tint_field;
out vec3 world_normal;
out vec2 uv;
out float tint_place;
void main() {
    mat3 rotation = mat3(column0, column1, column2);
    vec3 from_eye = rotation * position + column3;
    vec3 view = view_from_world * from_eye;
    tint_place = tint_field.x + (from_eye.x + from_eye.y) * tint_field.y;
    world_normal = inverse(transpose(rotation)) * normal;
    uv = texcoord * texcoord_transform.xy + texcoord_transform.zw;
    gl_Position = clip_from_view * vec4(view, 1.0);
}
)";

constexpr const char* kFragmentShader = R"(#version 300 es
precision highp float;
#define TINTS 24
in vec3 world_normal;
in vec2 uv;
in float tint_place;
uniform vec3 tints[TINTS];
uniform float tint_strength;
uniform sampler2D image;
uniform vec3 colour;
uniform float alpha_cutoff;
uniform vec3 sun;
uniform vec2 light;
out vec4 result;
void main() {
    vec4 sampled = texture(image, uv);
    if (sampled.a < alpha_cutoff) discard;
    vec3 texel = sampled.rgb * colour;
    vec3 normal = normalize(world_normal);
    if (tint_strength > 0.0 && abs(normal.z) <= 0.5) {
        float in_palette = mod(tint_place, float(TINTS));
        int first = min(int(in_palette), TINTS - 1);
        vec3 tint = mix(tints[first], tints[(first + 1) % TINTS], in_palette - float(first));
        texel *= mix(vec3(1.0), tint, tint_strength);
    }
    float lambert = max(0.0, dot(normal, sun));
    result = vec4(min(texel * (light.x + light.y * lambert), vec3(1.0)), 1.0);
}
)";

struct GpuGeometry {
    GLuint vertices = 0, indices = 0;
    GLsizei index_count = 0;
    std::array<float, 4> sphere{};  // centre, radius, in the mesh's own space
};

struct Frustum {
    std::array<std::array<double, 3>, 5> normals{};
    std::array<double, 5> offsets{};
};

GLuint compile(GLenum stage, const char* source) {
    const GLuint shader = glCreateShader(stage);
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    GLint ok = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    return ok ? shader : 0;
}

class GlesReferenceRenderer final : public ReferenceRenderer {
  public:
    GlesReferenceRenderer(std::unique_ptr<GlesContext> context, GlbScene scene, const ReferenceOptions& options)
        : context_(std::move(context)), scene_(std::move(scene)), options_(options) {}
    GlesReferenceRenderer(const GlesReferenceRenderer&) = delete;
    GlesReferenceRenderer& operator=(const GlesReferenceRenderer&) = delete;
    ~GlesReferenceRenderer() override;

    Status initialise();
    Result<FrameImage> draw(const Camera& camera) override;
    double last_frame_ms() const override { return last_frame_ms_; }
    uint64_t triangles_drawn() const override { return triangles_drawn_; }
    uint64_t gpu_bytes() const override { return gpu_bytes_; }
    std::string device_name() const override { return context_->device_name(); }

  private:
    Status make_program();
    Status make_targets();
    void upload_geometries();
    void upload_textures();
    void set_camera(const Camera& camera);
    void set_tint(const Camera& camera);
    void draw_mesh(const GlbDraw& draw, const std::array<double, 3>& eye, const Frustum& frustum);
    void bind_material(const GlbMaterial& material);
    FrameImage read_back() const;

    std::unique_ptr<GlesContext> context_;
    GlbScene scene_;
    ReferenceOptions options_;
    GLuint program_ = 0, framebuffer_ = 0, colour_ = 0, depth_ = 0, vertex_array_ = 0, instances_ = 0, white_ = 0;
    std::vector<GpuGeometry> geometries_;
    std::vector<GLuint> textures_;
    std::vector<float> instance_data_;
    uint64_t gpu_bytes_ = 0, triangles_drawn_ = 0;
    double last_frame_ms_ = 0;
};

GlesReferenceRenderer::~GlesReferenceRenderer() {
    context_->make_current();
    for (const GpuGeometry& geometry : geometries_) {
        glDeleteBuffers(1, &geometry.vertices);
        glDeleteBuffers(1, &geometry.indices);
    }
    glDeleteTextures(static_cast<GLsizei>(textures_.size()), textures_.data());
    glDeleteTextures(1, &white_);
    glDeleteBuffers(1, &instances_);
    glDeleteVertexArrays(1, &vertex_array_);
    glDeleteFramebuffers(1, &framebuffer_);
    glDeleteRenderbuffers(1, &colour_);
    glDeleteRenderbuffers(1, &depth_);
    glDeleteProgram(program_);
}

Status GlesReferenceRenderer::initialise() {
    if (Status status = make_program(); !status) return status;
    if (Status status = make_targets(); !status) return status;
    glGenVertexArrays(1, &vertex_array_);
    glBindVertexArray(vertex_array_);
    glGenBuffers(1, &instances_);
    upload_geometries();
    upload_textures();
    if (glGetError() != GL_NO_ERROR)
        return Error{"the reference renderer ran out of graphics memory while loading the city"};
    return Done{};
}

Status GlesReferenceRenderer::make_program() {
    const auto* extensions = reinterpret_cast<const char*>(glGetString(GL_EXTENSIONS));
    for (const auto& [name, purpose] : {std::pair{"GL_EXT_clip_control", "reversed depth"},
                                        std::pair{"GL_EXT_texture_sRGB_decode", "mips made in linear light"}}) {
        if (!extensions || !std::strstr(extensions, name))
            return Error{std::string("the OpenGL ES driver has no ") + name +
                         ", which the reference renderer needs for " + purpose};
    }
    const GLuint vertex = compile(GL_VERTEX_SHADER, kVertexShader),
                 fragment = compile(GL_FRAGMENT_SHADER, kFragmentShader);
    program_ = glCreateProgram();
    glAttachShader(program_, vertex);
    glAttachShader(program_, fragment);
    glLinkProgram(program_);
    glDeleteShader(vertex);
    glDeleteShader(fragment);
    GLint linked = 0;
    glGetProgramiv(program_, GL_LINK_STATUS, &linked);
    if (!linked) return Error{"the reference renderer's shaders do not link on " + context_->device_name()};
    return Done{};
}

Status GlesReferenceRenderer::make_targets() {
    const auto width = static_cast<GLsizei>(options_.width * options_.supersample);
    const auto height = static_cast<GLsizei>(options_.height * options_.supersample);
    glGenRenderbuffers(1, &colour_);
    glBindRenderbuffer(GL_RENDERBUFFER, colour_);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
    glGenRenderbuffers(1, &depth_);
    glBindRenderbuffer(GL_RENDERBUFFER, depth_);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, width, height);
    glGenFramebuffers(1, &framebuffer_);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour_);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return Error{"the reference renderer cannot make a frame of " + std::to_string(width) + " x " +
                     std::to_string(height)};
    return Done{};
}

void GlesReferenceRenderer::upload_geometries() {
    for (GlbGeometry& in : scene_.geometries) {
        GpuGeometry out;
        out.index_count = static_cast<GLsizei>(in.indices.size());
        const size_t vertex_bytes = in.vertices.size() * sizeof(GlbVertex), index_bytes = in.indices.size() * 4;
        glGenBuffers(1, &out.vertices);
        glBindBuffer(GL_ARRAY_BUFFER, out.vertices);
        glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertex_bytes), in.vertices.data(), GL_STATIC_DRAW);
        glGenBuffers(1, &out.indices);
        glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, out.indices);
        glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(index_bytes), in.indices.data(), GL_STATIC_DRAW);
        gpu_bytes_ += vertex_bytes + index_bytes;
        double radius = 0;
        for (size_t axis = 0; axis < 3; ++axis) {
            out.sphere[axis] = (in.minimum[axis] + in.maximum[axis]) / 2;
            radius += std::pow((in.maximum[axis] - in.minimum[axis]) / 2.0, 2);
        }
        out.sphere[3] = static_cast<float>(std::sqrt(radius));
        geometries_.push_back(out);
        in.vertices = {};
        in.indices = {};
    }
}

/// The images that materials test by alpha: the plain filter of glGenerateMipmap would make them vanish or close.
std::vector<bool> masked_images(const GlbScene& scene) {
    std::vector<bool> masked(scene.images.size());
    for (const GlbMaterial& material : scene.materials) {
        if (material.image >= 0 && material.alpha_cutoff > 0) masked[static_cast<size_t>(material.image)] = true;
    }
    return masked;
}

/// As sRGB, so that the driver makes mips in linear light; they are sampled as encoded values (GL_SKIP_DECODE_EXT),
/// which all colour arithmetic is on.
void upload_level(GLint level, uint32_t width, uint32_t height, const uint8_t* rgba) {
    glTexImage2D(GL_TEXTURE_2D, level, GL_SRGB8_ALPHA8, static_cast<GLsizei>(width), static_cast<GLsizei>(height), 0,
                 GL_RGBA, GL_UNSIGNED_BYTE, rgba);
}

/// Mips of as much of the image as the image has (codec/atlas/alpha_mask.h), down to the last one that can show it.
void upload_masked_mips(const GlbImage& image) {
    codec::atlas::ChartImage mip{image.width, image.height, true, true, 0, {}};
    for (size_t i = 0; i < image.rgba.size(); i += 4) {
        mip.rgb.insert(mip.rgb.end(), &image.rgba[i], &image.rgba[i] + 3);
        mip.alpha.push_back(image.rgba[i + 3]);
    }
    GLint level = 0;
    while (uint64_t{mip.width} * mip.height >= 4 * uint64_t{codec::atlas::kLeastAlphaTexels}) {
        mip = codec::atlas::downsample(mip);
        std::vector<uint8_t> rgba;
        for (size_t i = 0; i < mip.alpha.size(); ++i)
            rgba.insert(rgba.end(), {mip.rgb[3 * i], mip.rgb[3 * i + 1], mip.rgb[3 * i + 2], mip.alpha[i]});
        upload_level(++level, mip.width, mip.height, rgba.data());
    }
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, level);
}

void GlesReferenceRenderer::upload_textures() {
    const auto upload = [&](uint32_t width, uint32_t height, const uint8_t* rgba, const GlbImage* masked = nullptr) {
        GLuint texture = 0;
        glGenTextures(1, &texture);
        glBindTexture(GL_TEXTURE_2D, texture);
        upload_level(0, width, height, rgba);
        if (masked != nullptr) {
            upload_masked_mips(*masked);
        } else {
            glGenerateMipmap(GL_TEXTURE_2D);
        }
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_SRGB_DECODE_EXT, GL_SKIP_DECODE_EXT);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        gpu_bytes_ += uint64_t{4} * width * height * 4 / 3;
        return texture;
    };
    const uint8_t white[4] = {255, 255, 255, 255};
    white_ = upload(1, 1, white);
    const std::vector<bool> masked = masked_images(scene_);
    for (size_t i = 0; i < scene_.images.size(); ++i) {
        GlbImage& image = scene_.images[i];
        textures_.push_back(image.rgba.empty()
                                ? 0
                                : upload(image.width, image.height, image.rgba.data(), masked[i] ? &image : nullptr));
        image.rgba = {};
    }
}

Frustum frustum_of(const Camera& camera) {
    const double tan_y = std::tan(camera.fov_y / 2), tan_x = tan_y * camera.width / camera.height;
    Frustum frustum;
    const auto plane = [&](size_t i, double along_right, double along_up, double tangent) {
        const double length = std::sqrt(1 + tangent * tangent);
        for (size_t axis = 0; axis < 3; ++axis)
            frustum.normals[i][axis] =
                (camera.right[axis] * along_right + camera.up[axis] * along_up + camera.forward[axis] * tangent) /
                length;
    };
    plane(0, 1, 0, tan_x);
    plane(1, -1, 0, tan_x);
    plane(2, 0, 1, tan_y);
    plane(3, 0, -1, tan_y);
    frustum.normals[4] = camera.forward;
    frustum.offsets[4] = camera.near_plane;
    return frustum;
}

void GlesReferenceRenderer::set_camera(const Camera& camera) {
    const auto f = static_cast<float>(1 / std::tan(camera.fov_y / 2));
    const float aspect = static_cast<float>(camera.width) / static_cast<float>(camera.height);
    // View space: x right, y up, z forward. Reversed z with an infinite far plane: depth = near / z.
    const float clip_from_view[16] = {
        f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, 0, 1, 0, 0, static_cast<float>(camera.near_plane), 0};
    float view_from_world[9];
    for (size_t axis = 0; axis < 3; ++axis) {
        view_from_world[axis * 3 + 0] = static_cast<float>(camera.right[axis]);
        view_from_world[axis * 3 + 1] = static_cast<float>(camera.up[axis]);
        view_from_world[axis * 3 + 2] = static_cast<float>(camera.forward[axis]);
    }
    glUniformMatrix4fv(glGetUniformLocation(program_, "clip_from_view"), 1, GL_FALSE, clip_from_view);
    glUniformMatrix3fv(glGetUniformLocation(program_, "view_from_world"), 1, GL_FALSE, view_from_world);
    glUniform3f(glGetUniformLocation(program_, "sun"), static_cast<float>(LIGHT_SUN_X), static_cast<float>(LIGHT_SUN_Y),
                static_cast<float>(LIGHT_SUN_Z));
    glUniform2f(glGetUniformLocation(program_, "light"), options_.lit ? static_cast<float>(LIGHT_AMBIENT) : 1,
                options_.lit ? static_cast<float>(LIGHT_SUN) : 0);
    glUniform1i(glGetUniformLocation(program_, "image"), 0);
    set_tint(camera);
}

void GlesReferenceRenderer::set_tint(const Camera& camera) {
    const codec::atlas::FacadeTint& tint = options_.facade_tint;
    const std::span<const codec::atlas::Tint> palette = codec::atlas::tint_palette();
    glUniform1f(glGetUniformLocation(program_, "tint_strength"), static_cast<float>(tint.strength));
    glUniform2f(glGetUniformLocation(program_, "tint_field"),
                static_cast<float>(codec::atlas::tint_place(camera.position, tint)),
                static_cast<float>(1 / tint.step_metres));
    glUniform3fv(glGetUniformLocation(program_, "tints"), static_cast<GLsizei>(palette.size()), palette[0].data());
}

void GlesReferenceRenderer::bind_material(const GlbMaterial& material) {
    const bool textured = material.image >= 0 && textures_[static_cast<size_t>(material.image)] != 0;
    glBindTexture(GL_TEXTURE_2D, textured ? textures_[static_cast<size_t>(material.image)] : white_);
    if (textured) {
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, material.repeat_u ? GL_REPEAT : GL_CLAMP_TO_EDGE);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, material.repeat_v ? GL_REPEAT : GL_CLAMP_TO_EDGE);
    }
    glUniform1f(glGetUniformLocation(program_, "alpha_cutoff"), textured ? material.alpha_cutoff : 0);
    glUniform3f(glGetUniformLocation(program_, "colour"), material.srgb[0], material.srgb[1], material.srgb[2]);
    glUniform4f(glGetUniformLocation(program_, "texcoord_transform"), material.texcoord_scale[0],
                material.texcoord_scale[1], material.texcoord_offset[0], material.texcoord_offset[1]);
}

bool sphere_visible(const std::array<float, 4>& sphere, const GlbTransform& m, const std::array<double, 3>& eye,
                    const Frustum& frustum) {
    double centre[3], scale = 0;
    for (size_t row = 0; row < 3; ++row) {
        centre[row] = double{m[row]} * sphere[0] + double{m[3 + row]} * sphere[1] + double{m[6 + row]} * sphere[2] +
                      m[9 + row] - eye[row];
        scale += double{m[row]} * m[row] + double{m[3 + row]} * m[3 + row] + double{m[6 + row]} * m[6 + row];
    }
    const double radius = sphere[3] * std::sqrt(scale);
    for (size_t i = 0; i < 5; ++i) {
        const auto& n = frustum.normals[i];
        if (n[0] * centre[0] + n[1] * centre[1] + n[2] * centre[2] - frustum.offsets[i] < -radius) return false;
    }
    return true;
}

void GlesReferenceRenderer::draw_mesh(const GlbDraw& draw, const std::array<double, 3>& eye, const Frustum& frustum) {
    for (const GlbPrimitive& primitive : scene_.meshes[draw.mesh]) {
        const GpuGeometry& geometry = geometries_[primitive.geometry];
        instance_data_.clear();
        for (const GlbTransform& instance : draw.instances) {
            if (!sphere_visible(geometry.sphere, instance, eye, frustum)) continue;
            instance_data_.insert(instance_data_.end(), instance.begin(), instance.end());
            for (size_t axis = 0; axis < 3; ++axis)
                instance_data_[instance_data_.size() - 3 + axis] =
                    static_cast<float>(double{instance[9 + axis]} - eye[axis]);
        }
        if (instance_data_.empty()) continue;
        bind_material(scene_.materials[primitive.material]);
        glBindBuffer(GL_ARRAY_BUFFER, instances_);
        glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(instance_data_.size() * 4), instance_data_.data(),
                     GL_STREAM_DRAW);
        for (GLuint i = 0; i < 4; ++i) {
            glEnableVertexAttribArray(3 + i);
            glVertexAttribPointer(3 + i, 3, GL_FLOAT, GL_FALSE, 48, buffer_offset(size_t{12} * i));
            glVertexAttribDivisor(3 + i, 1);
        }
        glBindBuffer(GL_ARRAY_BUFFER, geometry.vertices);
        const GLint components[3] = {3, 3, 2};
        for (GLuint i = 0; i < 3; ++i) {
            glEnableVertexAttribArray(i);
            glVertexAttribPointer(i, components[i], GL_FLOAT, GL_FALSE, sizeof(GlbVertex),
                                  buffer_offset(size_t{12} * i));
        }
        glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, geometry.indices);
        const auto count = static_cast<GLsizei>(instance_data_.size() / 12);
        glDrawElementsInstanced(GL_TRIANGLES, geometry.index_count, GL_UNSIGNED_INT, nullptr, count);
        triangles_drawn_ += static_cast<uint64_t>(geometry.index_count / 3) * static_cast<uint64_t>(count);
    }
}

FrameImage GlesReferenceRenderer::read_back() const {
    const uint32_t n = std::max(1u, options_.supersample), width = options_.width * n, height = options_.height * n;
    std::vector<uint8_t> raw(size_t{4} * width * height);
    glReadPixels(0, 0, static_cast<GLsizei>(width), static_cast<GLsizei>(height), GL_RGBA, GL_UNSIGNED_BYTE,
                 raw.data());
    FrameImage out{options_.width, options_.height, std::vector<uint8_t>(size_t{4} * options_.width * options_.height)};
    for (uint32_t y = 0; y < out.height; ++y) {
        for (uint32_t x = 0; x < out.width; ++x) {
            for (uint32_t c = 0; c < 4; ++c) {
                uint32_t sum = 0;
                for (uint32_t j = 0; j < n; ++j)
                    for (uint32_t i = 0; i < n; ++i)
                        sum += raw[4 * (size_t{height - 1 - (y * n + j)} * width + x * n + i) + c];
                out.rgba[4 * (size_t{y} * out.width + x) + c] = static_cast<uint8_t>((sum + n * n / 2) / (n * n));
            }
        }
    }
    return out;
}

Result<FrameImage> GlesReferenceRenderer::draw(const Camera& camera) {
    context_->make_current();
    const auto start = std::chrono::steady_clock::now();
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    glViewport(0, 0, static_cast<GLsizei>(options_.width * options_.supersample),
               static_cast<GLsizei>(options_.height * options_.supersample));
    const auto clip_control = reinterpret_cast<PFNGLCLIPCONTROLEXTPROC>(eglGetProcAddress("glClipControlEXT"));
    clip_control(GL_LOWER_LEFT_EXT, GL_ZERO_TO_ONE_EXT);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glDisable(GL_CULL_FACE);
    const auto& b = options_.background;
    const bool sky = b[0] < 0;
    glClearColor(sky ? static_cast<float>(SKY_R) : b[0], sky ? static_cast<float>(SKY_G) : b[1],
                 sky ? static_cast<float>(SKY_B) : b[2], 1);
    glClearDepthf(0);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glUseProgram(program_);
    glBindVertexArray(vertex_array_);
    glActiveTexture(GL_TEXTURE0);
    set_camera(camera);
    std::array<double, 3> eye{};
    for (size_t axis = 0; axis < 3; ++axis) eye[axis] = camera.position[axis] - scene_.origin[axis];
    triangles_drawn_ = 0;
    const Frustum frustum = frustum_of(camera);
    for (const GlbDraw& mesh : scene_.draws) draw_mesh(mesh, eye, frustum);
    glFinish();
    last_frame_ms_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    if (glGetError() != GL_NO_ERROR) return Error{"the reference renderer failed to draw a frame"};
    return read_back();
}

}  // namespace

Result<std::unique_ptr<ReferenceRenderer>> ReferenceRenderer::create(const std::string& glb_path,
                                                                     const ReferenceOptions& options) {
    auto scene = load_glb(glb_path);
    if (!scene) return scene.error();
    auto context = GlesContext::create();
    if (!context) return context.error();
    auto renderer =
        std::make_unique<GlesReferenceRenderer>(std::move(context).value(), std::move(scene).value(), options);
    if (Status status = renderer->initialise(); !status) return status.error();
    return std::unique_ptr<ReferenceRenderer>(std::move(renderer));
}

}  // namespace citystream::client
