#include "missions/support/journal_text.h"

#include "geometry/error.h"
#include "geometry/io/json.h"
#include "missions/version.h"

namespace skycap::missions::support {

using Json = nlohmann::ordered_json;

std::string journal_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string identity_text(const Identity& run, const Json& more) {
  Json identity{{"version", version}, {"seed", run.seed}};
  identity.update(more);
  for (const auto& [key, value] : run.settings) identity[key] = value;
  return journal_line(identity);
}

namespace {

void require_same_format(const std::string& file, const Json& found, const Json& expected,
                         const std::string& cure) {
  const Json none = nullptr;
  if (found.value("format", none) == expected.value("format", none)) return;
  const Json theirs = found.value("version", none);
  throw Error(ErrorKind::bad_file,
              file + ": was written by version " +
                  (theirs.is_string() ? theirs.get<std::string>() : "(unknown)") +
                  ", whose journals cannot be resumed by this version; " + cure);
}

}  // namespace

void require_same_survey(const std::string& file, const std::string& found,
                         const std::string& expected, const std::string& cure) {
  const Json theirs = geometry::parse_json<Json>(found), ours = Json::parse(expected);
  if (!theirs.is_object()) {
    throw Error(ErrorKind::bad_file, file + ": is not a journal");
  }
  require_same_format(file, theirs, ours, cure);
  for (const auto& [key, value] : ours.items()) {
    const Json other = theirs.contains(key) ? theirs[key] : Json("-");
    if (other == value) continue;
    throw Error(ErrorKind::bad_file, file + ": cannot resume: " + key + " changed from " +
                                         journal_line(other) + " to " + journal_line(value) +
                                         "; restore it, or " + cure);
  }
}

}  // namespace skycap::missions::support
