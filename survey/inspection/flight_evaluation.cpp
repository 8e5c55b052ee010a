#include "survey/inspection/flight_evaluation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/error.h"
#include "geometry/parallel.h"

namespace skycap::survey::inspection {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// Samples that one parallel task evaluates.
constexpr std::size_t samples_per_task = 16;

/// Counts of a task, for all points.
struct TaskSights {
  std::vector<std::uint8_t> rules;
  std::vector<std::uint16_t> views;
  std::vector<float> distances;
};

/// Applies the rules of visibility to single samples.
class SampleSights {
 public:
  SampleSights(const StructureCloud& cloud, const EvaluationOptions& options)
      : cloud_(cloud),
        options_(options),
        cube_(options.cube_resolution),
        tan_half_width_(std::tan(0.5 * options.camera.horizontal_fov)),
        tan_half_height_(std::tan(0.5 * options.camera.vertical_fov)),
        min_cosine_(std::cos(options.camera.max_incidence)),
        pixels_(static_cast<std::size_t>(options.camera.width) *
                static_cast<std::size_t>(options.camera.height)) {}

  void add(const FlightSample& sample, bool counts_views, TaskSights& sights) {
    find_in_image(sample);
    if (in_image_.empty()) return;
    mark_nearest_in_pixels(sights);
    cube_.draw(cloud_, in_reach_, sample.position.cast<float>());
    for (const Sight& sight : in_image_) {
      if (!cube_.is_visible(cloud_, sight.point, options_.tolerance)) continue;
      sights.rules[sight.point] |= 2U;
      const double cosine = std::abs(cloud_.normals[sight.point].cast<double>().dot(sight.line));
      if (cosine < min_cosine_ * sight.distance) continue;
      sights.rules[sight.point] |= 4U;
      float& nearest = sights.distances[sight.point];
      nearest = std::min(nearest, static_cast<float>(sight.distance));
      if (counts_views) ++sights.views[sight.point];
    }
  }

 private:
  struct Sight {
    std::uint32_t point;
    Vector3d line;
    double distance;
    std::size_t pixel;
  };

  void find_in_image(const FlightSample& sample) {
    const CameraAxes axes(sample.yaw, sample.pitch);
    const double range = options_.camera.range;
    in_image_.clear();
    in_reach_.clear();
    for (std::uint32_t i = 0; i < cloud_.size(); ++i) {
      const Vector3d line = cloud_.points[i].cast<double>() - sample.position;
      const double distance = line.norm();
      if (distance > range) continue;
      in_reach_.push_back(i);
      const double depth = axes.forward.dot(line);
      const double left = axes.left.dot(line), up = axes.up.dot(line);
      if (depth <= 0.0 || std::abs(left) > depth * tan_half_width_ ||
          std::abs(up) > depth * tan_half_height_) {
        continue;
      }
      in_image_.push_back({i, line, distance, pixel_of(left / depth, up / depth)});
    }
  }

  std::size_t pixel_of(double left, double up) const {
    const auto index = [](double tangent, double half, int count) {
      const double scaled = (tangent + half) / (2.0 * half) * count;
      return static_cast<std::size_t>(std::clamp(static_cast<int>(scaled), 0, count - 1));
    };
    return index(up, tan_half_height_, options_.camera.height) *
               static_cast<std::size_t>(options_.camera.width) +
           index(left, tan_half_width_, options_.camera.width);
  }

  void mark_nearest_in_pixels(TaskSights& sights) {
    constexpr auto empty = std::numeric_limits<std::uint32_t>::max();
    for (const Sight& sight : in_image_) pixels_[sight.pixel] = empty;
    for (std::uint32_t i = 0; i < in_image_.size(); ++i) {
      std::uint32_t& nearest = pixels_[in_image_[i].pixel];
      if (nearest == empty || in_image_[i].distance < in_image_[nearest].distance) nearest = i;
    }
    for (const Sight& sight : in_image_) {
      sights.rules[in_image_[pixels_[sight.pixel]].point] |= 1U;
    }
  }

  const StructureCloud& cloud_;
  const EvaluationOptions& options_;
  DepthCube cube_;
  double tan_half_width_, tan_half_height_, min_cosine_;
  std::vector<std::uint32_t> pixels_;
  std::vector<Sight> in_image_;
  std::vector<std::uint32_t> in_reach_;
};

double median_of(std::vector<double> values, double quantile) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(quantile * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + at);
  return values[static_cast<std::size_t>(at)];
}

void evaluate_sights(std::span<const FlightSample> flight, const StructureCloud& cloud,
                     const EvaluationOptions& options, double dt, FlightEvaluation& result) {
  const std::size_t stride =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(options.view_interval / dt)));
  const unsigned threads = geometry::thread_count(options.threads);
  std::vector<TaskSights> tasks(threads);
  const std::size_t blocks = (flight.size() + samples_per_task - 1) / samples_per_task;
  // All results are minima, sums and unions, so that the division among threads has no effect.
  geometry::parallel_for(threads, threads, [&](std::size_t task) {
    TaskSights& sights = tasks[task];
    sights.rules.assign(cloud.size(), 0);
    sights.views.assign(cloud.size(), 0);
    sights.distances.assign(cloud.size(), std::numeric_limits<float>::infinity());
    SampleSights samples(cloud, options);
    for (std::size_t block = task; block < blocks; block += threads) {
      const std::size_t end = std::min(flight.size(), (block + 1) * samples_per_task);
      for (std::size_t i = block * samples_per_task; i < end; ++i) {
        samples.add(flight[i], i % stride == 0, sights);
      }
    }
  });
  result.rules_seen.assign(cloud.size(), 0);
  std::vector<double> views, distances;
  double sum = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    double count = 0.0;
    float distance = std::numeric_limits<float>::infinity();
    for (const TaskSights& task : tasks) {
      result.rules_seen[i] |= task.rules[i];
      count += task.views[i];
      distance = std::min(distance, task.distances[i]);
    }
    for (std::size_t rule = 0; rule < sight_rules; ++rule) {
      if ((result.rules_seen[i] >> rule & 1U) != 0) ++result.seen[rule];
    }
    sum += count;
    views.push_back(count);
    if (std::isfinite(distance)) distances.push_back(distance);
  }
  constexpr double half = 0.5, tenth = 0.1;
  result.views = {sum / static_cast<double>(cloud.size()), median_of(views, half),
                  median_of(views, tenth)};
  result.median_view_distance = median_of(std::move(distances), half);
}

/// Largest value and share above the limit of a series of vectors or numbers.
template <typename Series>
LimitUse limit_use(const Series& series, double limit, double rounding) {
  LimitUse use{.limit = limit};
  std::size_t above = 0;
  for (const auto& value : series) {
    const double norm = value.norm();
    use.max = std::max(use.max, norm);
    use.max_axis = std::max(use.max_axis, value.cwiseAbs().maxCoeff());
    if (norm > limit * (1.0 + rounding)) ++above;
  }
  if (!series.empty()) {
    use.share_above = static_cast<double>(above) / static_cast<double>(series.size());
  }
  return use;
}

template <typename Vector>
std::vector<Vector> differences(const std::vector<Vector>& series, double dt) {
  std::vector<Vector> result;
  for (std::size_t i = 1; i < series.size(); ++i) {
    result.push_back((series[i] - series[i - 1]) / dt);
  }
  return result;
}

void evaluate_motion(std::span<const FlightSample> flight, const EvaluationOptions& options,
                     double dt, FlightEvaluation& result) {
  using Number = Eigen::Matrix<double, 1, 1>;
  std::vector<Vector3d> positions;
  std::vector<Number> yaws, pitches;
  result.min_height = std::numeric_limits<double>::infinity();
  result.min_pitch = std::numeric_limits<double>::infinity();
  result.max_pitch = -std::numeric_limits<double>::infinity();
  double yaw = flight.front().yaw;
  for (const FlightSample& sample : flight) {
    yaw += std::remainder(sample.yaw - yaw, 2.0 * std::numbers::pi);
    positions.push_back(sample.position);
    yaws.push_back(Number(yaw));
    pitches.push_back(Number(sample.pitch));
    result.min_height = std::min(result.min_height, sample.position.z());
    result.min_pitch = std::min(result.min_pitch, sample.pitch);
    result.max_pitch = std::max(result.max_pitch, sample.pitch);
  }
  constexpr double first = 0.001, second = 0.01, third = 0.04, angle = 1e-6;
  const auto velocities = differences(positions, dt);
  for (const Vector3d& velocity : velocities) {
    result.length += velocity.norm() * dt;
    result.max_ascent = std::max(result.max_ascent, velocity.z());
    result.max_descent = std::max(result.max_descent, -velocity.z());
  }
  const auto accelerations = differences(velocities, dt);
  const MotionLimits& limits = options.limits;
  result.keeps_vertical_speed = result.max_ascent <= limits.ascent * (1.0 + first) &&
                                result.max_descent <= limits.descent * (1.0 + first);
  result.speed = limit_use(velocities, limits.speed, first);
  result.acceleration = limit_use(accelerations, limits.acceleration, second);
  result.jerk = limit_use(differences(accelerations, dt), limits.jerk, third);
  const auto yaw_rates = differences(yaws, dt);
  result.yaw_rate = limit_use(yaw_rates, limits.yaw_rate, first);
  result.yaw_acceleration = limit_use(differences(yaw_rates, dt), limits.yaw_acceleration, second);
  result.pitch_rate = limit_use(differences(pitches, dt), limits.pitch_rate, first);
  result.keeps_pitch = result.min_pitch >= options.min_pitch - angle &&
                       result.max_pitch <= options.max_pitch + angle;
}

double squared_distance(const Vector3d& point, const Vector3d& from, const Vector3d& to) {
  const Vector3d line = to - from;
  const double squared = line.squaredNorm();
  const double along =
      squared > 0.0 ? std::clamp((point - from).dot(line) / squared, 0.0, 1.0) : 0.0;
  return (point - from - along * line).squaredNorm();
}

}  // namespace

void InspectionCamera::validate() const {
  const auto require = [](bool is_valid, const char* what) {
    if (!is_valid) throw Error(ErrorKind::bad_config, what);
  };
  require(horizontal_fov > 0.0 && horizontal_fov < std::numbers::pi,
          "horizontal_fov must be between 0 and 180 degrees");
  require(vertical_fov > 0.0 && vertical_fov < std::numbers::pi,
          "vertical_fov must be between 0 and 180 degrees");
  require(range > 0.0 && std::isfinite(range), "range must be positive");
  require(max_incidence > 0.0 && max_incidence < 0.5 * std::numbers::pi,
          "max_incidence must be between 0 and 90 degrees");
  require(width > 0 && height > 0, "width and height must be positive");
}

bool FlightEvaluation::keeps_limits() const {
  return keeps_pitch && keeps_vertical_speed && speed.is_kept() && acceleration.is_kept() &&
         jerk.is_kept() && yaw_rate.is_kept() && yaw_acceleration.is_kept() && pitch_rate.is_kept();
}

NearestDistance nearest_distance(std::span<const FlightSample> flight,
                                 const StructureCloud& cloud) {
  constexpr std::size_t chunk = 20;  // segments, about 4 m of flight
  NearestDistance nearest{std::numeric_limits<double>::infinity(),
                          std::numeric_limits<double>::infinity(), 0.0};
  const float max_radius =
      cloud.radii.empty() ? 0.0F : *std::max_element(cloud.radii.begin(), cloud.radii.end());
  std::vector<std::uint32_t> near;
  for (std::size_t begin = 0; begin + 1 < flight.size(); begin += chunk) {
    const std::size_t end = std::min(begin + chunk, flight.size() - 1);
    const Vector3d centre = 0.5 * (flight[begin].position + flight[end].position);
    double radius = 0.0;
    for (std::size_t i = begin; i <= end; ++i) {
      radius = std::max(radius, (flight[i].position - centre).norm());
    }
    // A point nearer than the best one is within this distance of the centre. A disc is at most its
    // radius nearer than its point.
    const double limit = nearest.points + radius + max_radius;
    near.clear();
    for (std::uint32_t i = 0; i < cloud.size(); ++i) {
      if ((cloud.points[i].cast<double>() - centre).squaredNorm() <= limit * limit) {
        near.push_back(i);
      }
    }
    for (std::size_t i = begin; i < end; ++i) {
      for (const std::uint32_t point : near) {
        const double squared = squared_distance(cloud.points[point].cast<double>(),
                                                flight[i].position, flight[i + 1].position);
        if (squared < nearest.points * nearest.points) {
          nearest.points = std::sqrt(squared);
          nearest.time = flight[i].time;
        }
        // The flight is perpendicular above a surface at its nearest point, so that a point of the
        // cloud within one disc radius of it is at most this much farther away.
        const double disc = cloud.radii[point];
        nearest.surface =
            std::min(nearest.surface, std::sqrt(std::max(0.0, squared - disc * disc)));
      }
    }
  }
  return nearest;
}

FlightEvaluation evaluate_flight(std::span<const FlightSample> flight, const StructureCloud& cloud,
                                 const EvaluationOptions& options) {
  options.camera.validate();
  options.limits.validate();
  constexpr std::size_t min_samples = 4;
  if (flight.size() < min_samples) {
    throw Error(ErrorKind::bad_geometry, "the flight has " + std::to_string(flight.size()) +
                                             " samples, and at least 4 are required for the jerk");
  }
  FlightEvaluation result;
  result.points = cloud.size();
  result.duration = flight.back().time - flight.front().time;
  const double dt = result.duration / static_cast<double>(flight.size() - 1);
  for (std::size_t i = 0; i < flight.size(); ++i) {
    const double even = flight.front().time + dt * static_cast<double>(i);
    result.max_dt_error = std::max(result.max_dt_error, std::abs(flight[i].time - even));
  }
  constexpr double max_error = 1e-3;
  if (!(dt > 0.0) || result.max_dt_error > max_error) {
    throw Error(ErrorKind::bad_geometry,
                "the samples of the flight must be equally spaced in time to 0.001 s; resample it");
  }
  evaluate_motion(flight, options, dt, result);
  evaluate_sights(flight, cloud, options, dt, result);
  const NearestDistance nearest = nearest_distance(flight, cloud);
  result.nearest = nearest.points;
  result.nearest_surface = nearest.surface;
  result.nearest_time = nearest.time;
  return result;
}

}  // namespace skycap::survey::inspection
