/// Self-contained HTML reports: a single file without a server or external resources.
///
/// The content is embedded as data, which the scripts page/*.js display with page/style.css. The
/// content security policy permits only these scripts, identified by their hashes, and no loading
/// of resources.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
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

/// Returns a report with an image of the site as the ground of its 3-D view. `corners` are those of
/// the JPEG image in the mission frame [m]: top left, top right, bottom right and bottom left.
std::string with_background(std::string page, const std::string& name, std::string_view jpeg,
                            const std::array<Eigen::Vector2d, 4>& corners);

}  // namespace skycap::missions::report
