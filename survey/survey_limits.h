/// When a survey ends: the rules that a user sets, and the reasons. A new rule is a field here, a
/// line in broken_limit(), and a key of the mission file.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace skycap::survey {

/// Why a survey ended.
enum class StopReason {
  complete,  ///< the planner has nowhere left to look
  view_limit,
  distance_limit,
  time_limit,
  nowhere_to_go,  ///< every view the planner still wanted was refused
  interrupted,    ///< the user asked to stop
};

/// "complete", "view_limit" and so on, as the enumerators are called.
const char* name_of(StopReason reason);

/// The reason of that name; nothing if none has it.
std::optional<StopReason> stop_reason_named(std::string_view name);

struct SurveyLimits {
  std::size_t max_views = 1000;
  std::optional<double> max_distance;  ///< straight lines between views [m]
  std::optional<double> max_time;      ///< of the flight [s], by the two below
  double speed = 5.0;                  ///< between views [m/s]
  double time_per_view = 5.0;          ///< to stop, turn and measure [s]
};

/// How far a survey has come.
struct SurveyExtent {
  std::size_t views = 0;  ///< taken
  double distance = 0.0;  ///< straight lines between them, and to the view that is next [m]
};

/// The limit that one more view would break; nothing if none.
std::optional<StopReason> broken_limit(const SurveyLimits& limits, const SurveyExtent& progress);

}  // namespace skycap::survey
