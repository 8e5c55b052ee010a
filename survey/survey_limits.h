/// Limits of a survey and reasons for its end. A new limit needs a field here, a line in
/// broken_limit(), and a key of the mission file.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace skycap::survey {

/// Reason for the end of a survey.
enum class StopReason {
  complete,  ///< no views left to propose
  view_limit,
  distance_limit,
  time_limit,
  nowhere_to_go,  ///< all remaining proposals were unreachable
  interrupted,    ///< stopped by the user
};

/// Returns the name of the enumerator, such as "complete" or "view_limit".
const char* to_string(StopReason reason);

/// Returns the reason with this name, or nullopt.
std::optional<StopReason> stop_reason_named(std::string_view name);

struct SurveyLimits {
  std::size_t max_views = 1000;
  std::optional<double> max_distance;  ///< sum of the straight lines between views [m]
  std::optional<double> max_time;      ///< flight time [s], from `speed` and `time_per_view`
  double speed = 5.0;                  ///< between views [m/s]
  double time_per_view = 5.0;          ///< stop, rotation and measurement [s]
};

/// Progress of a survey.
struct SurveyExtent {
  std::size_t views = 0;  ///< number of views taken
  double distance = 0.0;  ///< sum of the straight lines between views, including the next view [m]
};

/// Returns the limit that one more view would exceed, or nullopt.
std::optional<StopReason> broken_limit(const SurveyLimits& limits, const SurveyExtent& progress);

}  // namespace skycap::survey
