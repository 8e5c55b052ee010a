#include "missions/online/guided/gimbal_report.h"

#include <cmath>

#include "geometry/angle.h"

namespace skycap::missions::online {
namespace {

constexpr double degree = geometry::radians_per_degree;

constexpr double turning = 2.0;  ///< Time after which the camera is at rest [s].

/// Minimum vehicle motion for a decision, and the slope of the report over the vehicle's pitch that
/// decides. The slope is 0 relative to the horizon and -1 relative to the airframe.
constexpr double needed_squares = 20.0 * degree * degree;
constexpr double decisive_slope = -0.5;

/// In steady wind the vehicle's tilt is constant. The report then differs by this tilt for this
/// number of consecutive reports.
constexpr double min_tilt = 1.5 * degree, tolerance = 1.0 * degree;
constexpr std::size_t enough_steady = 10;

}  // namespace

void GimbalReport::begin_aim(double now, double asked) {
  begin_ = now;
  asked_ = asked;
  count_ = steady_ = 0;
}

void GimbalReport::hear(double now, double reported, double vehicle_pitch) {
  if (is_against_vehicle_ || now - begin_ < turning) return;
  weigh(reported, vehicle_pitch);
  const bool is_off = std::abs(reported - asked_) > tolerance + 0.5 * min_tilt;
  const bool is_right = std::abs(reported + vehicle_pitch - asked_) < tolerance;
  steady_ = is_off && is_right && std::abs(vehicle_pitch) > min_tilt ? steady_ + 1 : 0;
  is_against_vehicle_ = steady_ >= enough_steady || (vehicle_squares_ > needed_squares &&
                                                     products_ < decisive_slope * vehicle_squares_);
}

// Updates the sums about the mean of each aim with Welford's algorithm.
void GimbalReport::weigh(double reported, double vehicle_pitch) {
  if (count_++ == 0) mean_reported_ = mean_vehicle_ = 0.0;
  const double share = 1.0 / static_cast<double>(count_);
  const double off = vehicle_pitch - mean_vehicle_;
  mean_vehicle_ += share * off;
  mean_reported_ += share * (reported - mean_reported_);
  vehicle_squares_ += off * (vehicle_pitch - mean_vehicle_);
  products_ += off * (reported - mean_reported_);
}

}  // namespace skycap::missions::online
