// What a viewer without our atlas would fetch of a city's images: each whole, once, when something that shows it comes
// into view. It culls as we do or better: an object is in view when its box is in the frustum and not hidden behind the
// surfaces of all objects (client/select/depth_picture.h), object by object rather than tile by tile.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "client/select/camera.h"
#include "codec/result.h"
#include "tiles/city/city_model.h"
#include "tiles/layers/build_city.h"
#include "tiles/layers/image_cache.h"
#include "tiles/tileset/directory.h"

namespace citystream::bench {

/// Bytes of images on the wire. "Matched": view-matched, as fine as the finest tile shows it (thesis section 7.1), by
/// the builder's own code.
struct ImageBytes {
    uint64_t bc1 = 0;           ///< matched, all mips, in the blocks and frames of shared charts
    uint64_t jpeg = 0;          ///< the file where the image is one; else as JPEG, of the quality of `matched_jpeg`
    uint64_t matched_jpeg = 0;  ///< matched, of the least quality (a multiple of 5) whose PSNR is that of `bc1`
    ImageBytes& operator+=(const ImageBytes& other);
};

class PlainViewer {
  public:
    /// Reads the city, prepares its images in `folder`. Error: unreadable input, the disk, facades with relief (whose
    /// pictures are not images).
    static Result<std::unique_ptr<PlainViewer>> read(const tiles::layers::CitySource& source,
                                                     const std::string& folder);

    /// The images of what a camera sees are added to `seen`. O(triangles).
    void look(const client::Camera& camera, std::set<uint32_t>& seen) const;

    /// Of one image, encoded with this strength of AtlasOptions::rate_distortion; remembered. An image that cannot be
    /// read has no bytes.
    const ImageBytes& bytes_of(uint32_t image, uint32_t rate_distortion);

  private:
    struct Object {
        tiles::tileset::Bounds bounds;  ///< absolute metres
        std::vector<uint32_t> images;
        std::vector<std::array<std::array<double, 3>, 3>> surfaces;  ///< triangles large enough to hide something
    };
    PlainViewer() = default;
    void take(const tiles::city::CityObject& object);
    Status prepare(const tiles::layers::CitySource& source, const std::string& folder);

    tiles::city::CityCatalog catalog_;
    std::vector<Object> objects_;
    std::unique_ptr<tiles::layers::PreparedImages> prepared_;
    std::unique_ptr<tiles::layers::ImageCache> matched_, as_they_are_;
    std::map<std::pair<uint32_t, uint32_t>, ImageBytes> bytes_;  ///< by image and strength
};

}  // namespace citystream::bench
