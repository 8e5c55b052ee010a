/// Client of `skycap serve` in one header for C++17 and POSIX. For the messages see
/// docs/reference/live-protocol.md. Requires zlib.
///
///     skycap_live::Survey survey("unix:survey.sock");
///     std::string answer = survey.next();     // JSON, as printed by `skycap next --json`
///     answer = survey.add_points(xyz, pose);
#pragma once

#include <array>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>
#include <zlib.h>

namespace skycap_live {

/// World from the sensor's optical frame: three rows of the matrix [rotation | position].
using Pose = std::array<double, 12>;

/// Pose error as one of the following: one standard deviation along and around each axis [metres,
/// degrees]; a covariance; or empty, for the value of the mission. The covariance is that of ROS's
/// PoseWithCovariance: x y z rx ry rz along and around the axes of the mission's frame [m, rad],
/// row by row.
using PoseSigma = std::array<double, 2>;
using PoseCovariance = std::array<double, 36>;
using PoseError = std::variant<std::monostate, PoseSigma, PoseCovariance>;

/// Origin of a scan: the requested view, or en route to it, if the mission measures en route.
enum class From { view, en_route };

/// Error answer of the server to an invalid message. The survey remains unchanged.
struct Rejected : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Survey {
 public:
  /// Connects to `address` as printed by the server: unix:PATH or tcp:127.0.0.1:PORT. All functions
  /// throw std::runtime_error if the connection fails.
  explicit Survey(const std::string& address) {
    if (address.rfind("unix:", 0) == 0) {
      sockaddr_un socket_address{};
      socket_address.sun_family = AF_UNIX;
      if (address.size() - 5 >= sizeof socket_address.sun_path) {
        throw std::runtime_error("the socket path is too long");
      }
      std::strncpy(socket_address.sun_path, address.c_str() + 5,
                   sizeof socket_address.sun_path - 1);
      open(AF_UNIX, socket_address);
    } else {
      sockaddr_in socket_address{};
      socket_address.sin_family = AF_INET;
      socket_address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      socket_address.sin_port =
          htons(static_cast<std::uint16_t>(std::stoi(address.substr(address.rfind(':') + 1))));
      open(AF_INET, socket_address);
    }
    try {
      count(ask("{\"type\":\"hello\"}"));
    } catch (...) {
      ::close(socket_);
      throw;
    }
  }
  Survey(const Survey&) = delete;
  Survey& operator=(const Survey&) = delete;
  ~Survey() { ::close(socket_); }

  std::string next() { return ask("{\"type\":\"next\"}"); }

  /// Adds points in the mission's frame as consecutive x y z [m]. `pixels` is empty or has the
  /// pixel of each point in ascending order: row * width + column of the mission's camera.
  std::string add_points(const std::vector<float>& xyz, const Pose& pose,
                         const std::vector<std::uint32_t>& pixels = {}, const PoseError& error = {},
                         From from = From::view) {
    std::string payload(reinterpret_cast<const char*>(xyz.data()), xyz.size() * sizeof(float));
    payload.append(reinterpret_cast<const char*>(pixels.data()), pixels.size() * sizeof pixels[0]);
    return add("\"format\":\"points\",\"points\":" + std::to_string(xyz.size() / 3) +
                   ",\"has_pixels\":" + (pixels.empty() ? "false" : "true"),
               pose, error, payload, from);
  }

  /// Adds points in the sensor's optical frame as consecutive x y z [m], in any order. The server
  /// assigns each point to a pixel of the mission's camera.
  std::string add_cloud(const std::vector<float>& xyz, const Pose& pose,
                        const PoseError& error = {}, From from = From::view) {
    return add("\"format\":\"cloud\",\"points\":" + std::to_string(xyz.size() / 3), pose, error,
               {reinterpret_cast<const char*>(xyz.data()), xyz.size() * sizeof(float)}, from);
  }

  /// Adds a depth image, row by row, in steps of `unit` [m]. 0 and 65535 are no-return values.
  /// `intrinsics` is fx fy cx cy, optionally followed by k1 k2 p1 p2 k3. If empty, that of the
  /// mission applies.
  std::string add_depth(const std::vector<std::uint16_t>& depth, int width, int height, double unit,
                        const Pose& pose, const PoseError& error = {},
                        const std::vector<double>& intrinsics = {}, From from = From::view) {
    return add("\"format\":\"depth\",\"width\":" + std::to_string(width) +
                   ",\"height\":" + std::to_string(height) + ",\"unit\":" + number(unit) +
                   (intrinsics.empty() ? "" : row("lens", intrinsics)),
               pose, error,
               {reinterpret_cast<const char*>(depth.data()), depth.size() * sizeof depth[0]}, from);
  }

  /// Requests a replacement for the view of the answer `id`. `reason` is inserted into JSON without
  /// escaping.
  std::string reject(std::size_t id, const std::string& reason) {
    return ask("{\"type\":\"refuse\",\"id\":" + std::to_string(id) + ",\"reason\":\"" + reason +
               "\"}");
  }

  std::string finish() { return ask("{\"type\":\"finish\"}"); }

 private:
  template <typename Address>
  void open(int family, const Address& socket_address) {
    socket_ = ::socket(family, SOCK_STREAM, 0);
    if (::connect(socket_, reinterpret_cast<const sockaddr*>(&socket_address),
                  sizeof socket_address) == 0)
      return;
    ::close(socket_);
    throw std::runtime_error("cannot connect to a server at this address");
  }

  /// Returns the shortest text from which the same number can be read.
  static std::string number(double value) {
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, value).ptr};
  }

  /// Returns a header field with an array of numbers.
  template <typename Numbers>
  static std::string row(const char* key, const Numbers& values) {
    std::string text;
    for (const double value : values) text += (text.empty() ? "" : ",") + number(value);
    return std::string(",\"") + key + "\":[" + text + "]";
  }

  std::string add(const std::string& fields, const Pose& pose, const PoseError& error,
                  const std::string& payload, From from) {
    std::string header = "{\"type\":\"scan\",\"number\":" + std::to_string(scans_) + "," + fields;
    if (from == From::en_route) header += ",\"en_route\":" + std::to_string(en_route_);
    header += row("pose", pose);
    if (const auto* sigma = std::get_if<PoseSigma>(&error)) header += row("pose_sigma", *sigma);
    if (const auto* covariance = std::get_if<PoseCovariance>(&error)) {
      header += row("pose_covariance", *covariance);
    }
    std::string answer = ask(header + "}", payload);
    count(answer);
    return answer;
  }

  /// Reads the number of scans, and of en-route scans if the mission has them, from an answer.
  void count(const std::string& answer) {
    const auto at = [&](const std::string& field) { return answer.find("\"" + field + "\":"); };
    const auto number = [&](std::size_t socket_address) {
      return std::stoul(answer.substr(answer.find(':', socket_address) + 1));
    };
    const std::size_t scans = at("scans"), en_route = at("en_route");
    if (scans == std::string::npos)
      throw std::runtime_error("the answer does not contain the number of scans");
    scans_ = number(scans);
    en_route_ = en_route == std::string::npos ? 0 : number(en_route);
  }

  std::string ask(const std::string& header, const std::string& payload = {}) {
    const std::string body = header + payload;
    std::array<std::uint32_t, 3> lengths{static_cast<std::uint32_t>(header.size()),
                                         static_cast<std::uint32_t>(payload.size()), crc(body)};
    std::string frame(reinterpret_cast<const char*>(lengths.data()), sizeof lengths);
    frame += body;
    for (std::size_t sent = 0; sent < frame.size();) {
      const ssize_t count = ::send(socket_, frame.data() + sent, frame.size() - sent, MSG_NOSIGNAL);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) throw std::runtime_error("connection closed by the server");
      sent += static_cast<std::size_t>(count);
    }
    std::memcpy(lengths.data(), receive(sizeof lengths).data(), sizeof lengths);
    std::string answer = receive(std::size_t{lengths[0]} + lengths[1]);
    if (crc(answer) != lengths[2]) throw std::runtime_error("the answer is damaged");
    answer.resize(lengths[0]);
    if (answer.find("\"type\":\"error\"") != std::string::npos) throw Rejected(answer);
    return answer;
  }

  std::string receive(std::size_t size) {
    std::string data(size, '\0');
    for (std::size_t got = 0; got < size;) {
      const ssize_t count = ::recv(socket_, &data[got], size - got, 0);
      if (count <= 0) throw std::runtime_error("connection closed by the server");
      got += static_cast<std::size_t>(count);
    }
    return data;
  }

  static std::uint32_t crc(const std::string& bytes) {
    return static_cast<std::uint32_t>(
        ::crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
  }

  int socket_ = -1;
  std::size_t scans_ = 0, en_route_ = 0;
};

}  // namespace skycap_live
