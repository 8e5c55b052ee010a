/// A mission's site as it truly is: the scene's mesh and the rules.
#pragma once

#include "flight/space/clearance.h"
#include "geometry/surfaces/mesh.h"
#include "missions/file/mission.h"

namespace skycap::missions::verbs {

struct TrueSpace {
  flight::KnownSpace everywhere;
  flight::KnownSpace over_pad;  ///< without the ground that a pad at that height stands on
};

TrueSpace true_space(const file::Mission& mission, const geometry::Mesh& model, double pad_height);

}  // namespace skycap::missions::verbs
