#include "flight/interpreter/command_table.h"

#include <algorithm>
#include <array>

namespace skycap::flight {
namespace {

constexpr SupportedBy both = SupportedBy::both, ardupilot = SupportedBy::ardupilot;

constexpr std::array<CommandRow, 38> table{{
    {16, "NAV_WAYPOINT", Meaning::fly_to, both, ""},
    {17, "NAV_LOITER_UNLIM", Meaning::rejected, both,
     "it loiters indefinitely, so no later item is flown"},
    {18, "NAV_LOITER_TURNS", Meaning::rejected, both, "its circles cannot be verified"},
    {19, "NAV_LOITER_TIME", Meaning::fly_to, both, ""},
    {20, "NAV_RETURN_TO_LAUNCH", Meaning::rejected, both,
     "the return altitude is not in the file; end with a landing (21)"},
    {21, "NAV_LAND", Meaning::land, both, ""},
    {22, "NAV_TAKEOFF", Meaning::take_off, both, ""},
    {30, "NAV_CONTINUE_AND_CHANGE_ALT", Meaning::rejected, both,
     "ArduPilot skips it, and PX4 rejects the mission"},
    {31, "NAV_LOITER_TO_ALT", Meaning::rejected, both,
     "its path to the target height cannot be verified"},
    {80, "NAV_ROI", Meaning::rejected, both, "it points the vehicle and the gimbal at a position"},
    {82, "NAV_SPLINE_WAYPOINT", Meaning::rejected, both, "its curve cannot be verified"},
    {92, "NAV_GUIDED_ENABLE", Meaning::rejected, both, "it transfers control to another computer"},
    {93, "NAV_DELAY", Meaning::wait, both, ""},
    {112, "CONDITION_DELAY", Meaning::rejected, both,
     "it delays turns and captures until the vehicle has moved to another position"},
    {113, "CONDITION_CHANGE_ALT", Meaning::rejected, both, "ArduPilot skips it"},
    {114, "CONDITION_DISTANCE", Meaning::rejected, both,
     "it delays turns and captures until the vehicle has moved to another position"},
    {115, "CONDITION_YAW", Meaning::turn, ardupilot, ""},
    {177, "DO_JUMP", Meaning::jump, both, ""},
    {178, "DO_CHANGE_SPEED", Meaning::set_speed, both, ""},
    {179, "DO_SET_HOME", Meaning::rejected, both,
     "it changes the reference for all heights above home"},
    {185, "DO_FLIGHTTERMINATION", Meaning::rejected, both, "it stops the motors"},
    {189, "DO_LAND_START", Meaning::no_motion, both, ""},
    {195, "DO_SET_ROI_LOCATION", Meaning::rejected, both,
     "it points the vehicle and the gimbal at a position"},
    {197, "DO_SET_ROI_NONE", Meaning::no_motion, both, ""},
    {201, "DO_SET_ROI", Meaning::rejected, both,
     "it points the vehicle and the gimbal at a position"},
    {203, "DO_DIGICAM_CONTROL", Meaning::trigger_photo, both, ""},
    {205, "DO_MOUNT_CONTROL", Meaning::aim_by_mount, both, ""},
    {206, "DO_SET_CAM_TRIGG_DIST", Meaning::space_photos, both, ""},
    {207, "DO_FENCE_ENABLE", Meaning::hold_fence, ardupilot, ""},
    {222, "DO_GUIDED_LIMITS", Meaning::rejected, both, "it transfers control to another computer"},
    {400, "COMPONENT_ARM_DISARM", Meaning::rejected, both, "it may stop the motors"},
    {530, "SET_CAMERA_MODE", Meaning::no_motion, both, ""},
    {1000, "DO_GIMBAL_MANAGER_PITCHYAW", Meaning::aim_by_gimbal, both, ""},
    {2000, "IMAGE_START_CAPTURE", Meaning::take_photo, both, ""},
    {2001, "IMAGE_STOP_CAPTURE", Meaning::no_motion, both, ""},
    {2500, "VIDEO_START_CAPTURE", Meaning::no_motion, both, ""},
    {2501, "VIDEO_STOP_CAPTURE", Meaning::no_motion, both, ""},
    {42700, "DO_SEND_SCRIPT_MESSAGE", Meaning::rejected, both, "the effect of a script is unknown"},
}};
static_assert(std::ranges::is_sorted(table, {}, &CommandRow::id));

}  // namespace

const CommandRow* find_command(int id) {
  const auto row = std::ranges::lower_bound(table, id, {}, &CommandRow::id);
  return row != table.end() && row->id == id ? &*row : nullptr;
}

bool has_position(Meaning meaning) {
  return meaning == Meaning::take_off || meaning == Meaning::fly_to || meaning == Meaning::land;
}

}  // namespace skycap::flight
