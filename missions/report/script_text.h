/// Encodes strings and binary data from any source safely for HTML reports.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace skycap::missions::report {

/// Escapes text for use between tags or in quoted attributes.
std::string html_text(std::string_view text);

/// Returns JSON for a data-only <script> element. '<' is escaped, so that no string can close the
/// script or open a comment. The line separators of older JavaScript versions (U+2028, U+2029) are
/// escaped as well.
std::string script_json(const nlohmann::ordered_json& json);

/// Repetitions searched for during compression. `runs` considers only runs of one byte, which takes
/// a fifth of the time for data without other repetitions.
enum class Repetition { any, runs };

/// Compresses data in zlib format (RFC 1950). The output is deterministic.
std::string deflated(std::string_view bytes, Repetition repetition);

/// Encodes up to 1 GB.
std::string base64(std::string_view bytes);

/// Returns the hash source of a script or style in a content security policy: 'sha256-...'.
std::string policy_hash(std::string_view text);

}  // namespace skycap::missions::report
