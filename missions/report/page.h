/// A page that a browser shows by itself: one file, no server, nothing fetched.
///
/// All that is shown comes as data; what the page does with it is in page/*.js, what it looks like
/// in page/style.css. Its content security policy lets nothing run but those scripts, by their
/// hashes, and lets nothing be loaded.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "missions/report/cloud_code.h"

namespace skycap::missions::report {

/// A cloud of the page's 3-D view.
struct PageCloud {
  std::string name;  ///< of ours: measured, missing or model
  CloudCode code;
};

/// `data` is what page/main.js reads: {"kind", "title", ...}. The same text for the same values.
std::string page_text(const std::string& title, nlohmann::ordered_json data,
                      const std::vector<PageCloud>& clouds);

}  // namespace skycap::missions::report
