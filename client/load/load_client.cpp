#include "client/load/load_client.h"

#include <algorithm>
#include <utility>

namespace citystream::client {
namespace {

/// Slots as the Vulkan renderer cuts them, so that budgets hold as much as there.
constexpr size_t kMostWarnings = 20;

LoadClock::duration seconds(double value) {
    return std::chrono::duration_cast<LoadClock::duration>(std::chrono::duration<double>(value));
}

}  // namespace

void LoadMeasurements::note_warning(const std::string& text) {
    if (warnings.size() < kMostWarnings) warnings.insert(text);
}

void LoadMeasurements::merge(const LoadMeasurements& other) {
    opening.merge(other.opening);
    request.merge(other.request);
    service.merge(other.service);
    visible.merge(other.visible);
    lateness.merge(other.lateness);
    for (const auto counter :
         {&LoadMeasurements::updates, &LoadMeasurements::updates_complete, &LoadMeasurements::answers,
          &LoadMeasurements::failed, &LoadMeasurements::cancelled, &LoadMeasurements::unanswered,
          &LoadMeasurements::tiles_visible, &LoadMeasurements::tiles_abandoned, &LoadMeasurements::tiles_unused,
          &LoadMeasurements::tiles_unfinished, &LoadMeasurements::directory_bytes, &LoadMeasurements::layer_bytes,
          &LoadMeasurements::drawn_bytes}) {
        this->*counter += other.*counter;
    }
    most_host_bytes = std::max(most_host_bytes, other.most_host_bytes);
    most_gpu_bytes = std::max(most_gpu_bytes, other.most_gpu_bytes);
    worst_tolerance = std::max(worst_tolerance, other.worst_tolerance);
    fetcher.requests += other.fetcher.requests;
    fetcher.retries += other.fetcher.retries;
    fetcher.failures += other.fetcher.failures;
    fetcher.cancelled += other.fetcher.cancelled;
    fetcher.body_bytes += other.fetcher.body_bytes;
    fetcher.header_bytes += other.fetcher.header_bytes;
    for (const auto& warning : other.warnings) note_warning(warning);
    if (first_error.empty()) first_error = other.first_error;
}

LoadClient::LoadClient(const LoadClientOptions& options, CityIndex& index, LoadMeasurements& measurements,
                       std::unique_ptr<Fetcher> fetcher)
    : options_(options),
      index_(index),
      measurements_(&measurements),
      network_(std::move(fetcher)),
      fetcher_(*network_, *this),
      store_(options.gpu_budget_bytes, kSlotBytes, false),
      drawn_(index, store_) {}

Result<std::unique_ptr<LoadClient>> LoadClient::open(const LoadClientOptions& options, CityIndex& index,
                                                     LoadMeasurements& measurements) {
    const auto begin = LoadClock::now();
    auto network = Fetcher::open(options.place, options.fetcher);
    if (!network) return network.error();
    std::unique_ptr<LoadClient> client(new LoadClient(options, index, measurements, std::move(*network)));
    client->fetcher_.set_intended(begin);
    auto streamer = CityStreamer::open(client->fetcher_, client->store_, options.streamer);
    if (!streamer) return streamer.error();
    client->streamer_ = std::move(*streamer);
    measurements.opening.record(LoadClock::now() - begin);
    return client;
}

void LoadClient::on_submit(const FetchRequest& request, LoadClock::time_point intended) {
    if (const auto tile = address_in_path(request.path, "tiles"))
        ++awaited_.try_emplace(*tile, Awaited{intended, 0, false}).first->second.requests;
}

void LoadClient::on_result(const FetchRequest& request, LoadClock::time_point intended, const FetchResult& result,
                           LoadClock::time_point seen) {
    const auto tile = address_in_path(request.path, "tiles");
    if (const auto found = tile ? awaited_.find(*tile) : awaited_.end(); found != awaited_.end()) {
        Awaited& awaited = found->second;
        awaited.requests -= std::min(awaited.requests, 1u);
        awaited.lost = awaited.lost || result.cancelled || !result.bytes;
    }
    if (result.cancelled) {
        ++measurements_->cancelled;
        return;
    }
    if (streamer_) measurements_->request.record(seen - intended);
    if (!result.bytes) {
        ++measurements_->failed;
        if (measurements_->first_error.empty()) measurements_->first_error = result.bytes.error().text();
        return;
    }
    ++measurements_->answers;
    if (streamer_) measurements_->service.record(seconds(result.seconds));
    const bool directory =
        !tile && request.path != tiles::tileset::kFacadeMapsPath && request.path != tiles::tileset::kChartLevelsPath;
    (directory ? measurements_->directory_bytes : measurements_->layer_bytes) += result.bytes->size();
    if (directory) index_.learn(request.path, *result.bytes);
}

void LoadClient::update(const CameraSample& sample, LoadClock::time_point due) {
    measurements_->lateness.record(LoadClock::now() - due);
    fetcher_.set_intended(due);
    StreamerFrame frame;
    const auto& draws = streamer_->update(Camera::from_sample(sample, options_.width, options_.height), frame);
    note_draws(draws);
    note_frame(frame);
}

void LoadClient::note_draws(const std::vector<TileDraw>& draws) {
    const auto now = LoadClock::now();
    drawn_.note(draws, [&](tiles::tileset::TileAddress tile, bool appeared) {
        if (awaited_.empty()) return;
        const auto found = awaited_.find(tile);
        if (found == awaited_.end()) return;
        // A tile that was here before was asked for only to refine it.
        if (appeared) {
            measurements_->visible.record(now - found->second.since);
            ++measurements_->tiles_visible;
        }
        awaited_.erase(found);
    });
    // What has come and is not drawn is not waited for; if it is drawn later, that is no matter of the network.
    std::erase_if(awaited_, [&](const auto& entry) {
        if (entry.second.requests > 0) return false;
        ++(entry.second.lost ? measurements_->tiles_abandoned : measurements_->tiles_unused);
        return true;
    });
}

void LoadClient::note_frame(const StreamerFrame& frame) {
    ++measurements_->updates;
    if (frame.tiles_missing == 0) ++measurements_->updates_complete;
    measurements_->most_host_bytes = std::max(measurements_->most_host_bytes, frame.host_bytes_used);
    measurements_->most_gpu_bytes = std::max(measurements_->most_gpu_bytes, frame.gpu_bytes_used);
    measurements_->worst_tolerance = std::max(measurements_->worst_tolerance, frame.tolerance_used);
    for (const auto& warning : frame.warnings) measurements_->note_warning(warning);
}

void LoadClient::finish(LoadClock::time_point now) {
    fetcher_.collect();
    for (const auto intended : fetcher_.unanswered()) {
        ++measurements_->unanswered;
        measurements_->request.record(now - intended);
    }
    for (const auto& [tile, awaited] : awaited_) {
        if (awaited.requests == 0) continue;
        ++measurements_->tiles_unfinished;
        measurements_->visible.record(now - awaited.since);
    }
    measurements_->drawn_bytes += drawn_.bytes();
    const FetcherStatistics statistics = network_->statistics();
    LoadMeasurements totals;
    totals.fetcher = statistics;
    measurements_->merge(totals);
}

}  // namespace citystream::client
