#include "tests/bench/sky_reference.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "client/render/tone.h"
#include "tiles/radiance/in_parallel.h"

namespace citystream::bench {

using client::Direction;
using client::LightSum;
using client::Rgb;

namespace {

constexpr uint32_t kBundle = 16;
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
Direction cross(const Direction& a, const Direction& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Direction unit(const Direction& a) {
    return 1 / std::sqrt(client::dot(a, a)) * a;
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

}  // namespace

std::vector<ReferenceTriangle> reference_triangles(const client::GlbScene& scene, const Rgb& albedo) {
    std::vector<ReferenceTriangle> triangles;
    const auto add = [&](const client::GlbGeometry& geometry, const client::GlbTransform& m) {
        for (size_t i = 0; i + 2 < geometry.indices.size(); i += 3) {
            ReferenceTriangle triangle;
            for (size_t k = 0; k < 3; ++k) {
                const float* const p = geometry.vertices[geometry.indices[i + k]].position;
                for (size_t c = 0; c < 3; ++c)
                    triangle.corners[k][c] =
                        double{m[c]} * p[0] + double{m[3 + c]} * p[1] + double{m[6 + c]} * p[2] + double{m[9 + c]};
            }
            triangle.albedo = albedo;
            triangles.push_back(triangle);
        }
    };
    for (const client::GlbDraw& draw : scene.draws) {
        for (const client::GlbTransform& instance : draw.instances) {
            for (const client::GlbPrimitive& primitive : scene.meshes[draw.mesh])
                add(scene.geometries[primitive.geometry], instance);
        }
    }
    return triangles;
}

Direction cosine_direction(const Direction& normal, uint32_t ray, uint32_t across, uint64_t seed) {
    const uint64_t first = mixed(seed ^ mixed(ray));
    const double x = 2 * (ray % across + fraction(first)) / across - 1;
    const double y = 2 * (ray / across + fraction(mixed(first))) / across - 1;
    double radius = 0, phi = 0;
    if (std::abs(x) > std::abs(y)) {
        radius = x;
        phi = std::numbers::pi / 4 * (y / x);
    } else if (y != 0) {
        radius = y;
        phi = std::numbers::pi / 2 - std::numbers::pi / 4 * (x / y);
    }
    const auto [tangent, bitangent] = tangents_of(normal);
    const double up = std::sqrt(std::max(0.0, 1 - radius * radius));
    return radius * std::cos(phi) * tangent + radius * std::sin(phi) * bitangent + up * normal;
}

struct SkyReference::State {
    std::unique_ptr<RTCDeviceTy, DeviceDeleter> device;
    std::unique_ptr<RTCSceneTy, SceneDeleter> scene;
    std::vector<ReferenceTriangle> triangles;
    std::array<double, 3> origin{};

    /// Bit i: something is in direction i's way.
    uint32_t occluded(const Direction& from, std::span<const Direction> directions) const;
    /// Number of the nearest triangle, or none, and how far.
    struct Hit {
        uint32_t triangle = RTC_INVALID_GEOMETRY_ID;
        double distance = 0;
    };
    Hit nearest(const Direction& from, const Direction& direction) const;
};

Result<SkyReference> SkyReference::create(std::span<const ReferenceTriangle> triangles,
                                          const std::array<double, 3>& origin) {
    auto state = std::make_unique<State>();
    state->triangles.assign(triangles.begin(), triangles.end());
    state->origin = origin;
    state->device.reset(rtcNewDevice(nullptr));
    if (!state->device) return Error{"Embree: no device (error " + std::to_string(rtcGetDeviceError(nullptr)) + ")"};
    state->scene.reset(rtcNewScene(state->device.get()));
    rtcSetSceneFlags(state->scene.get(), RTC_SCENE_FLAG_ROBUST);
    if (!triangles.empty()) {
        RTCGeometry geometry = rtcNewGeometry(state->device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* const points = static_cast<float*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3 * triangles.size()));
        auto* const corners = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), triangles.size()));
        for (size_t i = 0; points != nullptr && corners != nullptr && i < 3 * triangles.size(); ++i) {
            for (size_t c = 0; c < 3; ++c) points[3 * i + c] = static_cast<float>(triangles[i / 3].corners[i % 3][c]);
            corners[i] = static_cast<uint32_t>(i);
        }
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(state->scene.get(), geometry);
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(state->scene.get());
    if (const RTCError error = rtcGetDeviceError(state->device.get()); error != RTC_ERROR_NONE)
        return Error{"Embree: error " + std::to_string(error) + " while a scene of " +
                     std::to_string(triangles.size()) + " triangles was built"};
    return SkyReference(std::move(state));
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
    return {ray.hit.primID, double{ray.ray.tfar}};
}

LightSum SkyReference::irradiance(const Direction& point, const Direction& normal,
                                  const client::EnvironmentMap& environment, uint32_t across, uint64_t seed) const {
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

SkyReference::Pixel SkyReference::pixel(const client::Camera& camera, const client::EnvironmentMap& environment,
                                        const SkyRays& rays, uint32_t x, uint32_t y) const {
    const double height = 2 * std::tan(camera.fov_y / 2), step = height / camera.height;
    const double half_width = height / 2 * camera.width / camera.height;
    const Direction from = camera.position + -1.0 * state_->origin;
    Pixel result;
    LightSum& sum = result.radiance;
    for (uint32_t part = 0; part < rays.pixel_across * rays.pixel_across; ++part) {
        const double column = x + (part % rays.pixel_across + 0.5) / rays.pixel_across;
        const double row = y + (part / rays.pixel_across + 0.5) / rays.pixel_across;
        const Direction direction =
            unit(camera.forward + (column * step - half_width) * camera.right + (height / 2 - row * step) * camera.up);
        const State::Hit hit = state_->nearest(from, direction);
        if (hit.triangle == RTC_INVALID_GEOMETRY_ID) {
            const Rgb light = environment.radiance(direction);
            for (size_t c = 0; c < 3; ++c) sum[c] += light[c];
            result.surface = false;
            continue;
        }
        const auto& [corners, albedo] = state_->triangles[hit.triangle];
        Direction normal = unit(cross(corners[1] + -1.0 * corners[0], corners[2] + -1.0 * corners[0]));
        if (client::dot(normal, direction) > 0) normal = -1.0 * normal;
        // On the triangle's plane, exactly: a float's distance may be behind it.
        const Direction about = from + hit.distance * direction;
        const Direction point = about + client::dot(corners[0] + -1.0 * about, normal) * normal;
        const uint64_t seed = mixed((uint64_t{y} * camera.width + x) << 8 | part);
        const LightSum light = irradiance(point, normal, environment, rays.across, seed);
        for (size_t c = 0; c < 3; ++c) sum[c] += albedo[c] / std::numbers::pi * light[c];
    }
    for (double& channel : sum) channel /= rays.pixel_across * rays.pixel_across;
    return result;
}

RadiancePicture SkyReference::draw(const client::Camera& camera, const client::EnvironmentMap& environment,
                                   const SkyRays& rays) const {
    const size_t size = size_t{camera.width} * camera.height;
    RadiancePicture picture{camera.width, camera.height, std::vector<Rgb>(size), std::vector<uint8_t>(size)};
    tiles::radiance::in_parallel(camera.height, rays.jobs, [&](size_t row) {
        const auto y = static_cast<uint32_t>(row);
        for (uint32_t x = 0; x < camera.width; ++x) {
            const Pixel shaded = pixel(camera, environment, rays, x, y);
            const size_t place = row * camera.width + x;
            for (size_t c = 0; c < 3; ++c) picture.pixels[place][c] = static_cast<float>(shaded.radiance[c]);
            picture.surface[place] = shaded.surface ? 1 : 0;
        }
        return true;
    });
    return picture;
}

client::FrameImage shown_picture(const RadiancePicture& picture, double exposure) {
    client::FrameImage image{picture.width, picture.height, {}};
    for (const Rgb& pixel : picture.pixels) {
        const auto shown = client::shown_light({exposure * pixel[0], exposure * pixel[1], exposure * pixel[2]});
        for (const double channel : shown) image.rgba.push_back(static_cast<uint8_t>(std::lround(255 * channel)));
        image.rgba.push_back(255);
    }
    return image;
}

}  // namespace citystream::bench
