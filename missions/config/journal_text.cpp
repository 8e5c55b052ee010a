#include "missions/config/journal_text.h"

#include "geometry/error.h"
#include "geometry/io/json.h"
#include "missions/config/survey_settings.h"
#include "missions/version.h"

namespace skycap::missions::config {

using Json = nlohmann::ordered_json;

std::string journal_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string identity_text(const config::Mission& mission, const Json& more) {
  Json identity{{"version", version}, {"seed", mission.seed}};
  identity.update(more);
  for (const auto& [key, value] : survey_settings(mission)) identity[key] = value;
  return journal_line(identity);
}

void require_same_survey(const std::string& file, const std::string& found,
                         const std::string& wanted, const std::string& cure) {
  const Json theirs = geometry::parse_json<Json>(found), ours = Json::parse(wanted);
  if (!theirs.is_object()) {
    throw Error(ErrorKind::bad_file, file + ": does not begin as a journal");
  }
  for (const auto& [key, value] : ours.items()) {
    const Json other = theirs.contains(key) ? theirs[key] : Json("-");
    if (other == value) continue;
    throw Error(ErrorKind::bad_file, file + ": was begun otherwise: " + key + " was " +
                                         journal_line(other) + " and is " + journal_line(value) +
                                         "; take that back, or " + cure);
  }
}

}  // namespace skycap::missions::config
