/// What may go wrong with a flight: a normal answer of each of its steps.
#pragma once

#include <optional>
#include <string>
#include <utility>

namespace skycap::missions::online {

/// Why a flight does not go on.
enum class TroubleKind {
  refused,      ///< the autopilot does not do what it is asked to, or not as it should
  pilot,        ///< somebody else has taken control
  link,         ///< nothing is heard of the vehicle
  position,     ///< it does not know where it is
  off_leg,      ///< it is not where it is flown to
  battery,      ///< it is time to go home
  planner,      ///< the next leg does not come
  sensor,       ///< the scan does not come
  pose,         ///< the scan does not fit what is known: nobody knows where the vehicle is
  stalled,      ///< this program stood still, and the vehicle flew on
  interrupted,  ///< the user asked to stop
};

struct Trouble {
  TroubleKind kind;
  std::string what;  ///< for the user
};

inline Trouble refused(std::string what) { return {TroubleKind::refused, std::move(what)}; }

using MaybeTrouble = std::optional<Trouble>;

}  // namespace skycap::missions::online
