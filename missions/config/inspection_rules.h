/// Effects of the section `inspection` on other keys of a mission: derived values and checks.
#pragma once

#include "missions/config/mission_document.h"
#include "survey/inspection/inspection_planner.h"

namespace skycap::missions::config {

/// Checks the keys of `inspection` against the others. Throws the error of
/// MissionDocument::reject() if they are used without inspection.range. Also throws it if the
/// mission has no vehicle, no structure, or a sensor that is not a camera.
void check_inspection(const MissionDocument& document);

/// Derives the limits of motion, the spacing of points and the view distance of an inspection.
/// Limits are those of slow inspection flights, or those of the vehicle if they are stricter. Has
/// no effect on other missions. Throws the error of MissionDocument::reject() if a given limit
/// exceeds that of the vehicle.
void complete_inspection(MissionDocument& document);

/// Returns the options of the planner for a complete document of an inspection.
survey::inspection::InspectionOptions inspection_options(const MissionDocument& document);

}  // namespace skycap::missions::config
