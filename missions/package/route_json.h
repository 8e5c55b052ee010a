/// A certified route as summary.json has it.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "flight/route/route.h"

namespace skycap::missions::package {

/// The route's sorties, each with its legs from above the pad and back there, in metres, seconds
/// and watt hours. Legs lead from view to view; null stands for the pad.
nlohmann::ordered_json sorties_json(const flight::Route& route);

/// Views that are left out, with the reasons.
nlohmann::ordered_json unreached_json(const std::vector<flight::Unreached>& unreached);

/// The views in the order in which they are flown to.
nlohmann::ordered_json order_json(const flight::Route& route);

}  // namespace skycap::missions::package
