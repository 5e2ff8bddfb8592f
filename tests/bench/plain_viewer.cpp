#include "tests/bench/plain_viewer.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "client/select/depth_picture.h"
#include "codec/atlas/shared_chart.h"
#include "tests/bench/jpeg_file.h"
#include "tiles/layers/image_preparation.h"
#include "tiles/layers/image_uses.h"
#include "tiles/quadtree/object_spool.h"

namespace citystream::bench {

using namespace tiles;
using codec::atlas::ChartImage;

namespace {

constexpr size_t kCacheBytes = size_t{64} << 20;
constexpr double kLeastSurface = 0.25;  ///< square metres, as client/stream/occluders.h
constexpr int kLeastQuality = 20, kBestQuality = 95, kQualityStep = 5;

double area_of(const std::array<std::array<double, 3>, 3>& t) {
    std::array<double, 3> a{}, b{};
    for (size_t i = 0; i < 3; ++i) {
        a[i] = t[1][i] - t[0][i];
        b[i] = t[2][i] - t[0][i];
    }
    return 0.5 * std::hypot(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]);
}

double squared_error(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i) sum += std::pow(static_cast<double>(a[i]) - b[i], 2);
    return sum / static_cast<double>(std::max<size_t>(1, a.size()));
}

std::vector<unsigned char> jpeg_of(const ChartImage& image, int quality) {
    return jpeg_file(image.rgb, image.width, image.height, quality);
}

/// The least quality whose squared error is at most `error`; the best where none reaches it.
int quality_for(const ChartImage& image, double error) {
    int low = kLeastQuality / kQualityStep, high = kBestQuality / kQualityStep;
    while (low < high) {
        const int middle = (low + high) / 2;
        const auto pixels = jpeg_pixels(jpeg_of(image, middle * kQualityStep), image.width, image.height);
        const bool good = !pixels.empty() && squared_error(image.rgb, pixels) <= error;
        (good ? high : low) = good ? middle : middle + 1;
    }
    return high * kQualityStep;
}

/// Of a chart's finest mip, as its blocks show it.
double block_error(const ChartImage& chart, const LayerSteps& steps) {
    std::vector<uint32_t> words, lengths;
    for (const LayerStep& step : steps) {
        words.insert(words.end(), step.words.begin(), step.words.end());
        lengths.push_back(static_cast<uint32_t>(step.words.size()));
    }
    const auto view = codec::atlas::AtlasLayerView::create(words, lengths);
    if (!view) return 0;
    std::vector<uint8_t> shown(chart.rgb.size());
    for (uint32_t y = 0; y < chart.height; ++y) {
        for (uint32_t x = 0; x < chart.width; ++x) view->texel(0, 0, x, y, &shown[3 * (size_t{y} * chart.width + x)]);
    }
    return squared_error(chart.rgb, shown);
}

}  // namespace

ImageBytes& ImageBytes::operator+=(const ImageBytes& other) {
    bc1 += other.bc1;
    jpeg += other.jpeg;
    matched_jpeg += other.matched_jpeg;
    return *this;
}

Result<std::unique_ptr<PlainViewer>> PlainViewer::read(const layers::CitySource& source, const std::string& folder) {
    std::unique_ptr<PlainViewer> viewer(new PlainViewer);
    if (Status prepared = viewer->prepare(source, folder); !prepared) return prepared.error();
    return viewer;
}

Status PlainViewer::prepare(const layers::CitySource& source, const std::string& folder) {
    auto spool = quadtree::ObjectSpool::create(folder);
    if (!spool) return spool.error();
    city::CityHeader header;
    city::CityReport report;
    Status stored = Done{};
    const Status read = source(header, catalog_, report, [&](city::CityObject&& object) {
        take(object);
        if (!object.facades.empty()) {
            stored = Error{"the city has facades with relief; give one whose walls are flat"};
        } else {
            stored = (*spool)->add(object, catalog_, report);
        }
        return stored.ok();
    });
    if (!read) return read.error();
    if (!stored) return stored.error();
    const auto uses = layers::find_image_uses(**spool, catalog_, 0);
    if (!uses) return uses.error();
    auto prepared = layers::PreparedImages::create(folder, catalog_.images.size());
    if (!prepared) return prepared.error();
    prepared_ = std::move(*prepared);
    std::vector<city::Defect> defects;
    const auto done = layers::prepare_images(catalog_, *uses, {}, *prepared_, defects);
    if (!done) return done.error();
    matched_ = std::make_unique<layers::ImageCache>(catalog_, kCacheBytes, prepared_.get());
    as_they_are_ = std::make_unique<layers::ImageCache>(catalog_, kCacheBytes);
    return Done{};
}

void PlainViewer::take(const city::CityObject& object) {
    Object taken;
    taken.bounds.min.fill(1e300);
    taken.bounds.max.fill(-1e300);
    std::set<uint32_t> images;
    for (const city::Triangle& triangle : object.triangles) {
        std::array<std::array<double, 3>, 3> corners;
        for (size_t i = 0; i < 3; ++i) {
            const city::Vec3& at = object.vertices[triangle.vertex[i]];
            corners[i] = {at.x, at.y, at.z};
            for (size_t axis = 0; axis < 3; ++axis) {
                taken.bounds.min[axis] = std::min(taken.bounds.min[axis], corners[i][axis]);
                taken.bounds.max[axis] = std::max(taken.bounds.max[axis], corners[i][axis]);
            }
        }
        if (area_of(corners) >= kLeastSurface) taken.surfaces.push_back(corners);
        const int32_t image = catalog_.materials[triangle.material].image;
        if (image >= 0) images.insert(static_cast<uint32_t>(image));
    }
    if (object.triangles.empty()) return;
    taken.images.assign(images.begin(), images.end());
    objects_.push_back(std::move(taken));
}

void PlainViewer::look(const client::Camera& camera, std::set<uint32_t>& seen) const {
    std::vector<const Object*> in_frustum;
    for (const Object& object : objects_) {
        if (camera.sees(object.bounds, {0, 0})) in_frustum.push_back(&object);
    }
    client::DepthPicture picture;
    picture.begin(camera);
    for (const Object* object : in_frustum) {
        for (const auto& surface : object->surfaces) picture.add(surface);
    }
    picture.finish();
    for (const Object* object : in_frustum) {
        if (!picture.hides(object->bounds, {0, 0})) seen.insert(object->images.begin(), object->images.end());
    }
}

const ImageBytes& PlainViewer::bytes_of(uint32_t image, uint32_t rate_distortion) {
    const auto [found, is_new] = bytes_.try_emplace({image, rate_distortion});
    ImageBytes& bytes = found->second;
    const auto matched = is_new ? matched_->mip(image, 0) : nullptr;
    if (!matched) return bytes;
    const LayerSteps steps = codec::atlas::encode_atlas({matched.get(), 1}, {rate_distortion});
    for (const auto& level : codec::atlas::encode_chart_levels(steps)) bytes.bc1 += level.size();
    const int quality = quality_for(*matched, block_error(*matched, steps));
    bytes.matched_jpeg = jpeg_of(*matched, quality).size();
    const std::string& path = catalog_.images[image].path;
    std::error_code failed;
    if (!catalog_.images[image].drawn() && !path.empty()) {
        bytes.jpeg = std::filesystem::file_size(path, failed);
    } else if (const auto whole = as_they_are_->mip(image, 0)) {
        bytes.jpeg = jpeg_of(*whole, quality).size();
    }
    return bytes;
}

}  // namespace citystream::bench
