#include "survey/survey_limits.h"

#include <algorithm>
#include <array>

namespace skycap::survey {
namespace {

struct NamedReason {
  StopReason reason;
  const char* name;
};

constexpr auto reasons = std::to_array<NamedReason>({
    {StopReason::complete, "complete"},
    {StopReason::view_limit, "view_limit"},
    {StopReason::distance_limit, "distance_limit"},
    {StopReason::time_limit, "time_limit"},
    {StopReason::nowhere_to_go, "no_reachable_view"},
    {StopReason::interrupted, "interrupted"},
});

}  // namespace

const char* to_string(StopReason reason) {
  return std::ranges::find(reasons, reason, &NamedReason::reason)->name;
}

std::optional<StopReason> stop_reason_named(std::string_view name) {
  if (name == "nowhere_to_go") return StopReason::nowhere_to_go;  // name in version 0.1
  const auto* const found =
      std::ranges::find_if(reasons, [&](const NamedReason& known) { return name == known.name; });
  return found == reasons.end() ? std::nullopt : std::optional(found->reason);
}

std::optional<StopReason> broken_limit(const SurveyLimits& limits, const SurveyExtent& progress) {
  if (progress.views >= limits.max_views) return StopReason::view_limit;
  if (limits.max_distance && progress.distance > *limits.max_distance) {
    return StopReason::distance_limit;
  }
  const double time = progress.distance / limits.speed +
                      static_cast<double>(progress.views + 1) * limits.time_per_view;
  if (limits.max_time && time > *limits.max_time) return StopReason::time_limit;
  return std::nullopt;
}

}  // namespace skycap::survey
