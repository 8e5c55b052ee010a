#include "missions/online/recordings/reader_process.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>
#include <utility>

#include "geometry/error.h"
#include "missions/support/child_process.h"

namespace skycap::missions::online {
namespace {

enum class Tag : std::uint8_t { image, points, pose, end, error };

using support::PipeWriter;

/// Pose matrix in column-major order.
using PoseNumbers = std::array<double, 16>;

void put_pose(PipeWriter& pipe, const Eigen::Isometry3d& pose) {
  PoseNumbers numbers;
  std::copy_n(pose.matrix().data(), numbers.size(), numbers.begin());
  pipe.put(numbers);
}

void put_image(PipeWriter& pipe, const RecordedImage& range) {
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
  const auto* range = std::get_if<RecordedImage>(&scan.content);
  pipe.put(range != nullptr ? Tag::image : Tag::points);
  pipe.put(scan.number);
  pipe.put_text(scan.label);
  pipe.put(scan.time);
  put_pose(pipe, scan.platform_from_sensor);
  pipe.put(scan.moved.has_value());
  if (scan.moved) put_pose(pipe, *scan.moved);
  pipe.put_text(scan.fault);
  if (range != nullptr) {
    put_image(pipe, *range);
  } else {
    const auto& points = std::get<std::vector<Eigen::Vector3f>>(scan.content);
    pipe.put_row(points.empty() ? nullptr : points.data()->data(), 3 * points.size());
  }
}

/// Main function of the child process.
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
        put_pose(pipe, pose.world_from_platform);
      }
    }
    pipe.put(Tag::end);
  } catch (const std::exception& failure) {
    pipe.put(Tag::error);
    pipe.put_text(failure.what());
  }
}

class ProcessReader final : public RawlogReader {
 public:
  ProcessReader(const std::string& name, const std::function<std::unique_ptr<RawlogReader>()>& make)
      : child_({name, "MRPT's library"}, [&](PipeWriter& pipe) { read_all(pipe, make); }) {}

  std::optional<std::variant<RawlogScan, RawlogPose>> next() override {
    if (is_at_end_) return std::nullopt;
    const auto tag = child_.read<Tag>();
    if (tag == Tag::image || tag == Tag::points) return scan(tag);
    if (tag == Tag::pose) {
      RawlogPose pose;
      pose.source = child_.read<PoseSource>();
      pose.time = child_.read<double>();
      pose.world_from_platform = read_pose();
      return pose;
    }
    if (tag == Tag::error) throw Error(ErrorKind::bad_file, child_.read_text());
    is_at_end_ = true;
    return std::nullopt;
  }

 private:
  Eigen::Isometry3d read_pose() {
    Eigen::Isometry3d pose;
    pose.matrix() = Eigen::Matrix4d::Map(child_.read<PoseNumbers>().data());
    return pose;
  }

  RecordedImage image() {
    RecordedImage range;
    range.image.width = child_.read<int>();
    range.image.height = child_.read<int>();
    range.image.values = child_.read_row<std::vector<std::uint16_t>>();
    range.unit = child_.read<double>();
    range.is_depth = child_.read<bool>();
    for (double* value : {&range.focal_length_px.x(), &range.focal_length_px.y(),
                          &range.principal_point_px.x(), &range.principal_point_px.y()}) {
      *value = child_.read<double>();
    }
    range.distortion = child_.read<std::array<double, 5>>();
    return range;
  }

  RawlogScan scan(Tag tag) {
    RawlogScan scan;
    scan.number = child_.read<std::size_t>();
    scan.label = child_.read_text();
    scan.time = child_.read<double>();
    scan.platform_from_sensor = read_pose();
    if (child_.read<bool>()) scan.moved = read_pose();
    scan.fault = child_.read_text();
    if (tag == Tag::image) {
      scan.content = image();
      return scan;
    }
    const auto numbers = child_.read_row<std::vector<float>>();
    std::vector<Eigen::Vector3f> points(numbers.size() / 3);
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i] = Eigen::Vector3f::Map(&numbers[3 * i]);
    }
    scan.content = std::move(points);
    return scan;
  }

  support::ChildProcess child_;
  bool is_at_end_ = false;
};

}  // namespace

std::unique_ptr<RawlogReader> read_apart(
    const std::string& name, const std::function<std::unique_ptr<RawlogReader>()>& make) {
  return std::make_unique<ProcessReader>(name, make);
}

}  // namespace skycap::missions::online
