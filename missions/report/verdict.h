/// What a survey is worth at a glance: its figures, each with the bound it is held against.
#pragma once

#include <nlohmann/json.hpp>

namespace skycap::missions::report {

/// From a package's summary:
///   {"answer": "complete", "because": "...", "lights": [{"name", "figure", "value", "form",
///    "light", "rule"}]}
/// `figure` is the path of the value in the summary, `form` how it is shown: share, metres,
/// minutes, count. A light is green, amber, red, or none where nothing is asked of the figure;
/// `rule` says which value gives which. docs/report.md lists them.
nlohmann::ordered_json verdict(const nlohmann::ordered_json& summary);

}  // namespace skycap::missions::report
