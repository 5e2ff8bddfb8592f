// The same city uncompressed as standard glTF 2.0 (.glb): full-precision positions about a local origin, original
// images, facade relief as instanced triangles (EXT_mesh_gpu_instancing). What the reference renderer draws, and what
// any other tool can check us with.
#pragma once

#include <memory>
#include <string>

#include "codec/result.h"
#include "tiles/city/city_model.h"
#include "tiles/layers/facade_painter.h"
#include "tiles/quadtree/build_object.h"

namespace citystream::tiles::layers {

/// Streams: objects go to a spool in `folder`, the file is written at the end under a temporary name and renamed.
class ReferenceWriter {
  public:
    static Result<std::unique_ptr<ReferenceWriter>> create(const std::string& path, const std::string& folder);
    virtual ~ReferenceWriter() = default;
    virtual Status add(const city::CityObject& object) = 0;
    /// `origin`: of the manifest; positions count from it (x, y) and from the middle of the extent's height (z).
    virtual Status finish(const city::CityCatalog& catalog, FacadePainter& facades, const quadtree::GridBox& extent,
                          const GridPoint& origin) = 0;
};

}  // namespace citystream::tiles::layers
