/// Decides which requests are served: those with a token of this run, for this address, from this
/// page. Other programs and pages of the machine do not know the tokens; pages of other sites fail
/// by Host (DNS rebinding) or Origin (cross-site requests).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "missions/studio/http_interface.h"

namespace skycap::missions::studio {

/// Compares in a time that depends on the lengths only.
bool equal_in_constant_time(std::string_view a, std::string_view b);

/// Returns 32 random hexadecimal digits from the system. Throws Error{bad_file} without a source.
std::string make_token();

/// First segment of a permitted path.
enum class Realm {
  page,   ///< the page and its functions
  files,  ///< files of the work folder, read only, in a frame without access to the page
};

class RequestGuard {
 public:
  RequestGuard(std::string page_token, std::string file_token)
      : page_token_(std::move(page_token)), file_token_(std::move(file_token)) {}

  /// Sets the port of the address, which Host and Origin must name.
  void set_port(int port);

  const std::string& page_token() const { return page_token_; }
  const std::string& file_token() const { return file_token_; }

  /// Returns the answer to a rejected request, or nullopt. GET, HEAD and POST are permitted; POST
  /// requires the page's token, its Origin and JSON; pieces of uploads are binary.
  std::optional<HttpAnswer> reject(const HttpRequest& request) const;

  /// Returns the realm of a path, or nullopt if the token is wrong.
  std::optional<Realm> find_realm(const std::string& path) const;

 private:
  std::string page_token_, file_token_;
  std::string addresses_[2];  ///< permitted values of Host
};

}  // namespace skycap::missions::studio
