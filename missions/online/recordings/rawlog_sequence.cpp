#include "missions/online/recordings/rawlog_sequence.h"

#include <algorithm>
#include <utility>

#include "geometry/error.h"
#include "geometry/pose/world.h"

namespace skycap::missions::online {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

/// Limits on the contents of a rawlog, which its compressed size does not bound.
constexpr std::size_t max_poses = 3'000'000, max_sensors = 64, longest_label = 256;

/// Formats labels for messages.
std::string quoted(const std::vector<std::string>& labels) {
  std::string text;
  for (const std::string& label : labels) text += (text.empty() ? "'" : ", '") + label + "'";
  return text;
}

std::vector<Vector3d> unproject_points(const RecordedImage& range, std::size_t& without_return) {
  const CameraIntrinsics intrinsics{.focal_length_px = range.focal_length_px,
                                    .principal_point_px = range.principal_point_px,
                                    .distortion = range.distortion};
  std::vector<Vector3d> points =
      unproject_points(range.image, intrinsics, range.unit, without_return);
  if (range.is_depth) return points;
  // The image contains ranges, so the depth of each point is converted from its range.
  for (Vector3d& point : points) point *= point.z() / point.norm();
  return points;
}

}  // namespace

RawlogSequence::RawlogSequence(std::filesystem::path file, const RawlogChoice& choice,
                               std::function<void(const std::string&)> note,
                               const std::function<void(const std::string&)>& report)
    : file_(std::move(file)), choice_(choice), note_(std::move(note)) {
  if (choice_.poses) {
    StampedList list = read_list(*choice_.poses);
    if (note_) std::ranges::for_each(list.notes, note_);
    trajectory_ = std::move(list.lines);
  }
  survey_file(report);
  reader_ = open_rawlog(file_);
}

void RawlogSequence::survey_file(const std::function<void(const std::string&)>& report) {
  std::vector<std::string> labels;
  std::size_t scans = 0;
  bool has_movements = false;
  const auto reader = open_rawlog(file_);
  while (const auto entry = reader->next()) {
    if (const auto* pose = std::get_if<RawlogPose>(&*entry)) {
      if (poses_.size() == max_poses) fail("has more than 3 million poses; use --poses");
      if (!choice_.poses) poses_.push_back(*pose);
      continue;
    }
    const auto& scan = std::get<RawlogScan>(*entry);
    if (report) report(file_.string() + ": reading poses, scan " + std::to_string(++scans));
    has_movements = has_movements || scan.moved;
    if (std::ranges::find(labels, scan.label) != labels.end()) continue;
    if (labels.size() == max_sensors) fail("has scans of more than 64 sensors");
    if (scan.label.size() > longest_label) fail("has a sensor label of more than 256 bytes");
    labels.push_back(scan.label);
  }
  choose_sensor(labels);
  choose_poses(has_movements);
}

void RawlogSequence::fail(const std::string& what) const {
  throw Error(ErrorKind::bad_file, file_.string() + ": " + what);
}

void RawlogSequence::choose_sensor(const std::vector<std::string>& labels) {
  if (labels.empty()) {
    fail(
        "contains no usable scan (CObservation3DRangeScan, CObservationPointCloud or "
        "CObservationVelodyneScan)");
  }
  const bool is_chosen = !choice_.sensor.empty();
  if (!is_chosen && labels.size() > 1) {
    throw Error(ErrorKind::bad_usage, file_.string() + ": contains scans of several sensors: " +
                                          quoted(labels) + "; choose one with --sensor");
  }
  if (is_chosen && std::ranges::find(labels, choice_.sensor) == labels.end()) {
    throw Error(ErrorKind::bad_usage, file_.string() + ": contains no scan of sensor '" +
                                          choice_.sensor + "'; its sensors are " + quoted(labels));
  }
  if (!is_chosen) choice_.sensor = labels.front();
}

void RawlogSequence::choose_poses(bool has_movements) {
  const auto keep = [&](PoseSource source) {
    std::vector<RawlogPose> kept;
    std::ranges::copy_if(poses_, std::back_inserter(kept),
                         [&](const RawlogPose& pose) { return pose.source == source; });
    std::ranges::stable_sort(kept, {}, &RawlogPose::time);
    return kept;
  };
  const auto estimates = keep(PoseSource::estimate), odometry = keep(PoseSource::odometry);
  poses_.clear();
  if (choice_.poses) {
    pose_source_ = choice_.poses->string();
  } else if (!estimates.empty()) {
    pose_source_ = "its CObservationRobotPose";
    poses_ = estimates;
  } else if (has_movements) {
    pose_source_ = "the accumulated movements of its actions (with drift)";
  } else if (!odometry.empty()) {
    pose_source_ = "its CObservationOdometry (planar wheel odometry, with drift)";
    poses_ = odometry;
  } else {
    fail(
        "contains no poses of its scans (CObservationRobotPose, movements or "
        "CObservationOdometry); use --poses with a TUM trajectory of the sensor's optical frame");
  }
}

Isometry3d RawlogSequence::compute_pose(const RawlogScan& scan) const {
  if (choice_.poses) return pose_at(trajectory_, scan.time, pose_source_);
  const Isometry3d world_from_platform =
      poses_.empty() ? scan.moved.value_or(Isometry3d::Identity())
                     : nearest_pose(std::span<const RawlogPose>(poses_), scan.time, file_.string())
                           .world_from_platform;
  const Isometry3d world_from_sensor = world_from_platform * scan.platform_from_sensor;
  geometry::require_valid_position(world_from_sensor.translation(), "its pose");
  const Eigen::Matrix3d turn = world_from_sensor.linear();
  if (!(turn * turn.transpose()).isIdentity(1e-6)) {
    throw Error(ErrorKind::bad_file, "its pose is not a rigid transformation");
  }
  return world_from_sensor;
}

std::optional<RawlogFrame> RawlogSequence::next() {
  while (auto entry = reader_->next()) {
    auto* scan = std::get_if<RawlogScan>(&*entry);
    if (scan == nullptr || scan->label != choice_.sensor) continue;
    RawlogFrame frame{.id = scan->label + " " + std::to_string(scan->number)};
    try {
      if (!scan->fault.empty()) throw Error(ErrorKind::bad_file, scan->fault);
      frame.world_from_sensor = compute_pose(*scan);
    } catch (const Error& failure) {
      note_(frame.id + " is skipped: " + failure.what());
      continue;
    }
    frame.scan = std::move(*scan);
    return frame;
  }
  return std::nullopt;
}

ScanFound make_scan(const RawlogFrame& frame, const flight::CaptureOptions& capture,
                    const LiveOptions& live) {
  std::size_t without_return = 0;
  std::vector<Vector3d> points;
  if (const auto* range = std::get_if<RecordedImage>(&frame.scan.content)) {
    points = unproject_points(*range, without_return);
  } else {
    for (const Eigen::Vector3f& point :
         std::get<std::vector<Eigen::Vector3f>>(frame.scan.content)) {
      points.push_back(point.cast<double>());
    }
  }
  ScanFound found = make_scan(points, frame.world_from_sensor, capture, live);
  found.without_return = without_return;
  return found;
}

}  // namespace skycap::missions::online
