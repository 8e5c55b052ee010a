/// What a survey is worth at a glance: its figures, each with the bound it is held against.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace skycap::missions::report {

/// A figure, and what is held of it.
struct Light {
  std::string name, figure;  ///< `figure` is the path of the value in the summary
  std::string form;          ///< how it is shown: share, metres, minutes, count
  nlohmann::ordered_json value;
  std::string light = "none";  ///< green, amber, red, or none where nothing is asked of the figure
  std::string rule;  ///< which value gives which light; docs/reference/report.md lists them
};

struct Verdict {
  bool is_complete = false;
  std::string because;
  std::vector<Light> lights;
  std::string else_light = "red";  ///< of what is not complete; complete is green
};

/// {"answer": "complete", "because": "...", "light": "green",
///  "lights": [{"name", "figure", "value", "form", "light", "rule"}]}
nlohmann::ordered_json json_of(const Verdict& verdict);

/// {"complete": "nothing more is worth a view", ...}: why surveys end, in words, by the words that
/// files have for it.
nlohmann::ordered_json stop_words();

/// The verdict from a package's summary.
nlohmann::ordered_json verdict(const nlohmann::ordered_json& summary);

}  // namespace skycap::missions::report
