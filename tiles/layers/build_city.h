// The builder: a stream of city objects to a finished archive. What citystream-build, the tests and the benches call.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "codec/atlas/atlas_form.h"
#include "codec/atlas/rectangle_packing_atlas.h"
#include "codec/result.h"
#include "tiles/city/city_model.h"
#include "tiles/layers/aerial_drape.h"
#include "tiles/layers/dress.h"
#include "tiles/layers/image_preparation.h"
#include "tiles/layers/mesh_form.h"
#include "tiles/layers/radiance_form.h"
#include "tiles/layers/relief_extraction.h"
#include "tiles/layers/stage_clock.h"
#include "tiles/layers/texture_law.h"
#include "tiles/tileset/directory.h"

namespace citystream::tiles::layers {

struct BuildOptions {
    std::string output;            ///< the archive; written under a temporary name and renamed
    std::string reference;         ///< a .glb of the uncompressed city beside it; empty = none
    std::string temporary_parent;  ///< where the spool folder goes; empty = the output's folder
    std::array<bool, tileset::kLayerCount> layers = {true, true, true, false};
    uint32_t jobs = 0;  ///< threads; 0 = all cores. The bytes do not depend on it
    uint64_t memory_limit = uint64_t{2} << 30;
    uint64_t leaf_triangles = 8192;      ///< tiles with more are split, down to 64 m
    bool auto_ground = true;             ///< a flat ground where the input has none
    std::vector<AerialImage> aerial;     ///< photographs over ground without texture, the made-up one too
    std::optional<uint64_t> dress_seed;  ///< puts made-up facades on plain walls; part of the city from then on
    bool extract_relief = true;          ///< turns the geometry of detailed walls into facades
    uint32_t merge_tolerance_mm = 0;     ///< facade maps that differ by no more become one; 0: equal maps only
    /// Of pictures' blocks: AtlasOptions::rate_distortion. A generated city of 1,000 buildings along demo_path.csv
    /// (PSNR, SSIM, FLIP against the reference; bytes of the flight): 0: 40.21 dB, 0.9912, 0.0243, 1.49 MB; 4: 40.15,
    /// 0.9907, 0.0251, 1.20; 8: 40.05, 0.9900, 0.0269, 1.08; 16: 39.82, 0.9884, 0.0285, 0.95.
    uint32_t rate_distortion = 4;
    MeshForm mesh;
    RadianceForm radiance;      ///< of the layer radiance, where it is asked for
    bool shared_charts = true;  ///< pictures that several tiles show are stored once, in the chart dictionary; of
                                ///< charts only
    codec::atlas::AtlasForm atlas_form = codec::atlas::AtlasForm::kCharts;
    /// Of pages: PageOptions::mips, at most PAGES_MOST_MIPS; above 3 only in tiles whose charts are large enough
    /// (affordable_mips). What is drawn smaller than the coarsest level flickers,
    /// each more makes borders twice as wide. Bytes of the atlas, of a flight, PSNR of its worst frame against the
    /// reference, of a generated city of 300 buildings: 0: 0.36 MB, 0.52, 32.4 dB; 1: 0.52, 0.46, 33.9; 2: 0.63, 0.53,
    /// 35.7; 3: 0.85, 0.59, 38.2; 4: 1.29; charts of their own: 0.45, 0.44, 41.4. With 120 textures on its walls: 2:
    /// 14.3 MB, 8.8, 31.5 dB; 3: 14.8, 9.2, 33.4; charts: 14.1, 8.7, 40.4.
    /// Nothing: as many as the texture law keeps at the tile's height.
    std::optional<uint32_t> page_mips = 3;
    /// Of pages. A generated city of 300 buildings (bytes of the atlas, of a flight's atlases, median PSNR and SSIM
    /// against the reference): kTight: 96.4 % of the pages filled, 1.26 MB, 0.53, 35.5 dB, 0.962; kPowerOfTwo: 100 %,
    /// 1.47 MB, 0.63, 35.3, 0.959, for most of what fill adds shows nothing new. 60 buildings with 60 textures: 97.8 %,
    /// 3.48 MB; 100 %, 3.55.
    codec::atlas::PageShape page_shape = codec::atlas::PageShape::kTight;
    TextureLaw texture_law;  ///< texels of images, by the tile's level
    /// How much images may lose to become smaller: search_chart's metric and tolerance. None by default, because the
    /// mean error of a picture says little of thin lines in it (road markings). Frames against the reference (PSNR,
    /// SSIM, FLIP; bytes of the flight) without shared charts, of Ingolstadt: none: 45.53 dB, 0.9933, 0.0186, 1.05 MB;
    /// ssim:0.99: 45.51, 0.9933, 0.0187, 0.91; flip:0.05: 44.89, 0.9897, 0.0199, 0.80; hvse:0.1: 44.43, 0.9879, 0.0212,
    /// 0.73; of a generated city: none: 41.65, 0.9917, 0.0241, 1.19; ssim:0.99: 39.12, 0.9869, 0.0263, 1.57; flip:0.05:
    /// 37.07, 0.9761, 0.0334, 0.96; hvse:0.1: 33.05, 0.9537, 0.0515, 0.83;
    /// with shared charts: none: 42.41, 0.9944, 0.0232, 0.68; ssim:0.99: 39.40, 0.9896, 0.0256, 0.66.
    codec::atlas::Metric saliency = {};
    std::string description;  ///< of the options, for Manifest::build_options
    const std::atomic<bool>* cancel =
        nullptr;  ///< set to stop early: the build fails with "interrupted" and leaves nothing behind
    /// Called from one thread at a time.
    std::function<void(std::string_view stage, uint64_t done, uint64_t total)> progress;
};

/// Delivers the city: fills header, catalog and report, and gives every object to the sink. An error does not undo what
/// came before.
using CitySource =
    std::function<Status(city::CityHeader&, city::CityCatalog&, city::CityReport&, const city::CitySink&)>;

struct BuildSummary {
    tileset::Manifest manifest;
    city::CityReport report;  ///< of the reader and of the builder
    uint64_t archive_bytes = 0;
    uint64_t reference_bytes = 0;
    double seconds = 0;
    std::vector<StageTime> stages;                 ///< in their order; the sum is about `seconds`
    uint64_t peak_memory_bytes = 0;                ///< of the process
    uint64_t tiles_kept_in_charts = 0;             ///< although pages were asked for: they hold no alpha
    std::optional<ImagePreparationReport> images;  ///< where the city has images
    std::optional<DressReport> dressing;           ///< where it was asked for
    std::optional<ReliefExtractionReport> relief;  ///< where it was asked for and a building was looked at
    std::optional<RadianceReport> radiance;        ///< where the layer was asked for
};

/// Builds. `report` is filled also when the build fails. Error: no objects, unreadable input, disk, interrupted, pages
/// asked to share charts or to have too many mips, normals of bits that there are not, check_radiance_form.
Result<BuildSummary> build_city(const BuildOptions& options, const CitySource& source, city::CityReport& report);

}  // namespace citystream::tiles::layers
