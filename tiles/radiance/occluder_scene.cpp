#include "tiles/radiance/occluder_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "codec/radiance/source_directions.h"
#include "tiles/radiance/horizon_mesh.h"

namespace citystream::tiles::radiance {

namespace {

struct DeviceRelease {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<RTCDeviceTy, DeviceRelease>;
using Scene = std::unique_ptr<RTCSceneTy, SceneRelease>;

/// Two sides of coincident surfaces come out at distances that differ by rounding: metres.
constexpr float kSameDistance = 1.0F / 512;

/// What nearest_side asks of Embree: every triangle on the way is noted and none ends it, so that the answer does not
/// depend on the order in which they are met.
struct SideQuery {
    explicit SideQuery(const RayDirection& along) : context{}, direction(along) { rtcInitIntersectContext(&context); }
    float nearest() const { return std::min(front, back); }

    RTCIntersectContext context;  ///< first: Embree hands a pointer to it back
    RayDirection direction;
    float front = std::numeric_limits<float>::infinity(), back = std::numeric_limits<float>::infinity();
};

void note_side(const RTCFilterFunctionNArguments* arguments) {
    auto* const query = reinterpret_cast<SideQuery*>(arguments->context);
    arguments->valid[0] = 0;
    RTCHitN* const hit = arguments->hit;
    const float along = query->direction[0] * RTCHitN_Ng_x(hit, 1, 0) + query->direction[1] * RTCHitN_Ng_y(hit, 1, 0) +
                        query->direction[2] * RTCHitN_Ng_z(hit, 1, 0);
    const float distance = RTCRayN_tfar(arguments->ray, 1, 0);
    if (along < 0) query->front = std::min(query->front, distance);
    if (along > 0) query->back = std::min(query->back, distance);
}

float metres(int64_t grid) {
    return static_cast<float>(to_metres(grid));
}

/// Points about the origin, in metres: exact below 2^24 grid units.
Scene build_scene(RTCDevice device, std::span<const GridPoint> points,
                  std::span<const std::array<uint32_t, 3>> triangles, const GridPoint& origin) {
    Scene scene(rtcNewScene(device));
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    if (!triangles.empty()) {
        const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        auto* vertex = static_cast<float*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), points.size()));
        auto* index = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), triangles.size()));
        if (vertex != nullptr && index != nullptr) {
            for (const GridPoint& point : points) {
                *vertex++ = metres(point.x - origin.x);
                *vertex++ = metres(point.y - origin.y);
                *vertex++ = metres(point.z - origin.z);
            }
            for (const auto& triangle : triangles) index = std::copy(triangle.begin(), triangle.end(), index);
            rtcSetGeometryIntersectFilterFunction(geometry, note_side);
            rtcCommitGeometry(geometry);
            rtcAttachGeometry(scene.get(), geometry);
        }
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene.get());
    return scene;
}

}  // namespace

StartBox widened(const StartBox& box, double metres) {
    const int64_t margin = to_grid(metres) + kLiftOff;
    return {{box.low.x - margin, box.low.y - margin, box.low.z},
            {box.high.x + margin, box.high.y + margin, box.high.z}};
}

bool meets(const SurfaceTriangle& triangle, const StartBox& box) {
    const auto& [p, q, r] = triangle.corners;
    return std::min({p.x, q.x, r.x}) <= box.high.x && std::max({p.x, q.x, r.x}) >= box.low.x &&
           std::min({p.y, q.y, r.y}) <= box.high.y && std::max({p.y, q.y, r.y}) >= box.low.y;
}

struct OccluderScene::State {
    Device device;
    Scene near, far;
    GridPoint origin;
    OccluderReach reach;
    bool has_far = false;
    int64_t highest = std::numeric_limits<int64_t>::min();  ///< of what is on the horizon
    /// The cells that rays can reach, for the question whether a ray is inside of one where the horizon begins.
    std::optional<HeightGrid> heights;

    bool begins_inside(const GridPoint& from, const RayDirection& direction) const;
    uint32_t near_blocked(const GridPoint& from, std::span<const RayDirection> directions) const;
    uint32_t far_blocked(const GridPoint& from, std::span<const RayDirection> directions, uint32_t asked) const;
    uint32_t trace(RTCScene scene, const GridPoint& from, std::span<const RayDirection> directions, uint32_t asked,
                   float begin, float end) const;
    SideQuery sides(const GridPoint& from, const RayDirection& direction) const;
};

Result<OccluderScene> OccluderScene::create(std::span<const SurfaceTriangle> triangles, const HeightGrid* heights,
                                            const StartBox& start, const OccluderReach& reach) {
    auto state = std::make_unique<State>();
    // Tiles are baked side by side, each with a scene of its own: one thread builds it.
    state->device.reset(rtcNewDevice("threads=1"));
    if (!state->device) return Error{"Embree: no device (error " + std::to_string(rtcGetDeviceError(nullptr)) + ")"};
    state->origin = start.low;
    state->reach = reach;

    const StartBox in_reach = widened(start, reach.triangles);
    std::vector<GridPoint> points;
    std::vector<std::array<uint32_t, 3>> corners;
    for (const SurfaceTriangle& triangle : triangles) {
        if (!meets(triangle, in_reach)) continue;
        const auto first = static_cast<uint32_t>(points.size());
        points.insert(points.end(), triangle.corners.begin(), triangle.corners.end());
        corners.push_back({first, first + 1, first + 2});
    }
    state->near = build_scene(state->device.get(), points, corners, state->origin);

    if (heights != nullptr && reach.horizon > reach.triangles) {
        const StartBox far = widened(start, reach.horizon);
        const HeightCell low = height_cell_of(far.low.x, far.low.y), high = height_cell_of(far.high.x, far.high.y);
        const HorizonMesh mesh = horizon_mesh(*heights, low, high);
        state->has_far = !mesh.triangles.empty();
        state->far = build_scene(state->device.get(), mesh.points, mesh.triangles, state->origin);
        for (const GridPoint& point : mesh.points) state->highest = std::max(state->highest, point.z);
        state->heights = heights->part(low, high);
    }
    if (const RTCError error = rtcGetDeviceError(state->device.get()); error != RTC_ERROR_NONE) {
        return Error{"Embree: error " + std::to_string(error) + " while a scene of " + std::to_string(corners.size()) +
                     " triangles was built"};
    }
    return OccluderScene(std::move(state));
}

OccluderScene::OccluderScene(std::unique_ptr<State> state) : state_(std::move(state)) {}
OccluderScene::~OccluderScene() = default;
OccluderScene::OccluderScene(OccluderScene&&) noexcept = default;
OccluderScene& OccluderScene::operator=(OccluderScene&&) noexcept = default;

const OccluderReach& OccluderScene::reach() const {
    return state_->reach;
}

void OccluderScene::blocked(const GridPoint& from, std::span<const RayDirection> directions,
                            std::span<uint64_t> blocked) const {
    std::fill(blocked.begin(), blocked.end(), 0);
    for (size_t first = 0; first < directions.size(); first += kBundle) {
        const auto bundle = directions.subspan(first, std::min(kBundle, directions.size() - first));
        const uint32_t all = (uint32_t{1} << bundle.size()) - 1;
        uint32_t hit = state_->near_blocked(from, bundle);
        if (hit != all) hit |= state_->far_blocked(from, bundle, all & ~hit);
        blocked[first / 64] |= uint64_t{hit} << first % 64;
    }
}

uint32_t OccluderScene::State::near_blocked(const GridPoint& from, std::span<const RayDirection> directions) const {
    const uint32_t all = (uint32_t{1} << directions.size()) - 1;
    return trace(near.get(), from, directions, all, 0, static_cast<float>(reach.triangles));
}

uint32_t OccluderScene::State::far_blocked(const GridPoint& from, std::span<const RayDirection> directions,
                                           uint32_t asked) const {
    if (!has_far) return 0;
    uint32_t low = 0, inside = 0;
    for (size_t i = 0; i < directions.size(); ++i) {
        if ((asked >> i & 1) == 0) continue;
        const double z = static_cast<double>(from.z) + reach.triangles * kGridUnitsPerMetre * directions[i][2];
        if (directions[i][2] >= 0 && z > static_cast<double>(highest)) continue;
        if (begins_inside(from, directions[i])) {
            inside |= 1U << i;
        } else {
            low |= 1U << i;
        }
    }
    if (low == 0) return inside;
    return inside | trace(far.get(), from, directions, low, static_cast<float>(reach.triangles),
                          static_cast<float>(reach.horizon));
}

/// Whether the ray is below a cell's top where the horizon begins. In coordinates from the cell in which the ray
/// starts, so that the city's place does not matter.
bool OccluderScene::State::begins_inside(const GridPoint& from, const RayDirection& direction) const {
    const HeightCell cell = height_cell_of(from.x, from.y);
    const double way = reach.triangles * kGridUnitsPerMetre;
    const double x = static_cast<double>(from.x - cell.x * kHeightCell) + way * direction[0];
    const double y = static_cast<double>(from.y - cell.y * kHeightCell) + way * direction[1];
    const auto cell_side = static_cast<double>(kHeightCell);
    const auto height = heights->height({cell.x + static_cast<int64_t>(std::floor(x / cell_side)),
                                         cell.y + static_cast<int64_t>(std::floor(y / cell_side))});
    return height && way * direction[2] < static_cast<double>(*height - from.z);
}

uint32_t OccluderScene::State::trace(RTCScene scene, const GridPoint& from, std::span<const RayDirection> directions,
                                     uint32_t asked, float begin, float end) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    const std::array<float, 3> start = {metres(from.x - origin.x), metres(from.y - origin.y),
                                        metres(from.z - origin.z)};
    alignas(64) std::array<int32_t, kBundle> valid{};
    RTCRay16 rays;
    std::fill_n(rays.org_x, kBundle, start[0]);
    std::fill_n(rays.org_y, kBundle, start[1]);
    std::fill_n(rays.org_z, kBundle, start[2]);
    std::fill_n(rays.tnear, kBundle, begin);
    std::fill_n(rays.tfar, kBundle, end);
    std::fill_n(rays.time, kBundle, 0.0F);
    std::fill_n(rays.mask, kBundle, ~0U);
    std::fill_n(rays.flags, kBundle, 0U);
    for (size_t i = 0; i < kBundle; ++i) {
        const bool there = i < directions.size();
        valid[i] = there && (asked >> i & 1) != 0 ? -1 : 0;
        const RayDirection& direction = directions[there ? i : 0];
        rays.dir_x[i] = direction[0];
        rays.dir_y[i] = direction[1];
        rays.dir_z[i] = direction[2];
    }
    rtcOccluded16(valid.data(), scene, &context, &rays);
    uint32_t hit = 0;
    for (size_t i = 0; i < directions.size(); ++i) {
        if (valid[i] != 0 && rays.tfar[i] < 0) hit |= 1U << i;
    }
    return hit;
}

SideQuery OccluderScene::State::sides(const GridPoint& from, const RayDirection& direction) const {
    SideQuery query(direction);
    RTCRayHit ray{};
    ray.ray.org_x = metres(from.x - origin.x);
    ray.ray.org_y = metres(from.y - origin.y);
    ray.ray.org_z = metres(from.z - origin.z);
    ray.ray.dir_x = direction[0];
    ray.ray.dir_y = direction[1];
    ray.ray.dir_z = direction[2];
    ray.ray.tfar = static_cast<float>(reach.triangles);
    ray.ray.mask = ~0U;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(near.get(), &query.context, &ray);
    return query;
}

OccluderScene::Side OccluderScene::nearest_side(const GridPoint& from, const RayDirection& direction) const {
    const SideQuery query = state_->sides(from, direction);
    if (std::isinf(query.nearest())) return Side::kNothing;
    if (query.nearest() < metres(kLiftOff)) return Side::kTouching;
    return query.front <= query.back + kSameDistance ? Side::kFront : Side::kBack;
}

double OccluderScene::free_way(const GridPoint& from, const RayDirection& direction, double most) const {
    return std::min<double>(state_->sides(from, direction).nearest(), most);
}

GridPoint lifted(const GridPoint& point, const std::array<double, 3>& normal) {
    const auto lift = [](double component) { return std::llround(component * kLiftOff); };
    return {point.x + lift(normal[0]), point.y + lift(normal[1]), point.z + lift(normal[2])};
}

namespace {

/// Directions into the half space above a surface.
class UpperRays {
  public:
    explicit UpperRays(const std::array<double, 3>& normal) {
        static const std::array<RayDirection, kMost> kAll = all_directions();
        for (const RayDirection& direction : kAll) {
            const double above = direction[0] * normal[0] + direction[1] * normal[1] + direction[2] * normal[2];
            if (above > 0) rays_[count_++] = direction;
        }
    }
    uint32_t count() const { return count_; }
    const RayDirection& operator[](uint32_t i) const { return rays_[i]; }

  private:
    static constexpr uint32_t kSide = 4;
    static constexpr uint32_t kMost = codec::radiance::cube_cells(kSide);
    static std::array<RayDirection, kMost> all_directions() {
        std::array<RayDirection, kMost> all;
        for (uint32_t cell = 0; cell < kMost; ++cell)
            all[cell] = ray_direction(codec::radiance::cell_direction(kSide, cell));
        return all;
    }

    std::array<RayDirection, kMost> rays_;
    uint32_t count_ = 0;
};

/// Whether a surface looks down and three in four rays out of the model: the floor of a building, where the ground is
/// at the same height. What is below it are foundations at most.
bool looks_out_below(const OccluderScene& scene, const GridPoint& from, const UpperRays& rays,
                     const std::array<double, 3>& normal) {
    if (normal[2] > -0.7) return false;
    uint32_t met = 0;
    for (uint32_t i = 0; i < rays.count() && 4 * met <= rays.count(); ++i) {
        met += scene.nearest_side(from, rays[i]) == OccluderScene::Side::kNothing ? 0 : 1;
    }
    return 4 * met <= rays.count();
}

/// Whether a point is below a surface that has its front up, the ground, with no ground below it, and at most one in
/// ten of its upward rays meets nothing. Foundations show each other their fronts, so fronts do not speak against it;
/// a canopy has the ground's front below it, and where there is no ground, the sky beside it.
bool underground(const OccluderScene& scene, const GridPoint& from, const UpperRays& rays) {
    using Side = OccluderScene::Side;
    if (scene.nearest_side(from, {0, 0, 1}) != Side::kBack) return false;
    const Side below = scene.nearest_side(from, {0, 0, -1});
    if (below != Side::kNothing && below != Side::kBack) return false;
    uint32_t upward = 0, open = 0;
    for (uint32_t i = 0; i < rays.count(); ++i) {
        if (rays[i][2] <= 0) continue;
        ++upward;
        open += scene.nearest_side(from, rays[i]) == Side::kNothing ? 1 : 0;
    }
    return 10 * open <= upward;
}

}  // namespace

bool buried(const OccluderScene& scene, const GridPoint& point, const std::array<double, 3>& normal) {
    constexpr uint32_t kLeastBacks = 4;
    const UpperRays rays(normal);
    const GridPoint from = lifted(point, normal);
    if (looks_out_below(scene, from, rays, normal) || underground(scene, from, rays)) return true;
    uint32_t fronts = 0, backs = 0;
    for (uint32_t left = rays.count(); left > 0;) {
        const auto side = scene.nearest_side(from, rays[--left]);
        if (side == OccluderScene::Side::kTouching) return true;
        fronts += side == OccluderScene::Side::kFront ? 1 : 0;
        backs += side == OccluderScene::Side::kBack ? 1 : 0;
        // The rays that are left may not change what it is.
        if (backs >= kLeastBacks && backs > fronts + left) return true;
        if (backs + left <= std::max(fronts, kLeastBacks - 1)) return false;
    }
    return false;
}

bool enclosed(const OccluderScene& scene, const GridPoint& point, const std::array<double, 3>& normal) {
    const UpperRays rays(normal);
    const GridPoint from = lifted(point, normal);
    if (looks_out_below(scene, from, rays, normal) || underground(scene, from, rays)) return true;
    const uint32_t allowed = rays.count() / 10;
    uint32_t others = 0;
    for (uint32_t i = 0; i < rays.count() && others <= allowed; ++i) {
        others += scene.nearest_side(from, rays[i]) == OccluderScene::Side::kBack ? 0 : 1;
    }
    return others <= allowed;
}

RayDirection ray_direction(const std::array<int32_t, 3>& direction) {
    const double x = direction[0], y = direction[1], z = direction[2];
    const double length = std::sqrt(x * x + y * y + z * z);
    return {static_cast<float>(x / length), static_cast<float>(y / length), static_cast<float>(z / length)};
}

}  // namespace citystream::tiles::radiance
