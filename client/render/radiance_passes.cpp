#include "client/render/radiance_passes.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "codec/radiance/irradiance.h"
#include "codec/radiance/radiance_resident.h"
#include "shaders/radiance_clusters.comp.h"
#include "shaders/radiance_receivers.comp.h"
#include "shaders/radiance_rows.comp.h"

namespace citystream::client {
namespace {

constexpr uint64_t kSumBytes = RADIANCE_SUM_WORDS * sizeof(uint32_t);
/// Sums of a batch are numbered in words by 32 bits.
constexpr uint64_t kMostSums = (uint64_t{1} << 32) / RADIANCE_SUM_WORDS - 1;

uint32_t groups_of(uint32_t items) {
    return items / RADIANCE_PASS_GROUP + (items % RADIANCE_PASS_GROUP != 0 ? 1 : 0);
}

std::array<uint32_t, RADIANCE_PASSES> items_of(const RadianceJob& job) {
    return {job.clusters, job.rows, job.receivers};
}

void split(VkDeviceAddress address, uint (&words)[2]) {
    std::memcpy(words, &address, sizeof words);
}

void reserve(const Device& device, Buffer& buffer, uint64_t bytes, BufferPlace place) {
    if (buffer.bytes >= bytes) return;
    destroy_buffer(device, buffer);
    buffer = create_buffer(device, bytes, place);
}

/// m where there are m x m local directions, 0 where that is none of a layer's numbers.
uint32_t side_of(uint32_t locals) {
    for (uint32_t side = 1; side <= codec::radiance::kMostLocalSide; ++side) {
        if (side * side == locals) return side;
    }
    return 0;
}

RadianceJob job_of(const codec::radiance::RadianceLayerShape& shape, std::span<const uint32_t> matrix) {
    RadianceJob job{};
    job.irradiance_word = shape.irradiance_word;
    job.receivers = shape.receivers;
    job.locals = matrix[RADIANCE_WORD_LOCALS];
    job.columns = matrix[RADIANCE_WORD_COLUMNS];
    job.rows = matrix[RADIANCE_WORD_ROWS];
    job.clusters = matrix[RADIANCE_WORD_CLUSTERS];
    job.terms = matrix[RADIANCE_WORD_TERMS];
    job.links = matrix[RADIANCE_WORD_LINKS];
    job.term_starts = shape.matrix_word + matrix[RADIANCE_WORD_TERM_STARTS];
    job.link_starts = shape.matrix_word + matrix[RADIANCE_WORD_LINK_STARTS];
    job.term_fields = shape.matrix_word + matrix[RADIANCE_WORD_TERM_FIELDS];
    job.link_fields = shape.matrix_word + matrix[RADIANCE_WORD_LINK_FIELDS];
    job.row_fields = shape.matrix_word + matrix[RADIANCE_WORD_ROW_FIELDS];
    job.bits = matrix[RADIANCE_WORD_BITS];
    job.start_bits = matrix[RADIANCE_WORD_START_BITS];
    return job;
}

}  // namespace

RadiancePasses::RadiancePasses(const Device& device, SlotPool& pool, uint64_t sum_bytes)
    : device_(device), pool_(pool), sum_bytes_(sum_bytes) {}

RadiancePasses::~RadiancePasses() {
    for (Pass& pass : passes_) destroy_pass(device_, pass);
    for (Buffer* buffer : {&light_buffer_, &weight_buffer_, &job_buffer_, &sum_buffer_})
        destroy_buffer(device_, *buffer);
}

void RadiancePasses::set_light(const FrameLight& light) {
    if (number_ == light.number) return;
    number_ = light.number;
    light_is_uploaded_ = false;
    light_.clear();
    for (const auto& texel : light.sky.values) light_.insert(light_.end(), texel.begin(), texel.end());
    unit_ = codec::radiance::irradiance_unit(light.sky);
}

RadiancePasses::Known RadiancePasses::read_header(LayerId layer) const {
    Known known;
    known.words = pool_.layers[layer].words;
    const auto shape =
        codec::radiance::radiance_layer_shape(read_words(pool_, layer, RECEIVER_HEADER_WORDS), known.words);
    if (!shape) return known;
    const auto matrix = read_words(pool_, layer, RADIANCE_HEADER_WORDS, shape->matrix_word);
    if (!codec::radiance::check_resident_header(matrix, known.words - shape->matrix_word)) return known;
    known.job = job_of(*shape, matrix);
    const RadianceJob& job = known.job;
    // Every row is some receiver's, and where there are links or rows there is what they name.
    known.usable = matrix[RADIANCE_WORD_RECEIVERS] == shape->receivers && side_of(job.locals) != 0 && job.columns > 0 &&
                   job.rows <= job.receivers * job.locals && (job.rows > 0 || job.receivers == 0) &&
                   (job.clusters > 0 || job.links == 0) && job.clusters <= job.links && known.sums() <= kMostSums;
    return known;
}

bool RadiancePasses::is_for_light(const Known& known) const {
    return known.usable && uint64_t{known.job.columns} * RADIANCE_SUM_WORDS == light_.size();
}

uint32_t RadiancePasses::first_weight(uint32_t locals) {
    const auto [at, is_new] = first_weights_.emplace(locals, static_cast<uint32_t>(weights_.size()));
    if (is_new) {
        const std::vector<uint32_t> weights = codec::radiance::irradiance_weights(side_of(locals));
        weights_.insert(weights_.end(), weights.begin(), weights.end());
    }
    return at->second;
}

Status RadiancePasses::plan(std::span<const LayerId> layers) {
    todo_.clear();
    counts_ = {};
    if (!number_) return Done{};
    for (const LayerId layer : layers) {
        if (!is_live(pool_, layer)) return Error{"a radiance layer that does not exist cannot be lit"};
        Known& known = known_[layer];
        if (known.words != pool_.layers[layer].words) known = read_header(layer);
        if (!is_for_light(known)) {
            ++counts_.unlit;
            continue;
        }
        if (known.lit == number_) continue;
        known.job.first_weight = first_weight(known.job.locals);
        todo_.push_back(layer);
        ++counts_.tiles;
        counts_.receivers += known.job.receivers;
        counts_.clusters += known.job.clusters;
        counts_.rows += known.job.rows;
    }
    return Done{};
}

std::vector<RadiancePasses::Batch> RadiancePasses::batches() const {
    std::vector<Batch> batches;
    uint64_t sums = 0;
    const uint64_t most = std::min(sum_bytes_ / kSumBytes, kMostSums);
    for (size_t i = 0; i < todo_.size(); ++i) {
        const Known& known = known_.at(todo_[i]);
        if (batches.empty() || sums + known.sums() > most) {
            batches.push_back({.first = i, .end = i});
            sums = 0;
        }
        Batch& batch = batches.back();
        batch.end = i + 1;
        sums += known.sums();
        const auto items = items_of(known.job);
        for (size_t pass = 0; pass < RADIANCE_PASSES; ++pass) batch.groups[pass] += groups_of(items[pass]);
    }
    return batches;
}

void RadiancePasses::make_buffers(const std::vector<Batch>& batches) {
    if (!has_pipeline()) {
        passes_[RADIANCE_PASS_CLUSTERS] =
            create_compute_pass(device_, k_radiance_clusters_comp, sizeof(RadiancePassConstants));
        passes_[RADIANCE_PASS_ROWS] = create_compute_pass(device_, k_radiance_rows_comp, sizeof(RadiancePassConstants));
        passes_[RADIANCE_PASS_RECEIVERS] =
            create_compute_pass(device_, k_radiance_receivers_comp, sizeof(RadiancePassConstants));
    }
    if (!light_is_uploaded_) {
        reserve(device_, light_buffer_, sizeof(uint32_t) * light_.size(), BufferPlace::kUpload);
        std::memcpy(light_buffer_.mapped, light_.data(), sizeof(uint32_t) * light_.size());
        light_is_uploaded_ = true;
    }
    if (weight_buffer_.bytes < sizeof(uint32_t) * weights_.size()) {
        reserve(device_, weight_buffer_, sizeof(uint32_t) * weights_.size(), BufferPlace::kUpload);
        std::memcpy(weight_buffer_.mapped, weights_.data(), sizeof(uint32_t) * weights_.size());
    }
    uint64_t most_sums = 1, page_bytes = 0;
    for (const Batch& batch : batches) {
        uint64_t sums = 0;
        for (size_t i = batch.first; i < batch.end; ++i) sums += known_.at(todo_[i]).sums();
        most_sums = std::max(most_sums, sums);
    }
    for (const LayerId layer : todo_) page_bytes += sizeof(VkDeviceAddress) * pool_.layers[layer].slots.size();
    reserve(device_, sum_buffer_, kSumBytes * most_sums, BufferPlace::kDevice);
    const uint64_t job_bytes = sizeof(RadianceJob) * todo_.size() + page_bytes;
    if (job_buffer_.bytes < job_bytes)
        reserve(device_, job_buffer_, std::max<uint64_t>(16 << 10, job_bytes + job_bytes / 2), BufferPlace::kUpload);
}

/// Page tables, then jobs: of both the order is that of todo_.
void RadiancePasses::write_jobs(const std::vector<Batch>& batches) {
    auto* const bytes = static_cast<std::byte*>(job_buffer_.mapped);
    uint64_t pages_at = sizeof(RadianceJob) * todo_.size();
    for (const Batch& batch : batches) {
        std::array<uint32_t, RADIANCE_PASSES> groups{};
        uint64_t sums = 0;
        for (size_t i = batch.first; i < batch.end; ++i) {
            const SlotLayer& slots = pool_.layers[todo_[i]];
            const Known& known = known_.at(todo_[i]);
            RadianceJob job = known.job;
            if (is_contiguous(pool_, slots)) {
                split(slot_address(pool_, slots.slots[0]) | LAYER_REF_DIRECT, job.layer);
            } else {
                split(job_buffer_.address + pages_at, job.layer);
                for (const uint32_t slot : slots.slots) {
                    const VkDeviceAddress address = slot_address(pool_, slot);
                    std::memcpy(bytes + pages_at, &address, sizeof address);
                    pages_at += sizeof address;
                }
            }
            const auto items = items_of(job);
            for (size_t pass = 0; pass < RADIANCE_PASSES; ++pass) {
                job.first_group[pass] = groups[pass];
                groups[pass] += groups_of(items[pass]);
            }
            job.first_sum = static_cast<uint32_t>(sums);
            sums += known.sums();
            std::memcpy(bytes + sizeof(RadianceJob) * i, &job, sizeof job);
        }
    }
}

void RadiancePasses::record_batch(VkCommandBuffer commands, const Batch& batch) const {
    RadiancePassConstants constants{};
    split(job_buffer_.address + sizeof(RadianceJob) * batch.first, constants.jobs);
    split(light_buffer_.address, constants.light);
    split(weight_buffer_.address, constants.weights);
    split(sum_buffer_.address, constants.sums);
    constants.job_count = static_cast<uint32_t>(batch.end - batch.first);
    for (size_t pass = 0; pass < RADIANCE_PASSES; ++pass) {
        constants.groups = batch.groups[pass];
        if (constants.groups > 0) {
            vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, passes_[pass].handle);
            vkCmdPushConstants(commands, passes_[pass].layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof constants,
                               &constants);
            const uint32_t rows = (constants.groups + RADIANCE_PASS_ROW_GROUPS - 1) / RADIANCE_PASS_ROW_GROUPS;
            vkCmdDispatch(commands, std::min<uint32_t>(constants.groups, RADIANCE_PASS_ROW_GROUPS), rows, 1);
        }
        // The next pass reads the sums; that of the next batch writes them anew.
        memory_barrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                       VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
    }
}

void RadiancePasses::record(VkCommandBuffer commands) {
    if (todo_.empty()) return;
    const std::vector<Batch> all = batches();
    counts_.batches = all.size();
    make_buffers(all);
    write_jobs(all);
    for (const Batch& batch : all) record_batch(commands, batch);
    memory_barrier(
        commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
        VK_PIPELINE_STAGE_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_HOST_BIT,
        VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT | VK_ACCESS_HOST_READ_BIT | VK_ACCESS_HOST_WRITE_BIT);
}

void RadiancePasses::finish() {
    for (const LayerId layer : todo_) known_.at(layer).lit = number_;
    todo_.clear();
}

void RadiancePasses::forget(LayerId layer) {
    known_.erase(layer);
    std::erase(todo_, layer);
}

uint64_t RadiancePasses::buffer_bytes() const {
    return light_buffer_.bytes + weight_buffer_.bytes + job_buffer_.bytes + sum_buffer_.bytes;
}

}  // namespace citystream::client
