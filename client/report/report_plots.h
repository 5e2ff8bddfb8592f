// The plots of a report.
#pragma once

#include <map>
#include <string>

#include "client/report/sweep.h"

namespace citystream::client {

/// File names and SVG texts. Those of light are of lit flights alone.
std::map<std::string, std::string> plots_of(const SweepResult& result);

}  // namespace citystream::client
