#include <cmath>

#include <skycap/survey/survey_estimate.h>

#include "example.h"

// A wall of 3 m^2, half of it missing, and 1 m^2 of unobserved surface behind it.
const Example survey_estimate_example("survey/survey_estimate", [] {
  using skycap::survey::surfel::MissingReason;
  skycap::survey::surfel::SurveyEstimate estimate;
  estimate.patches = {
      {{0, 0, 0}, {1, 0, 0}, 3.0F, 0.5F, MissingReason::seen_too_thinly},
      {{0, 5, 0}, {1, 0, 0}, 1.0F, 0.0F, MissingReason::never_seen},
  };
  add_up(estimate);
  return estimate.area == 4.0 && std::abs(estimate.seen_too_thinly - 0.375) < 1e-12 &&
         estimate.never_seen == 0.25;
});
