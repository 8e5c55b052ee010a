#include "survey/skycap/survey_belief.h"

namespace skycap::survey::skycap {

void add_up(SurveyBelief& belief) {
  for (const BelievedPatch& patch : belief.patches) belief.area += patch.area;
  for (const BelievedPatch& patch : belief.patches) {
    const double missing = patch.area * (1.0 - patch.covered_share) / belief.area;
    switch (patch.reason) {
      case MissingReason::none:  // the rest that even well covered surface lacks
      case MissingReason::seen_too_thinly:
        belief.seen_too_thinly += missing;
        break;
      case MissingReason::never_seen:
        belief.never_seen += missing;
        break;
      case MissingReason::unreachable:
        belief.unreachable += missing;
        break;
    }
  }
}

}  // namespace skycap::survey::skycap
