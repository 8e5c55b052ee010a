/// Interface between the studio and its HTTP server. The server is a module, because cpp-httplib
/// loads OpenSSL and Brotli, which no other command needs.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace skycap::missions::studio {

/// Request as it arrived; nothing in it is trusted.
struct HttpRequest {
  std::string method;                        ///< such as GET
  std::string path;                          ///< decoded path without query, begins with a slash
  std::map<std::string, std::string> query;  ///< decoded query
  /// Values of the headers Host and Origin; more than one if the header is repeated.
  std::vector<std::string> hosts, origins;
  std::string content_type;  ///< empty without a body
  bool is_encoded = false;   ///< whether the body is compressed
  std::string body;          ///< empty while only the head has been read
};

struct HttpAnswer {
  int status = 200;
  std::string type = "application/json";  ///< media type
  std::string body;
  std::vector<std::pair<std::string, std::string>> headers;  ///< further headers
  std::filesystem::path file;  ///< file that is sent instead of `body`, unless empty
  /// Source of a stream that is sent instead of `body`, unless null. Each call waits at most one
  /// second and returns the next piece, or nullopt at the end.
  std::function<std::optional<std::string>()> next_piece;
};

/// Answers requests. The functions are called from several threads and do not throw.
class RequestHandler {
 public:
  virtual ~RequestHandler() = default;
  /// Checks the head of a request before its body is read. Returns the answer to a request that is
  /// rejected, otherwise nullopt.
  virtual std::optional<HttpAnswer> reject(const HttpRequest& head) const = 0;
  virtual HttpAnswer answer(const HttpRequest& request) = 0;
};

/// HTTP server on 127.0.0.1. Each request is bounded: one request per connection, `max_body` bytes
/// of content, 64 KiB of headers and three seconds to arrive.
class HttpServer {
 public:
  static constexpr std::size_t max_body = std::size_t{4} << 20;  ///< [byte]

  virtual ~HttpServer() = default;
  virtual int port() const = 0;
  virtual void run() = 0;   ///< serves until stop()
  virtual void stop() = 0;  ///< may be called from another thread, before or during run()
};

/// Listens on a port; zero: any free port. The handler must outlive the server. Throws
/// Error{bad_usage} if the port is in use, and Error{bad_file} if the module is missing.
std::unique_ptr<HttpServer> make_http_server(int port, RequestHandler& handler);

}  // namespace skycap::missions::studio
