/// Self-contained HTML reports: a single file without a server or external resources.
///
/// The content is embedded as data, which the scripts page/*.js display with page/style.css. The
/// content security policy permits only these scripts, identified by their hashes, and no loading
/// of resources.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "missions/report/cloud_code.h"

namespace skycap::missions::report {

/// Cloud in the report's 3-D view.
struct PageCloud {
  std::string name;  ///< one of the report's clouds: measured, missing or model
  CloudCode code;
};

/// Returns the report. `data` is the input of page/main.js: {"kind", "title", ...}. The output is
/// deterministic.
std::string page_text(const std::string& title, nlohmann::ordered_json data,
                      const std::vector<PageCloud>& clouds);

}  // namespace skycap::missions::report
