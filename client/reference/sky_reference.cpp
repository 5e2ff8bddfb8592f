#include "client/reference/sky_reference.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>

#include "client/render/tone.h"
#include "codec/vector.h"
#include "tiles/radiance/in_parallel.h"

namespace citystream::client {

namespace {

constexpr uint32_t kBundle = 16;
using codec::cross;

constexpr float kEndless = std::numeric_limits<float>::infinity();

struct DeviceDeleter {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneDeleter {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};

Direction operator+(const Direction& a, const Direction& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Direction operator*(double s, const Direction& a) {
    return {s * a[0], s * a[1], s * a[2]};
}
Direction unit(const Direction& a) {
    return 1 / std::sqrt(dot(a, a)) * a;
}

/// SplitMix64 (Steele, Lea and Flood 2014).
uint64_t mixed(uint64_t z) {
    z += 0x9e3779b97f4a7c15U;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9U;
    z = (z ^ z >> 27) * 0x94d049bb133111ebU;
    return z ^ z >> 31;
}
/// 0..1, the ends left out.
double fraction(uint64_t bits) {
    return (static_cast<double>(bits >> 32) + 0.5) / 4294967296.0;
}

/// Unit vectors that make a right-handed frame with a unit normal (Duff et al., Building an Orthonormal Basis,
/// Revisited, 2017).
std::array<Direction, 2> tangents_of(const Direction& n) {
    const double sign = std::copysign(1.0, n[2]), a = -1 / (sign + n[2]), b = n[0] * n[1] * a;
    return {{{1 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]}, {b, sign + n[1] * n[1] * a, -n[1]}}};
}

/// A point of the disc of radius 1 that belongs to a jittered place in cell `ray` of a square of across^2 (Shirley and
/// Chiu 1997).
struct DiscPoint {
    double radius = 0, phi = 0;
};
DiscPoint disc_point(uint32_t ray, uint32_t across, uint64_t seed) {
    const uint64_t first = mixed(seed ^ mixed(ray));
    const double x = 2 * (ray % across + fraction(first)) / across - 1;
    const double y = 2 * (ray / across + fraction(mixed(first))) / across - 1;
    if (std::abs(x) > std::abs(y)) return {x, std::numbers::pi / 4 * (y / x)};
    if (y != 0) return {y, std::numbers::pi / 2 - std::numbers::pi / 4 * (x / y)};
    return {};
}

}  // namespace

Direction cosine_direction(const Direction& normal, uint32_t ray, uint32_t across, uint64_t seed) {
    const auto [radius, phi] = disc_point(ray, across, seed);
    const auto [tangent, bitangent] = tangents_of(normal);
    const double up = std::sqrt(std::max(0.0, 1 - radius * radius));
    return radius * std::cos(phi) * tangent + radius * std::sin(phi) * bitangent + up * normal;
}

struct SkyReference::State {
    /// Triangles that instances share; Embree holds their arrays.
    struct Piece {
        std::unique_ptr<RTCSceneTy, SceneDeleter> scene;
        const float* points = nullptr;      ///< 3 a vertex
        const uint32_t* corners = nullptr;  ///< 3 a triangle
        size_t triangles = 0;
        std::vector<Rgb> albedo;  ///< of each triangle, or one of all
    };
    struct Instance {
        size_t piece = 0;
        GlbTransform transform{};
    };

    std::unique_ptr<RTCDeviceTy, DeviceDeleter> device;
    std::vector<Piece> pieces;
    std::vector<Instance> instances;
    std::unique_ptr<RTCSceneTy, SceneDeleter> scene;  ///< of instances: geometry i is instance i
    std::array<double, 3> origin{};

    Status open();
    Status add_piece(size_t vertices, size_t triangles, std::vector<Rgb> albedo,
                     const std::function<void(float* points, uint32_t* corners)>& fill);
    Status commit();
    Status status(const char* what) const;

    /// Bit i: something is in direction i's way.
    uint32_t occluded(const Direction& from, std::span<const Direction> directions) const;
    /// The nearest triangle, and how far.
    struct Hit {
        bool met = false;
        uint32_t instance = 0, triangle = 0;
        double distance = 0;
    };
    Hit nearest(const Direction& from, const Direction& direction) const;
    std::array<Direction, 3> corners_of(const Hit& hit) const;
    const Rgb& albedo_of(const Hit& hit) const {
        const std::vector<Rgb>& albedo = pieces[instances[hit.instance].piece].albedo;
        return albedo[albedo.size() == 1 ? 0 : hit.triangle];
    }
};

Status SkyReference::State::status(const char* what) const {
    const RTCError error = rtcGetDeviceError(device.get());
    if (error == RTC_ERROR_NONE) return Done{};
    return Error{std::string("Embree: error ") + std::to_string(error) + " while " + what + " was built"};
}

Status SkyReference::State::open() {
    device.reset(rtcNewDevice(nullptr));
    if (!device) return Error{"Embree: no device (error " + std::to_string(rtcGetDeviceError(nullptr)) + ")"};
    scene.reset(rtcNewScene(device.get()));
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    return Done{};
}

Status SkyReference::State::add_piece(size_t vertices, size_t triangles, std::vector<Rgb> albedo,
                                      const std::function<void(float* points, uint32_t* corners)>& fill) {
    Piece& piece = pieces.emplace_back();
    piece.albedo = std::move(albedo);
    piece.triangles = triangles;
    piece.scene.reset(rtcNewScene(device.get()));
    rtcSetSceneFlags(piece.scene.get(), RTC_SCENE_FLAG_ROBUST);
    if (triangles > 0) {
        RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* const points = static_cast<float*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices));
        auto* const corners = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), triangles));
        if (points != nullptr && corners != nullptr) fill(points, corners);
        piece.points = points;
        piece.corners = corners;
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(piece.scene.get(), geometry);
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(piece.scene.get());
    return status("a scene's part");
}

Status SkyReference::State::commit() {
    for (const Instance& instance : instances) {
        RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(geometry, pieces[instance.piece].scene.get());
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, instance.transform.data());
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene.get(), geometry);
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene.get());
    return status("a scene");
}

Result<SkyReference> SkyReference::create(std::span<const ReferenceTriangle> triangles,
                                          const std::array<double, 3>& origin) {
    auto state = std::make_unique<State>();
    state->origin = origin;
    if (const Status opened = state->open(); !opened) return opened.error();
    std::vector<Rgb> albedo;
    albedo.reserve(triangles.size());
    for (const ReferenceTriangle& triangle : triangles) albedo.push_back(triangle.albedo);
    const auto fill = [&](float* points, uint32_t* corners) {
        for (size_t i = 0; i < 3 * triangles.size(); ++i) {
            for (size_t c = 0; c < 3; ++c) points[3 * i + c] = static_cast<float>(triangles[i / 3].corners[i % 3][c]);
            corners[i] = static_cast<uint32_t>(i);
        }
    };
    const Status added = state->add_piece(3 * triangles.size(), triangles.size(), std::move(albedo), fill);
    if (!added) return added.error();
    state->instances.push_back({0, {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}});
    if (const Status whole = state->commit(); !whole) return whole.error();
    return SkyReference(std::move(state));
}

Result<SkyReference> SkyReference::create(const GlbScene& scene, const Rgb& albedo) {
    auto state = std::make_unique<State>();
    state->origin = scene.origin;
    if (const Status opened = state->open(); !opened) return opened.error();
    for (const GlbGeometry& geometry : scene.geometries) {
        const auto fill = [&](float* points, uint32_t* corners) {
            for (const GlbVertex& vertex : geometry.vertices) points = std::copy_n(vertex.position, 3, points);
            std::copy_n(geometry.indices.begin(), geometry.indices.size() / 3 * 3, corners);
        };
        const Status added = state->add_piece(geometry.vertices.size(), geometry.indices.size() / 3, {albedo}, fill);
        if (!added) return added.error();
    }
    for (const GlbDraw& draw : scene.draws) {
        for (const GlbTransform& transform : draw.instances) {
            for (const GlbPrimitive& primitive : scene.meshes[draw.mesh])
                state->instances.push_back({primitive.geometry, transform});
        }
    }
    if (const Status whole = state->commit(); !whole) return whole.error();
    return SkyReference(std::move(state));
}

uint64_t SkyReference::triangles() const {
    uint64_t count = 0;
    for (const State::Instance& instance : state_->instances) count += state_->pieces[instance.piece].triangles;
    return count;
}

SkyReference::SkyReference(std::unique_ptr<State> state) : state_(std::move(state)) {}
SkyReference::~SkyReference() = default;
SkyReference::SkyReference(SkyReference&&) noexcept = default;
SkyReference& SkyReference::operator=(SkyReference&&) noexcept = default;

uint32_t SkyReference::State::occluded(const Direction& from, std::span<const Direction> directions) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    alignas(64) std::array<int32_t, kBundle> valid{};
    RTCRay16 rays{};
    for (size_t i = 0; i < directions.size(); ++i) {
        valid[i] = -1;
        rays.org_x[i] = static_cast<float>(from[0]);
        rays.org_y[i] = static_cast<float>(from[1]);
        rays.org_z[i] = static_cast<float>(from[2]);
        rays.dir_x[i] = static_cast<float>(directions[i][0]);
        rays.dir_y[i] = static_cast<float>(directions[i][1]);
        rays.dir_z[i] = static_cast<float>(directions[i][2]);
        rays.tfar[i] = kEndless;
        rays.mask[i] = ~0U;
    }
    rtcOccluded16(valid.data(), scene.get(), &context, &rays);
    uint32_t hit = 0;
    for (size_t i = 0; i < directions.size(); ++i) hit |= rays.tfar[i] < 0 ? 1U << i : 0;
    return hit;
}

SkyReference::State::Hit SkyReference::State::nearest(const Direction& from, const Direction& direction) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit ray{};
    ray.ray.org_x = static_cast<float>(from[0]);
    ray.ray.org_y = static_cast<float>(from[1]);
    ray.ray.org_z = static_cast<float>(from[2]);
    ray.ray.dir_x = static_cast<float>(direction[0]);
    ray.ray.dir_y = static_cast<float>(direction[1]);
    ray.ray.dir_z = static_cast<float>(direction[2]);
    ray.ray.tfar = kEndless;
    ray.ray.mask = ~0U;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene.get(), &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return {true, ray.hit.instID[0], ray.hit.primID, double{ray.ray.tfar}};
}

/// Metres from the origin.
std::array<Direction, 3> SkyReference::State::corners_of(const Hit& hit) const {
    const auto& [number, m] = instances[hit.instance];
    const Piece& piece = pieces[number];
    std::array<Direction, 3> result;
    for (size_t k = 0; k < 3; ++k) {
        const float* const p = piece.points + size_t{3} * piece.corners[size_t{3} * hit.triangle + k];
        for (size_t c = 0; c < 3; ++c)
            result[k][c] = double{m[c]} * p[0] + double{m[3 + c]} * p[1] + double{m[6 + c]} * p[2] + double{m[9 + c]};
    }
    return result;
}

LightSum SkyReference::irradiance(const Direction& point, const Direction& normal, const EnvironmentMap& environment,
                                  uint32_t across, uint64_t seed) const {
    const Direction from = point + kRayLift * normal;
    const uint32_t count = across * across;
    LightSum sum{};
    std::array<Direction, kBundle> directions;
    for (uint32_t first = 0; first < count; first += kBundle) {
        const uint32_t size = std::min(kBundle, count - first);
        for (uint32_t i = 0; i < size; ++i) directions[i] = cosine_direction(normal, first + i, across, seed);
        const uint32_t hidden = state_->occluded(from, {directions.data(), size});
        for (uint32_t i = 0; i < size; ++i) {
            if ((hidden >> i & 1) != 0) continue;
            const Rgb light = environment.radiance(directions[i]);
            for (size_t c = 0; c < 3; ++c) sum[c] += light[c];
        }
    }
    for (double& channel : sum) channel *= std::numbers::pi / count;
    return sum;
}

LightSum SkyReference::sun_irradiance(const Direction& point, const Direction& normal, const Sun& sun, uint32_t across,
                                      uint64_t seed) const {
    const Direction from = point + kRayLift * normal;
    const auto [tangent, bitangent] = tangents_of(sun.direction);
    const double spread = std::tan(sun.angular_radius);
    const uint32_t count = across * across;
    double share = 0;
    std::array<Direction, kBundle> directions;
    for (uint32_t first = 0; first < count; first += kBundle) {
        const uint32_t size = std::min(kBundle, count - first);
        for (uint32_t i = 0; i < size; ++i) {
            const auto [radius, phi] = disc_point(first + i, across, seed);
            const double aside = spread * radius;
            directions[i] = unit(sun.direction + aside * std::cos(phi) * tangent + aside * std::sin(phi) * bitangent);
        }
        const uint32_t hidden = state_->occluded(from, {directions.data(), size});
        for (uint32_t i = 0; i < size; ++i)
            share += (hidden >> i & 1) != 0 ? 0 : std::max(0.0, dot(directions[i], normal)) / count;
    }
    return {share * sun.irradiance[0], share * sun.irradiance[1], share * sun.irradiance[2]};
}

/// What all pixels of a picture have in common.
struct SkyReference::View {
    const Camera& camera;
    const ReferenceLight& light;
    const SkyRays& rays;
    const FrameImage* albedo;
    Direction from;  ///< metres from the origin
    double height;   ///< of the picture at distance 1

    /// Through a place of a pixel: unit vector.
    Direction direction(double column, double row) const {
        const double step = height / camera.height, half_width = height / 2 * camera.width / camera.height;
        return unit(camera.forward + (column * step - half_width) * camera.right +
                    (height / 2 - row * step) * camera.up);
    }
    /// Where no surface is met.
    LightSum seen(const Direction& direction) const {
        const Rgb map = light.background->radiance(direction);
        LightSum sum = {map[0], map[1], map[2]};
        if (!light.sun || !light.sun_is_seen || direction[2] < 0) return sum;
        if (angle_between(direction, light.sun->direction) > light.sun->angular_radius) return sum;
        const double solid_angle = 2 * std::numbers::pi * (1 - std::cos(light.sun->angular_radius));
        for (size_t c = 0; c < 3; ++c) sum[c] += light.sun->irradiance[c] / solid_angle;
        return sum;
    }
    /// Of a place of a pixel that meets a surface.
    Rgb albedo_at(uint32_t column, uint32_t row, const Rgb& of_triangle) const {
        if (albedo == nullptr) return of_triangle;
        const uint8_t* const texel = &albedo->rgba[4 * (size_t{row} * albedo->width + column)];
        Rgb result{};
        for (size_t c = 0; c < 3; ++c) result[c] = static_cast<float>(srgb_decoded(texel[c] / 255.0));
        return result;
    }
};

SkyReference::Pixel SkyReference::pixel(const View& view, uint32_t x, uint32_t y) const {
    const uint32_t across = view.rays.pixel_across;
    Pixel result;
    LightSum& sum = result.radiance;
    for (uint32_t part = 0; part < across * across; ++part) {
        const uint32_t column = part % across, row = part / across;
        const Direction direction = view.direction(x + (column + 0.5) / across, y + (row + 0.5) / across);
        const State::Hit hit = state_->nearest(view.from, direction);
        if (!hit.met) {
            const LightSum light = view.seen(direction);
            for (size_t c = 0; c < 3; ++c) sum[c] += light[c];
            result.surface = false;
            continue;
        }
        const auto corners = state_->corners_of(hit);
        Direction normal = unit(cross(corners[1] + -1.0 * corners[0], corners[2] + -1.0 * corners[0]));
        if (dot(normal, direction) > 0) normal = -1.0 * normal;
        // On the triangle's plane, exactly: a float's distance may be behind it.
        const Direction about = view.from + hit.distance * direction;
        const Direction point = about + dot(corners[0] + -1.0 * about, normal) * normal;
        const uint64_t seed = mixed((uint64_t{y} * view.camera.width + x) << 8 | part);
        LightSum light = irradiance(point, normal, *view.light.sky, view.rays.across, seed);
        if (view.light.sun) {
            const LightSum sun = sun_irradiance(point, normal, *view.light.sun, view.rays.sun_across, mixed(seed));
            for (size_t c = 0; c < 3; ++c) light[c] += sun[c];
        }
        const Rgb albedo = view.albedo_at(x * across + column, y * across + row, state_->albedo_of(hit));
        for (size_t c = 0; c < 3; ++c) sum[c] += albedo[c] / std::numbers::pi * light[c];
    }
    for (double& channel : sum) channel /= across * across;
    return result;
}

RadiancePicture SkyReference::draw(const Camera& camera, const ReferenceLight& light, const SkyRays& rays,
                                   const FrameImage* albedo) const {
    const size_t size = size_t{camera.width} * camera.height;
    RadiancePicture picture{camera.width, camera.height, std::vector<Rgb>(size), std::vector<uint8_t>(size)};
    const View view{
        camera, light, rays, albedo, camera.position + -1.0 * state_->origin, 2 * std::tan(camera.fov_y / 2)};
    tiles::radiance::in_parallel(camera.height, rays.jobs, [&](size_t row) {
        const auto y = static_cast<uint32_t>(row);
        for (uint32_t x = 0; x < camera.width; ++x) {
            const Pixel shaded = pixel(view, x, y);
            const size_t place = row * camera.width + x;
            for (size_t c = 0; c < 3; ++c) picture.pixels[place][c] = static_cast<float>(shaded.radiance[c]);
            picture.surface[place] = shaded.surface ? 1 : 0;
        }
        return true;
    });
    return picture;
}

FrameImage shown_picture(const RadiancePicture& picture, double exposure) {
    FrameImage image{picture.width, picture.height, {}};
    for (const Rgb& pixel : picture.pixels) {
        const auto shown = shown_light({exposure * pixel[0], exposure * pixel[1], exposure * pixel[2]});
        for (const double channel : shown) image.rgba.push_back(static_cast<uint8_t>(std::lround(255 * channel)));
        image.rgba.push_back(255);
    }
    return image;
}

}  // namespace citystream::client
