#include "missions/studio/request_guard.h"

#include <algorithm>
#include <array>

#include <sys/random.h>

#include "geometry/error.h"

namespace skycap::missions::studio {
namespace {

HttpAnswer rejection(int status, const std::string& reason) {
  return {.status = status, .type = "text/plain; charset=utf-8", .body = reason + "\n"};
}

}  // namespace

bool equal_in_constant_time(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]);
  }
  return difference == 0;
}

std::string make_token() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw Error(ErrorKind::bad_file, "cannot read random numbers from the system (getrandom)");
  }
  std::string token;
  for (const unsigned char byte : bytes) {
    for (const int digit : {byte >> 4, byte & 15}) token += "0123456789abcdef"[digit];
  }
  return token;
}

void RequestGuard::set_port(int port) {
  addresses_[0] = "127.0.0.1:" + std::to_string(port);
  addresses_[1] = "localhost:" + std::to_string(port);
}

std::optional<Realm> RequestGuard::find_realm(const std::string& path) const {
  if (!path.starts_with('/')) return std::nullopt;
  const std::string_view token = std::string_view(path).substr(1, path.find('/', 1) - 1);
  const bool is_page = equal_in_constant_time(token, page_token_);
  const bool is_file = equal_in_constant_time(token, file_token_);
  if (is_page) return Realm::page;
  return is_file ? std::optional(Realm::files) : std::nullopt;
}

std::optional<HttpAnswer> RequestGuard::reject(const HttpRequest& request) const {
  const bool is_read = request.method == "GET" || request.method == "HEAD";
  if (!is_read && request.method != "POST") return rejection(405, "unsupported method");
  if (request.hosts.size() != 1 ||
      std::ranges::find(addresses_, request.hosts[0]) == std::end(addresses_)) {
    return rejection(403, "Host must be the address that skycap studio has printed");
  }
  const bool is_from_page =
      request.origins.size() == 1 && request.origins[0] == "http://" + request.hosts[0];
  if (request.origins.size() > 1 || (!request.origins.empty() && !is_from_page)) {
    return rejection(403, "Origin must be the address of the page");
  }
  const std::optional<Realm> realm = find_realm(request.path.empty() ? "/" : request.path);
  if (!realm) return rejection(403, "wrong token; open the address that skycap studio has printed");
  if (is_read) return std::nullopt;
  if (*realm != Realm::page || !is_from_page) return rejection(403, "POST requires the page");
  const bool is_piece = request.path.starts_with("/" + page_token_ + "/api/uploads/") &&
                        request.query.contains("offset");
  const char* const type = is_piece ? "application/octet-stream" : "application/json";
  if (request.content_type != type || request.is_encoded) {
    return rejection(415, std::string("content must be ") + type + " without compression");
  }
  return std::nullopt;
}

}  // namespace skycap::missions::studio
