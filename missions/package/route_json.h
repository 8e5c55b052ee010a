/// Conversion of a verified route to JSON for summary.json.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "flight/route/route.h"

namespace skycap::missions::package {

/// Returns the route's sorties, each with its legs from above the pad and back, in metres, seconds
/// and watt hours. Legs connect views; null is the pad.
nlohmann::ordered_json sorties_json(const flight::Route& route);

/// Returns the unreachable views with the reasons.
nlohmann::ordered_json unreached_json(const std::vector<flight::Unreached>& unreached);

/// Returns the views in flight order.
nlohmann::ordered_json order_json(const flight::Route& route);

}  // namespace skycap::missions::package
