// Relief masks made on the device: the CPU's, but for rays that graze; and where they lie.
#include "client/render/relief_masks.h"

#include <bit>
#include <cstdio>

#include "client/render/facade_map_facts.h"
#include "codec/facade/facade_form.h"
#include "codec/facade/facade_ray.h"
#include "shaders/twin_relief_mask.comp.h"
#include "tests/client/render/facade_scene.h"
#include "tests/client/render/gpu_twin.h"
#include "tests/shaders/facade_rays.h"

namespace citystream::client::test {
namespace {

using codec::facade::FacadeForm;
using codec::facade::RunGrid;
using codec::radiance::ReliefMaskView;

class ReliefMasksTest : public GpuTwin {
  protected:
    void SetUp() override {
        GpuTwin::SetUp();
        if (!HasFatalFailure()) masks_.emplace(device_, pool_);
    }
    void TearDown() override {
        masks_.reset();
        GpuTwin::TearDown();
    }

    ReliefMap upload(const RunGrid& grid, FacadeForm form, FacadeRenderer renderer, bool scattered) {
        const auto words = codec::facade::encode_form(form, grid);
        EXPECT_TRUE(words.ok());
        ReliefMap map{upload_words(*words, scattered)};
        map.caster = caster_for(renderer, static_cast<uint32_t>(form)).value();
        return map;
    }

    void make(std::span<const ReliefMap> maps) {
        ASSERT_TRUE(masks_->plan(maps).ok());
        submit_and_wait(device_, [&](VkCommandBuffer commands) { masks_->record(commands); });
        masks_->finish();
    }

    std::vector<uint32_t> words_of(const ReliefMap& map) {
        const LayerId mask = masks_->mask_of(map.map);
        return mask == kNoLayer ? std::vector<uint32_t>() : read_words(pool_, mask, pool_.layers[mask].words);
    }

    std::optional<ReliefMasks> masks_;
};

/// Bits of the device's mask that are not the CPU's, of how many.
struct BitTally {
    uint64_t bits = 0, wrong = 0, texels = 0;

    void add(const ReliefMaskView& got, const ReliefMaskView& wanted) {
        for (uint32_t y = 0; y < wanted.shape().up(); ++y) {
            for (uint32_t x = 0; x < wanted.shape().across(); ++x) {
                ASSERT_EQ(got.surfaces(x, y), wanted.surfaces(x, y));
                for (uint32_t i = 0; i < wanted.surfaces(x, y); ++i) {
                    ASSERT_EQ(got.label(x, y, i), wanted.label(x, y, i)) << x << ", " << y;
                    wrong += static_cast<uint64_t>(std::popcount(got.bits(x, y, i) ^ wanted.bits(x, y, i)));
                    bits += RELIEF_DIRECTIONS;
                }
                ++texels;
            }
        }
    }
};

struct MaskCase {
    FacadeRenderer renderer;
    FacadeForm form;
};

TEST_F(ReliefMasksTest, HaveTheBitsOfRaysOnTheCpu) {
    constexpr MaskCase kCases[] = {{FacadeRenderer::kPatch, FacadeForm::kPatch},
                                   {FacadeRenderer::kPatch, FacadeForm::kQuotient},
                                   {FacadeRenderer::kPatch, FacadeForm::kTiled},
                                   {FacadeRenderer::kFdm, FacadeForm::kRaw}};
    std::vector<RunGrid> grids = {window_facade(), window_facade(true)};
    for (const auto& facade : shaders_test::awkward_facades()) {
        if (facade.grid.width() * facade.grid.height() < 3000) grids.push_back(facade.grid);
    }
    for (uint32_t i = 0; i < 2; ++i)
        grids.push_back(shaders_test::random_facade(i, 100 + 90 * i, 90 + 40 * i, 8 + 6 * i, i % 2 == 1));
    BitTally tally;
    size_t number = 0;
    for (const RunGrid& grid : grids) {
        const MaskCase& form = kCases[number % std::size(kCases)];
        const ReliefMap map = upload(grid, form.form, form.renderer, ++number % 2 == 0);
        make(std::span(&map, 1));
        const std::vector<uint32_t> got = words_of(map), wanted = codec::radiance::make_relief_mask(grid);
        ASSERT_EQ(got.size(), wanted.size());
        EXPECT_TRUE(std::equal(wanted.begin(), wanted.begin() + RELIEF_MASK_TEXELS, got.begin()));
        tally.add(*ReliefMaskView::create(got), *ReliefMaskView::create(wanted));
        masks_->forget(map.map);
    }
    EXPECT_GE(tally.texels, 10000U);
    EXPECT_LE(static_cast<double>(tally.wrong), 0.005 * static_cast<double>(tally.bits));
    std::printf("{\"texels\":%llu,\"bits\":%llu,\"wrong\":%llu}\n", static_cast<unsigned long long>(tally.texels),
                static_cast<unsigned long long>(tally.bits), static_cast<unsigned long long>(tally.wrong));
}

// The host's rays give the CPU's words; a frame's rays are bounded, and a mask is there once it is done.
TEST_F(ReliefMasksTest, AreMadeInPiecesOfAFramesRays) {
    const std::array<RunGrid, 2> grids = {shaders_test::random_facade(1, 60, 50, 8),
                                          shaders_test::random_facade(2, 40, 70, 8)};
    constexpr uint64_t kMostRays = 64000;
    for (const bool on_host : {false, true}) {
        masks_.reset();
        masks_.emplace(device_, pool_, ReliefMaking{on_host, kMostRays});
        std::vector<ReliefMap> maps;
        for (const RunGrid& grid : grids) maps.push_back(upload(grid, FacadeForm::kRaw, FacadeRenderer::kFdm, false));
        uint32_t frames = 0;
        while (masks_->mask_of(maps[1].map) == kNoLayer && frames < 20) {
            make(maps);
            ++frames;
            EXPECT_GT(masks_->counts().rays, 0U);
            EXPECT_LE(masks_->counts().rays, kMostRays);
            // The first comes first.
            if (frames == 1) {
                EXPECT_EQ(masks_->mask_of(maps[0].map), kNoLayer);
            }
            if (masks_->mask_of(maps[1].map) != kNoLayer) {
                EXPECT_NE(masks_->mask_of(maps[0].map), kNoLayer);
            }
        }
        EXPECT_GT(frames, 3U);
        EXPECT_EQ(masks_->has_pipeline(), !on_host);
        for (size_t i = 0; i < maps.size(); ++i) {
            const std::vector<uint32_t> got = words_of(maps[i]), wanted = codec::radiance::make_relief_mask(grids[i]);
            ASSERT_EQ(got.size(), wanted.size());
            if (on_host) {
                EXPECT_EQ(got, wanted);
            }
            BitTally tally;
            tally.add(*ReliefMaskView::create(got), *ReliefMaskView::create(wanted));
            EXPECT_LE(static_cast<double>(tally.wrong), 0.005 * static_cast<double>(tally.bits));
            masks_->forget(maps[i].map);
        }
        make(maps);
        EXPECT_LE(masks_->counts().rays, kMostRays);
        for (const ReliefMap& map : maps) masks_->forget(map.map);
        EXPECT_EQ(masks_->slots_used(), 0U);
    }
}

TEST_F(ReliefMasksTest, AreMadeOnceAndGoWithTheirMaps) {
    const RunGrid grid = shaders_test::random_facade(1, 60, 50, 8);
    const ReliefMap map = upload(grid, FacadeForm::kRaw, FacadeRenderer::kFdm, false);
    const uint64_t before = pool_.slots_used;
    EXPECT_EQ(masks_->mask_of(map.map), kNoLayer);
    EXPECT_FALSE(masks_->has_pipeline());
    make(std::span(&map, 1));
    EXPECT_TRUE(masks_->has_pipeline());
    EXPECT_EQ(masks_->counts().made, 1U);
    EXPECT_EQ(masks_->counts().masks, 1U);
    EXPECT_EQ(pool_.slots_used, before + masks_->slots_used());
    EXPECT_EQ(masks_->counts().bytes, masks_->slots_used() * kSlotBytes);
    make(std::span(&map, 1));
    EXPECT_EQ(masks_->counts().made, 0U);
    masks_->forget(map.map);
    EXPECT_EQ(masks_->mask_of(map.map), kNoLayer);
    EXPECT_EQ(pool_.slots_used, before);
    EXPECT_EQ(masks_->slots_used(), 0U);
}

TEST_F(ReliefMasksTest, TakeTheRoomThatIsLeftAndOfUnusedOnes) {
    masks_.reset();
    forget_layers();
    destroy_slot_pool(pool_);
    // A mask of these maps takes 90 KiB.
    pool_ = create_slot_pool(device_, 256 << 10);
    masks_.emplace(device_, pool_);
    std::vector<ReliefMap> maps;
    for (uint32_t i = 0; i < 3; ++i) {
        const RunGrid grid = shaders_test::random_facade(i, 300, 100, 3);
        maps.push_back(upload(grid, FacadeForm::kQuotient, FacadeRenderer::kPatch, false));
    }
    make(maps);
    EXPECT_EQ(masks_->counts().masks, 2U);
    EXPECT_EQ(masks_->counts().refused, 1U);
    EXPECT_EQ(masks_->mask_of(maps[2].map), kNoLayer);
    // The one that the frame does not name gives its room.
    make(std::span(maps).subspan(1));
    EXPECT_EQ(masks_->counts().made, 1U);
    EXPECT_EQ(masks_->mask_of(maps[0].map), kNoLayer);
    EXPECT_NE(masks_->mask_of(maps[2].map), kNoLayer);
    // Layers come first.
    masks_->make_room(free_slots(pool_) + 1);
    EXPECT_EQ(masks_->counts().masks, 1U);
    masks_->make_room(pool_.slot_count);
    EXPECT_EQ(masks_->slots_used(), 0U);
}

TEST_F(ReliefMasksTest, LayersThatAreNoMapsHaveNone) {
    const std::vector<uint32_t> words(64, 0x12345678);
    const ReliefMap map{upload_words(words, false)};
    make(std::span(&map, 1));
    EXPECT_EQ(masks_->mask_of(map.map), kNoLayer);
    EXPECT_EQ(masks_->counts().refused, 1U);
    const ReliefMap missing{kNoLayer};
    EXPECT_FALSE(masks_->plan(std::span(&missing, 1)).ok());
}

TEST_F(ReliefMasksTest, AreLookedUpAsOnTheCpu) {
    const RunGrid grid = window_facade();
    const std::vector<uint32_t> words = codec::radiance::make_relief_mask(grid);
    const auto mask = ReliefMaskView::create(words);
    ASSERT_TRUE(mask.ok());
    struct Point {
        std::array<float, 3> at;
        uint32_t label;
        int axis, sign;
    };
    std::vector<Point> points;
    std::vector<uint32_t> input;
    Random random;
    while (points.size() < 2000) {
        const double origin[3] = {random.unit() * grid.width(), random.unit() * grid.height(), 2000};
        const double direction[3] = {random.unit() * 200 - 100, random.unit() * 200 - 100, -1000};
        const auto hit = codec::facade::cast_facade_ray(grid, origin, direction);
        if (!hit.hit) continue;
        Point point{{}, hit.label, hit.normal_axis, hit.normal_sign};
        for (size_t i = 0; i < 3; ++i) {
            point.at[i] = static_cast<float>(origin[i] + hit.t * direction[i]);
            input.push_back(std::bit_cast<uint32_t>(point.at[i]));
        }
        input.push_back(hit.label);
        input.push_back(static_cast<uint32_t>(hit.normal_axis) | (hit.normal_sign > 0 ? 256U : 0U));
        points.push_back(point);
    }
    TwinConstants constants{};
    constants.count = static_cast<uint32_t>(points.size());
    const auto got = run(k_twin_relief_mask_comp, upload_words(words, true), constants, TWIN_RELIEF_WORDS, input);
    for (size_t i = 0; i < points.size(); ++i) {
        const Point& point = points[i];
        const auto shares = mask->shares(point.at, point.label, point.axis, point.sign);
        const auto& weights = codec::radiance::relief_weights()[codec::radiance::relief_face(point.axis, point.sign)];
        const uint32_t* const here = &got[i * TWIN_RELIEF_WORDS];
        for (uint32_t j = 0; j < RELIEF_DIRECTIONS; ++j) {
            ASSERT_NEAR(std::bit_cast<float>(here[j]), shares.free(j), 1e-4) << "point " << i;
            ASSERT_EQ(std::bit_cast<float>(here[RELIEF_DIRECTIONS + j]), static_cast<float>(weights[j]) / 65536);
        }
    }
}

}  // namespace
}  // namespace citystream::client::test
