#include "missions/dataset/reader_process.h"

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <exception>
#include <fstream>
#include <span>
#include <type_traits>
#include <utility>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "geometry/error.h"

namespace skycap::missions::dataset {
namespace {

enum class Tag : std::uint8_t { image, points, pose, end, error };

constexpr std::size_t most_memory = std::size_t{2} << 30;  // of the child, on top of the parent's

/// The child's end of the pipe. Numbers are as this machine has them.
class PipeWriter {
 public:
  explicit PipeWriter(int file) : file_(file) {}

  template <typename Value>
  void put(const Value& value) {
    static_assert(std::is_trivially_copyable_v<Value>);
    put_bytes(&value, sizeof value);
  }
  template <typename Value>
  void put_row(const Value* values, std::size_t count) {
    put(count);
    put_bytes(values, count * sizeof(Value));
  }
  void put_text(const std::string& text) { put_row(text.data(), text.size()); }
  void put_pose(const Eigen::Isometry3d& pose) {
    put_bytes(pose.matrix().data(), 16 * sizeof(double));
  }

 private:
  void put_bytes(const void* data, std::size_t size) {
    const char* at = static_cast<const char*>(data);
    while (size > 0) {
      const ssize_t count = ::write(file_, at, size);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) ::_exit(1);  // nobody listens any more
      at += count;
      size -= static_cast<std::size_t>(count);
    }
  }

  int file_;
};

void put_image(PipeWriter& pipe, const RangeImage& range) {
  pipe.put(range.image.width);
  pipe.put(range.image.height);
  pipe.put_row(range.image.values.data(), range.image.values.size());
  pipe.put(range.unit);
  pipe.put(range.is_depth);
  for (const double value : {range.focal_length_px.x(), range.focal_length_px.y(),
                             range.principal_point_px.x(), range.principal_point_px.y()}) {
    pipe.put(value);
  }
  pipe.put(range.distortion);
}

void put_scan(PipeWriter& pipe, const RawlogScan& scan) {
  const auto* range = std::get_if<RangeImage>(&scan.content);
  pipe.put(range != nullptr ? Tag::image : Tag::points);
  pipe.put(scan.number);
  pipe.put_text(scan.label);
  pipe.put(scan.time);
  pipe.put_pose(scan.carrier_from_sensor);
  pipe.put(scan.moved.has_value());
  if (scan.moved) pipe.put_pose(*scan.moved);
  pipe.put_text(scan.fault);
  if (range != nullptr) {
    put_image(pipe, *range);
  } else {
    const auto& points = std::get<std::vector<Eigen::Vector3f>>(scan.content);
    pipe.put_row(points.empty() ? nullptr : points.data()->data(), 3 * points.size());
  }
}

void bound_memory() {
  std::size_t pages = 0;
  rlimit limit{};
  if (!(std::ifstream("/proc/self/statm") >> pages) || getrlimit(RLIMIT_AS, &limit) != 0) return;
  const rlim_t most = pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) + most_memory;
  if (limit.rlim_cur != RLIM_INFINITY && limit.rlim_cur <= most) return;
  limit.rlim_cur = most;
  setrlimit(RLIMIT_AS, &limit);
}

/// All that the child does.
void read_all(PipeWriter& pipe, const std::function<std::unique_ptr<RawlogReader>()>& make) {
  try {
    const auto reader = make();
    while (const auto entry = reader->next()) {
      if (const auto* scan = std::get_if<RawlogScan>(&*entry)) {
        put_scan(pipe, *scan);
      } else {
        const auto& pose = std::get<RawlogPose>(*entry);
        pipe.put(Tag::pose);
        pipe.put(pose.source);
        pipe.put(pose.time);
        pipe.put_pose(pose.world_from_carrier);
      }
    }
    pipe.put(Tag::end);
  } catch (const std::exception& failure) {
    pipe.put(Tag::error);
    pipe.put_text(failure.what());
  }
}

[[noreturn]] void be_child(int file, const std::function<std::unique_ptr<RawlogReader>()>& make) {
  // MRPT writes remarks of its own there.
  if (const int nothing = ::open("/dev/null", O_WRONLY | O_CLOEXEC); nothing >= 0) {
    ::dup2(nothing, STDOUT_FILENO);
    ::dup2(nothing, STDERR_FILENO);
  }
  bound_memory();
  PipeWriter pipe(file);
  read_all(pipe, make);
  ::_exit(0);
}

class ProcessReader final : public RawlogReader {
 public:
  ProcessReader(std::string name, const std::function<std::unique_ptr<RawlogReader>()>& make)
      : name_(std::move(name)) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) fail("no pipe can be had");
    child_ = ::fork();
    if (child_ == 0) {
      ::close(ends[0]);
      be_child(ends[1], make);
    }
    ::close(ends[1]);
    file_ = ends[0];
    if (child_ < 0) {
      ::close(file_);
      fail("no process can be had");
    }
  }
  ProcessReader(const ProcessReader&) = delete;
  ProcessReader& operator=(const ProcessReader&) = delete;
  ~ProcessReader() override {
    ::close(file_);
    while (::waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }

  std::optional<std::variant<RawlogScan, RawlogPose>> next() override {
    if (is_at_end_) return std::nullopt;
    const auto tag = take<Tag>();
    if (tag == Tag::image || tag == Tag::points) return scan(tag);
    if (tag == Tag::pose) {
      RawlogPose pose;
      pose.source = take<PoseSource>();
      pose.time = take<double>();
      pose.world_from_carrier = take_pose();
      return pose;
    }
    if (tag == Tag::error) throw Error(ErrorKind::bad_file, take_text());
    is_at_end_ = true;
    return std::nullopt;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::bad_file, name_ + ": " + what);
  }

  void take_bytes(void* data, std::size_t size) {
    char* at = static_cast<char*>(data);
    while (size > 0) {
      const ssize_t count = ::read(file_, at, size);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) fail("is damaged: MRPT's library ends within it");
      at += count;
      size -= static_cast<std::size_t>(count);
    }
  }
  template <typename Value>
  Value take() {
    Value value;
    take_bytes(&value, sizeof value);
    return value;
  }
  template <typename Values>
  Values take_row() {
    const auto count = take<std::size_t>();
    if (count > most_memory / sizeof(typename Values::value_type)) fail("is damaged");
    Values values(count, typename Values::value_type{});
    take_bytes(values.data(), count * sizeof(typename Values::value_type));
    return values;
  }
  std::string take_text() { return take_row<std::string>(); }
  Eigen::Isometry3d take_pose() {
    Eigen::Isometry3d pose;
    take_bytes(pose.matrix().data(), 16 * sizeof(double));
    return pose;
  }

  RangeImage image() {
    RangeImage range;
    range.image.width = take<int>();
    range.image.height = take<int>();
    range.image.values = take_row<std::vector<std::uint16_t>>();
    range.unit = take<double>();
    range.is_depth = take<bool>();
    for (double* value : {&range.focal_length_px.x(), &range.focal_length_px.y(),
                          &range.principal_point_px.x(), &range.principal_point_px.y()}) {
      *value = take<double>();
    }
    range.distortion = take<std::array<double, 5>>();
    return range;
  }

  RawlogScan scan(Tag tag) {
    RawlogScan scan;
    scan.number = take<std::size_t>();
    scan.label = take_text();
    scan.time = take<double>();
    scan.carrier_from_sensor = take_pose();
    if (take<bool>()) scan.moved = take_pose();
    scan.fault = take_text();
    if (tag == Tag::image) {
      scan.content = image();
      return scan;
    }
    const auto numbers = take_row<std::vector<float>>();
    std::vector<Eigen::Vector3f> points(numbers.size() / 3);
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i] = Eigen::Vector3f::Map(&numbers[3 * i]);
    }
    scan.content = std::move(points);
    return scan;
  }

  std::string name_;
  int file_ = -1;
  pid_t child_ = -1;
  bool is_at_end_ = false;
};

}  // namespace

std::unique_ptr<RawlogReader> read_apart(
    const std::string& name, const std::function<std::unique_ptr<RawlogReader>()>& make) {
  return std::make_unique<ProcessReader>(name, make);
}

}  // namespace skycap::missions::dataset
