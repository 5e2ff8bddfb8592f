// The part of a report's page that is about light: a table of what each setting costs and brings, and what radiance
// costs of the tiles' bytes.
#pragma once

#include <string>

#include "client/report/sweep.h"

namespace citystream::client {

/// HTML; empty where frames are not lit.
std::string light_section(const SweepResult& result);

}  // namespace citystream::client
