#include "tiles/layers/image_preparation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "codec/atlas/alpha_mask.h"
#include "codec/atlas/chart_content.h"
#include "codec/atlas/resample.h"
#include "tiles/layers/area_reduction.h"
#include "tiles/layers/image_decode.h"
#include "tiles/layers/memory_pass.h"

namespace citystream::tiles::layers {
namespace {

using codec::atlas::ChartSize;
using codec::atlas::Image;
using codec::atlas::Metric;
using codec::atlas::MetricKind;
using codec::atlas::Shrink;
using Clock = std::chrono::steady_clock;

/// Bytes a texel that search_chart holds at most, with every metric: five linear images, and what the metrics prepare
/// (with alpha, for two backgrounds).
constexpr uint64_t kSearchImages = 5, kMetricTexel = 120;
/// Bytes a texel of a side that resampling holds: weights, and strips of rows and columns.
constexpr uint64_t kResampleSide = 512;
/// What is announced while an image of unknown size is drawn.
constexpr uint64_t kWhileDrawn = uint64_t{16} << 20;

uint64_t area(ChartSize size) {
    return uint64_t{size.width} * size.height;
}

double seconds_since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// The same limit on the error of what is shown where that is only a share of an image: errors are means over all of
/// it, and elsewhere at least 0.
Metric of_shown_part(Metric metric, double share) {
    const double scale = metric.kind == MetricKind::kRmse ? std::sqrt(share) : share;
    metric.tolerance = metric.kind == MetricKind::kSsim ? 1 - (1 - metric.tolerance) * scale : metric.tolerance * scale;
    return metric;
}

ChartImage reduce(const city::Image& image, ChartSize size) {
    AreaReduction reduction(image.width, image.height, size.width, size.height);
    const size_t row = size_t{3} * image.width;
    for (uint32_t y = image.height; y-- > 0;) reduction.add_row(std::span(image.rgb).subspan(y * row, row));
    return reduction.take();
}

Result<ChartImage> reduce(ImageFile& file, ChartSize size) {
    AreaReduction reduction(file.width(), file.height(), size.width, size.height, file.has_alpha());
    const size_t width = file.width();
    const Status read =
        file.visit_rows([&](uint32_t, uint32_t count, std::span<const uint8_t> rgb, std::span<const uint8_t> alpha) {
            for (uint32_t i = 0; i < count; ++i) {
                reduction.add_row(rgb.subspan(3 * i * width, 3 * width),
                                  alpha.empty() ? alpha : alpha.subspan(i * width, width));
            }
        });
    if (!read) return read.error();
    return reduction.take();
}

class Preparation {
  public:
    Preparation(const city::CityCatalog& catalog, const std::vector<ImageUse>& uses,
                const ImagePreparationOptions& options, PreparedImages& prepared)
        : catalog_(catalog), uses_(uses), options_(options), prepared_(prepared), gate_(options.budget_bytes) {}

    Result<ImagePreparationReport> run(std::vector<city::Defect>& defects) {
        const auto begin = Clock::now();
        std::vector<uint32_t> used;
        for (uint32_t i = 0; i < uses_.size(); ++i) {
            if (uses_[i].used()) used.push_back(i);
        }
        report_.images = uses_.size();
        report_.used = used.size();
        prepare_all(used);
        if (error_) return *error_;
        std::stable_sort(defects_.begin(), defects_.end(),
                         [](const auto& a, const auto& b) { return a.first < b.first; });
        for (auto& [image, defect] : defects_) defects.push_back(std::move(defect));
        report_.stored_bytes = prepared_.bytes();
        report_.peak_bytes = gate_.peak();
        report_.seconds = seconds_since(begin);
        return report_;
    }

  private:
    struct Job {
        uint32_t image;
        const ImageUse& use;
        ImagePreparationReport spent;  // only of this image
    };

    void prepare_all(const std::vector<uint32_t>& used) {
        std::atomic<size_t> next = 0;
        const auto work = [&] {
            for (size_t i = next++; i < used.size() && !stopped(); i = next++) {
                Job job{used[i], uses_[used[i]], {}};
                const Status status = prepare(job);
                finish(job, status, used.size());
            }
        };
        const uint32_t jobs = options_.jobs != 0 ? options_.jobs : std::max(1U, std::thread::hardware_concurrency());
        std::vector<std::jthread> threads;
        for (uint32_t i = 1; i < std::min<size_t>(jobs, used.size()); ++i) threads.emplace_back(work);
        work();
    }

    bool stopped() {
        const std::lock_guard lock(mutex_);
        if (!error_ && options_.cancel != nullptr && options_.cancel->load()) error_ = Error{"interrupted"};
        return error_.has_value();
    }

    void finish(const Job& job, const Status& status, uint64_t total) {
        const std::lock_guard lock(mutex_);
        if (!status && !error_) error_ = status.error();
        report_.failed += job.spent.failed;
        report_.not_searched += job.spent.not_searched;
        report_.decoded_pixels += job.spent.decoded_pixels;
        report_.matched_pixels += job.spent.matched_pixels;
        report_.prepared_pixels += job.spent.prepared_pixels;
        report_.metric_calls += job.spent.metric_calls;
        report_.decode_seconds += job.spent.decode_seconds;
        report_.match_seconds += job.spent.match_seconds;
        report_.search_seconds += job.spent.search_seconds;
        report_.store_seconds += job.spent.store_seconds;
        ++done_;
        if (options_.progress) options_.progress("images", done_, total);
    }

    void note(const Job& job, const std::string& what) {
        const std::string& path = catalog_.images[job.image].path;
        const std::string name = path.empty() ? "image " + std::to_string(job.image) : path;
        const std::lock_guard lock(mutex_);
        defects_.emplace_back(job.image, city::Defect{name, what, path, false});
    }

    Status give_up(Job& job, const std::string& why) {
        note(job, why + "; a flat colour is used");
        prepared_.fail(job.image);
        job.spent.failed = 1;
        return Done{};
    }

    Status prepare(Job& job) {
        const city::ImageSource& source = catalog_.images[job.image];
        if (source.pixels || source.make) return prepare_drawn(job, source);
        auto file = ImageFile::open(source.path);
        if (!file) return give_up(job, file.error().text());
        const ImagePlan plan =
            plan_of(job, {{(*file)->width(), (*file)->height()}, (*file)->strip_bytes(), false, (*file)->has_alpha()});
        return within(plan, [&] {
            const auto begin = Clock::now();
            auto read = plan.by_rows ? reduce(**file, plan.size) : read_whole(**file);
            if (!read) return give_up(job, read.error().text());
            job.spent.decoded_pixels = (*file)->pixels();
            (*file).reset();
            job.spent.decode_seconds += seconds_since(begin);
            return match(job, plan, std::move(read).value());
        });
    }

    Status prepare_drawn(Job& job, const city::ImageSource& source) {
        const auto begin = Clock::now();
        const uint64_t guess = source.pixels ? 0 : std::min(kWhileDrawn, options_.budget_bytes);
        std::shared_ptr<const city::Image> drawn;
        {
            const MemoryPass pass(gate_, guess);
            drawn = source.drawn();
        }
        const ChartSize size{drawn->width, drawn->height};
        if (area(size) == 0 || drawn->rgb.size() != 3 * area(size)) return give_up(job, "a drawn image is empty");
        const ImagePlan plan = plan_of(job, {size, 0, true, false});
        return within(plan, [&] {
            ChartImage whole = plan.by_rows ? reduce(*drawn, plan.size)
                                            : ChartImage{size.width, size.height, false, false, 0, drawn->rgb};
            drawn.reset();
            job.spent.decoded_pixels = area(size);
            job.spent.decode_seconds += seconds_since(begin);
            return match(job, plan, std::move(whole));
        });
    }

    ImagePlan plan_of(const Job& job, const ImageFacts& image) {
        const bool search = options_.saliency.kind != MetricKind::kNone;
        const ImagePlan plan =
            plan_image(image, finest_size(image.size, job.use, options_.texel_metres), search, options_.budget_bytes);
        if (plan.halved) {
            note(job, "image of " + std::to_string(image.size.width) + " x " + std::to_string(image.size.height) +
                          " reduced to " + std::to_string(plan.size.width) + " x " + std::to_string(plan.size.height) +
                          ": the memory limit holds no more");
        }
        return plan;
    }

    template <typename Work>
    Status within(const ImagePlan& plan, const Work& work) {
        const MemoryPass pass(gate_, plan.bytes);
        return work();
    }

    /// From here on the image's rows are in memory, all of them or those that remain.
    Status match(Job& job, const ImagePlan& plan, ChartImage image) {
        auto begin = Clock::now();
        job.spent.matched_pixels = area(plan.size);
        if (codec::atlas::all_there(image.alpha)) image.alpha = {};
        const auto colour = image.alpha.empty() ? codec::atlas::flat_colour(image.rgb) : std::nullopt;
        if (colour) return store(job, {1, 1, false, false, 0, {(*colour)[0], (*colour)[1], (*colour)[2]}});
        const bool repeat = !job.use.clamped;
        const codec::atlas::Edges edges{repeat, repeat};
        image.repeat_u = image.repeat_v = repeat;
        const codec::atlas::AreaShare there = codec::atlas::there_of(image);
        if (plan.size != ChartSize{image.width, image.height}) {
            image = chart_image(resample(image, plan.size.width, plan.size.height, Shrink::kLanczos, edges));
            image.repeat_u = image.repeat_v = repeat;
            codec::atlas::keep_share(image, there);
        }
        image.repeat_u = image.repeat_v = false;
        job.spent.match_seconds += seconds_since(begin);
        return plan.searched ? search(job, std::move(image), there, edges) : store(job, std::move(image));
    }

    Status search(Job& job, ChartImage image, codec::atlas::AreaShare there, codec::atlas::Edges edges) {
        const auto begin = Clock::now();
        codec::atlas::SearchSettings settings;
        settings.metric = of_shown_part(options_.saliency, job.use.shown_share());
        settings.edges = edges;
        settings.multiple = 4;  // charts of whole blocks
        settings.there = there;
        const Image linear = linear_image(image);
        image = {};
        codec::atlas::SearchResult found = search_chart(linear, settings);
        job.spent.metric_calls = found.calls;
        image = chart_image(found.image);
        found.image = {};
        job.spent.search_seconds += seconds_since(begin);
        return store(job, std::move(image));
    }

    Status store(Job& job, ChartImage chart) {
        const auto begin = Clock::now();
        settle_alpha(chart);
        job.spent.prepared_pixels = uint64_t{chart.width} * chart.height;
        Status stored = prepared_.store(job.image, std::move(chart));
        job.spent.store_seconds += seconds_since(begin);
        return stored;
    }

    const city::CityCatalog& catalog_;
    const std::vector<ImageUse>& uses_;
    const ImagePreparationOptions& options_;
    PreparedImages& prepared_;
    MemoryGate gate_;
    std::mutex mutex_;  // guards everything below
    ImagePreparationReport report_;
    std::vector<std::pair<uint32_t, city::Defect>> defects_;
    std::optional<Error> error_;
    uint64_t done_ = 0;
};

}  // namespace

ImagePlan plan_image(const ImageFacts& facts, ChartSize wanted, bool search, uint64_t budget_bytes) {
    ImagePlan plan;
    plan.size = wanted;
    const ChartSize image = facts.size;
    const uint64_t texel = facts.alpha ? 4 : 3, linear_texel = texel * sizeof(float);
    const uint64_t held = facts.strip_bytes + (facts.whole_pixels_held ? texel * area(image) : 0);
    const auto least_bytes = [&] {
        return held + std::max(AreaReduction::bytes(plan.size.width, plan.size.height, facts.alpha),
                               PreparedImages::bytes_to_store(area(plan.size), facts.alpha));
    };
    while (area(plan.size) > 1 && least_bytes() > budget_bytes) {
        plan.size = {std::max(1U, plan.size.width / 2), std::max(1U, plan.size.height / 2)};
        plan.halved = true;
    }
    plan.bytes = least_bytes();
    const uint64_t whole = held + texel * area(image);
    uint64_t resample = 0;
    if (plan.size != image) {
        resample = whole + linear_texel * plan.size.width * (uint64_t{image.height} + plan.size.height) +
                   kResampleSide * (uint64_t{image.width} + image.height);
    }
    plan.by_rows = plan.size != image && std::max(whole, resample) > budget_bytes;
    if (!plan.by_rows) plan.bytes = std::max({plan.bytes, whole, resample});
    const uint64_t searching =
        (texel + kSearchImages * linear_texel + kMetricTexel * (facts.alpha ? 2 : 1)) * area(plan.size);
    plan.searched = search && searching <= budget_bytes;
    if (plan.searched) plan.bytes = std::max(plan.bytes, searching);
    return plan;
}

Result<ImagePreparationReport> prepare_images(const city::CityCatalog& catalog, const std::vector<ImageUse>& uses,
                                              const ImagePreparationOptions& options, PreparedImages& prepared,
                                              std::vector<city::Defect>& defects) {
    return Preparation(catalog, uses, options, prepared).run(defects);
}

}  // namespace citystream::tiles::layers
