/// Assessment of a survey: key figures with a traffic-light rating each.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace skycap::missions::report {

/// Key figure with its rating.
struct Light {
  std::string name, figure;  ///< `figure` is the path of the value in the summary
  std::string form;          ///< display format: share, metres, minutes or count
  nlohmann::ordered_json value;
  std::string light = "none";  ///< green, amber or red; none for unrated figures
  std::string rule;            ///< rating rule; docs/reference/report.md lists the rules
};

struct Verdict {
  bool is_complete = false;
  std::string because;
  std::vector<Light> lights;
  std::string else_light = "red";  ///< rating if incomplete; a complete survey is green
};

/// Returns {"answer": "complete", "because": "...", "light": "green", "lights": [{"name", "figure",
/// "value", "form", "light", "rule"}]}.
nlohmann::ordered_json to_json(const Verdict& verdict);

/// Returns descriptions of the stop reasons by their names in files: {"complete": "nothing more is
/// worth a view", ...}.
nlohmann::ordered_json stop_words();

/// Returns the assessment for a package's summary.
nlohmann::ordered_json verdict(const nlohmann::ordered_json& summary);

}  // namespace skycap::missions::report
