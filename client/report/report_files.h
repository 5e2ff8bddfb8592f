// The files of a report: frames.csv (a row a frame and setting), report.json, plots (SVG) and index.html with the
// pictures.
#pragma once

#include <string>

#include "client/report/sweep.h"
#include "codec/result.h"

namespace citystream::client {

/// Writes everything but the pictures (run_sweep wrote them to folder/pictures) into `folder`, which exists.
Status write_report(const std::string& folder, const SweepOptions& options, const SweepResult& result);

std::string frames_csv(const SweepResult& result);
std::string report_json(const SweepOptions& options, const SweepResult& result);
std::string report_html(const SweepOptions& options, const SweepResult& result);

}  // namespace citystream::client
