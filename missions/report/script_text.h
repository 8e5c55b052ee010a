/// Text and bytes as they may stand in an HTML page, whoever chose them.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace skycap::missions::report {

/// Text for between tags or in a quoted attribute.
std::string html_text(std::string_view text);

/// JSON for a <script> that is not run. No name in it can end the script or open a comment: '<' is
/// written as an escape, and so are the two characters that end lines in older JavaScript.
std::string script_json(const nlohmann::ordered_json& json);

/// Which repetitions deflating looks for: all, or runs of a byte alone, which takes a fifth of the
/// time where there are no others.
enum class Repetition { any, runs };

/// zlib's format (RFC 1950), the same bytes for the same bytes.
std::string deflated(std::string_view bytes, Repetition repetition);

/// Of at most a gigabyte.
std::string base64(std::string_view bytes);

/// What a content security policy calls a script or style by: 'sha256-...'.
std::string policy_hash(std::string_view text);

}  // namespace skycap::missions::report
