// HTTP server of the studio (cpp-httplib). One request per connection, each bounded in size and
// time: cpp-httplib itself limits neither the number of headers nor the total time.
#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <memory>
#include <thread>
#include <utility>

#include <httplib.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "missions/studio/http_interface.h"

namespace skycap::missions::studio {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds max_arrival(3);  ///< from the first byte to the last of a request
constexpr int write_timeout_ms = 10'000;        ///< for each piece of an answer
constexpr std::size_t max_head = std::size_t{64} << 10;  ///< request line and headers [byte]
constexpr std::size_t thread_count = 64;

/// Connection whose request is bounded in size and time.
class BoundedStream : public httplib::Stream {
 public:
  explicit BoundedStream(int socket) : socket_(socket), deadline_(Clock::now() + max_arrival) {}

  bool is_readable() const override { return begin_ < end_ || wait_for(POLLIN, remaining_ms()); }
  bool is_writable() const override { return wait_for(POLLOUT, 0); }

  ssize_t read(char* data, size_t size) override {
    if (begin_ == end_ && !fill()) return -1;
    const std::size_t count = std::min(size, end_ - begin_);
    std::copy_n(buffer_.data() + begin_, count, data);
    begin_ += count;
    return static_cast<ssize_t>(count);
  }

  ssize_t write(const char* data, size_t size) override {
    if (!wait_for(POLLOUT, write_timeout_ms)) return -1;
    return ::send(socket_, data, size, MSG_NOSIGNAL);
  }

  void get_remote_ip_and_port(std::string& ip, int& port) const override { ip = "", port = 0; }
  void get_local_ip_and_port(std::string& ip, int& port) const override { ip = "", port = 0; }
  int socket() const override { return socket_; }

 private:
  int remaining_ms() const {
    using std::chrono::milliseconds;
    const auto left = std::chrono::duration_cast<milliseconds>(deadline_ - Clock::now()).count();
    return static_cast<int>(std::max<long>(0, left));
  }

  bool wait_for(short event, int timeout_ms) const {
    pollfd wait{socket_, event, 0};
    return ::poll(&wait, 1, timeout_ms) > 0;
  }

  /// Reads what has arrived. Returns false at the end, after an error, and at a limit.
  bool fill() {
    if (received_ > max_head + HttpServer::max_body) return false;
    if (!wait_for(POLLIN, remaining_ms())) return false;
    const ssize_t count = ::recv(socket_, buffer_.data(), buffer_.size(), 0);
    if (count <= 0) return false;
    begin_ = 0, end_ = static_cast<std::size_t>(count);
    received_ += end_;
    return true;
  }

  int socket_;
  Clock::time_point deadline_;
  std::array<char, 4096> buffer_{};
  std::size_t begin_ = 0, end_ = 0, received_ = 0;
};

std::vector<std::string> values_of(const httplib::Request& request, const char* name) {
  std::vector<std::string> values;
  const auto [begin, end] = request.headers.equal_range(name);
  for (auto at = begin; at != end; ++at) values.push_back(at->second);
  return values;
}

HttpRequest to_request(const httplib::Request& request) {
  HttpRequest result{.method = request.method,
                     .path = request.path,
                     .query = {},
                     .hosts = values_of(request, "Host"),
                     .origins = values_of(request, "Origin"),
                     .content_type = request.get_header_value("Content-Type"),
                     .is_encoded = request.has_header("Content-Encoding"),
                     .body = request.body};
  for (const auto& [name, value] : request.params) result.query[name] = value;
  return result;
}

/// Sends a file in pieces, so that its size does not matter.
void send_file(const HttpAnswer& answer, httplib::Response& response) {
  std::error_code failure;
  const auto size = std::filesystem::file_size(answer.file, failure);
  auto stream = std::make_shared<std::ifstream>(answer.file, std::ios::binary);
  if (failure || !*stream) {
    response.status = 404;
    return;
  }
  if (size == 0) return response.set_content("", answer.type);
  response.set_content_provider(
      size, answer.type, [stream](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
        std::array<char, 65536> piece;
        stream->seekg(static_cast<std::streamoff>(offset));
        stream->read(piece.data(), static_cast<std::streamsize>(std::min(length, piece.size())));
        const auto count = static_cast<std::size_t>(stream->gcount());
        return count > 0 && sink.write(piece.data(), count);
      });
}

void send_pieces(const HttpAnswer& answer, httplib::Response& response) {
  response.set_chunked_content_provider(
      answer.type, [next = answer.next_piece](std::size_t, httplib::DataSink& sink) {
        const std::optional<std::string> piece = next();
        if (!piece) {
          sink.done();
          return true;
        }
        return piece->empty() || sink.write(piece->data(), piece->size());
      });
}

void send(const HttpAnswer& answer, httplib::Response& response) {
  response.status = answer.status;
  for (const auto& [name, value] : answer.headers) response.set_header(name, value);
  if (answer.next_piece) return send_pieces(answer, response);
  if (!answer.file.empty()) return send_file(answer, response);
  response.set_content(answer.body, answer.type);
}

class BoundedServer : public HttpServer, private httplib::Server {
 public:
  explicit BoundedServer(RequestHandler& handler) {
    new_task_queue = [] { return new httplib::ThreadPool(thread_count); };
    set_payload_max_length(max_body);
    set_pre_routing_handler([&handler](const httplib::Request& request, httplib::Response& answer) {
      const std::optional<HttpAnswer> rejection = handler.reject(to_request(request));
      if (!rejection) return HandlerResponse::Unhandled;
      send(*rejection, answer);
      return HandlerResponse::Handled;
    });
    const auto respond = [&handler](const httplib::Request& request, httplib::Response& answer) {
      send(handler.answer(to_request(request)), answer);
    };
    Get(".*", respond);
    Post(".*", respond);
  }

  /// Returns whether the port is free.
  bool open(int port) {
    port_ =
        port == 0 ? bind_to_any_port("127.0.0.1") : (bind_to_port("127.0.0.1", port) ? port : -1);
    return port_ > 0;
  }

  int port() const override { return port_; }

  void run() override {
    is_entered_ = true;
    if (!is_stopped_) listen_after_bind();
    is_entered_ = false;
  }

  /// httplib ignores a stop before it listens, so that this waits for it.
  void stop() override {
    is_stopped_ = true;
    while (is_entered_ && !is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    httplib::Server::stop();
  }

 private:
  bool process_and_close_socket(int socket) override {
    BoundedStream stream(socket);
    bool is_closed = false;
    // Answers are not compressed: the connection does not leave the machine.
    const bool is_done = process_request(stream, true, is_closed, [](httplib::Request& request) {
      request.headers.erase("Accept-Encoding");
      request.ranges.clear();
    });
    ::shutdown(socket, SHUT_RDWR);
    ::close(socket);
    return is_done;
  }

  int port_ = -1;
  std::atomic<bool> is_entered_ = false, is_stopped_ = false;
};

}  // namespace
}  // namespace skycap::missions::studio

/// Returns a new server, or null if the port is in use.
extern "C" [[gnu::visibility("default")]] skycap::missions::studio::HttpServer* skycap_http_server(
    int port, skycap::missions::studio::RequestHandler& handler) {
  auto server = std::make_unique<skycap::missions::studio::BoundedServer>(handler);
  return server->open(port) ? server.release() : nullptr;
}
