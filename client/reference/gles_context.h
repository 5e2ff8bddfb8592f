// A surfaceless OpenGL ES 3 context through EGL, for machines without a display.
#pragma once

#include <memory>
#include <string>

#include "codec/result.h"

namespace citystream::client {

/// Owns an EGL display and context, current on the thread that made it. Destroys both.
class GlesContext {
  public:
    /// Tries the surfaceless platform, then the first EGL device. Error: no EGL platform gives an OpenGL ES 3 context.
    static Result<std::unique_ptr<GlesContext>> create();
    virtual ~GlesContext() = default;
    virtual void make_current() = 0;
    virtual std::string device_name() const = 0;
};

}  // namespace citystream::client
