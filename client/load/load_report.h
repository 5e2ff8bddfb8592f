// The outcome of a load test as JSON and as text.
#pragma once

#include <string>

#include "client/load/load_run.h"

namespace citystream::client {

/// One JSON object; README.md beside this file lists its fields.
std::string load_json(const LoadOutcome& outcome, const LoadOptions& options);
/// A few lines for a person.
std::string load_text(const LoadOutcome& outcome, const LoadOptions& options);

/// Bytes received in bodies for each byte of a prefix that was drawn; 0 when nothing was drawn.
double over_fetch_of(const LoadMeasurements& measured);

}  // namespace citystream::client
