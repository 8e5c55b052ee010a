#include "missions/package/former_fields.h"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "missions/config/former_names.h"

namespace skycap::missions::package {
namespace {

using Json = nlohmann::ordered_json;

struct Renamed {
  std::string_view former, current;
};

constexpr auto fields = std::to_array<Renamed>({
    {"coverage_ceiling", "attainable_coverage"},
    {"belief", "estimate"},
    {"believed", "estimated"},
    {"anew", "replanned"},
    {"promised_coverage", "predicted_coverage"},
    {"flown_again", "reflight"},
    {"survey_flown_again", "survey_reflight"},
    {"frames_on_way", "en_route_frames"},
    {"unreached", "skipped_views"},
    {"seen_too_thinly", "undersampled"},
    {"never_seen", "unobserved"},
});

/// Values of the fields "stop_reason", "stop" and "reason".
constexpr auto words = std::to_array<Renamed>({
    {"nowhere_to_go", "no_reachable_view"},
    {"nothing_in_reach", "no_reachable_view"},
    {"wanted_coverage", "target_coverage"},
    {"little_gain", "min_gain"},
    {"most_length", "max_length"},
    {"most_time", "max_time"},
    {"seen_too_thinly", "undersampled"},
    {"never_seen", "unobserved"},
});

std::string current_in(std::span<const Renamed> names, const std::string& name) {
  const auto known = std::ranges::find(names, name, &Renamed::former);
  return known == names.end() ? name : std::string(known->current);
}

/// `field` is the former name of the field with the value `json`.
Json with_current_fields(Json json, const std::string& field) {
  if (json.is_array()) {
    for (Json& item : json) item = with_current_fields(std::move(item), field);
  } else if (json.is_object()) {
    Json current = Json::object();
    for (auto& [name, value] : json.items()) {
      // Settings are keys of the mission file.
      const bool is_estimate = field == "belief" && name == "predicted_coverage";
      const std::string now = field == "settings" ? config::current_path(name)
                              : is_estimate       ? "estimated_coverage"
                                                  : current_in(fields, name);
      current[now] = with_current_fields(std::move(value), name);
    }
    return current;
  } else if (json.is_string() && (field == "stop_reason" || field == "stop" || field == "reason")) {
    return current_in(words, json.get<std::string>());
  }
  return json;
}

}  // namespace

void use_current_fields(Json& results) { results = with_current_fields(std::move(results), ""); }

}  // namespace skycap::missions::package
