/// Names of version 0.1, for programs that are ported to 0.2. Include this header first. It defines
/// each former name of the public headers as a macro for the new one; names of a single common
/// word, such as `least` or `ports`, are not defined (CHANGELOG.md lists them). Version 0.3 removes
/// it.
#pragma once

namespace skycap::survey::surfel {}
namespace skycap::survey {
namespace skycap = surfel;
}

// NOLINTBEGIN(cppcoreguidelines-macro-usage)
#define BelievedPatch EstimatedPatch
#define Dialect AutopilotType
#define LegProof LegVerification
#define PadGround LandingSurface
#define Passage FlyThrough
#define PlaceCheck PositionCheck
#define ReturnLaw RtlProfile
#define ScansOnWay ScansEnRoute
#define Sight SightLine
#define SkycapConfig SurfelConfig
#define SkycapPlanner SurfelPlanner
#define SkycapStop SurfelStop
#define Station CapturePoint
#define SurveyBelief SurveyEstimate
#define SurveyPorts SurveyCallbacks
#define SurveySteps SurveyStepper
#define TakePositions PositionsCallback
#define believed_body_from_sensor estimated_body_from_sensor
#define believed_trajectory estimated_trajectory
#define can_look can_aim
#define certified_returns verified_returns
#define certify_route verify_route
#define columns_of make_columns
#define direction_of compute_direction
#define flown_round rounded
#define format_of_file detect_format
#define holds_curves supports_curves
#define is_proven is_verified
#define is_refused is_rejected
#define is_station is_capture_point
#define least_duration min_duration
#define least_height min_height
#define least_height_over min_height_at
#define least_pitch min_pitch
#define most_height max_height
#define most_length max_length
#define most_pitch max_pitch
#define most_sights max_sight_lines
#define most_targets max_targets
#define most_time max_time
#define next_view_instead next_alternative_view
#define not_given unspecified
#define notes_of make_notes
#define on_way en_route
#define opening_view next_initial_view
#define picture_views photo_views
#define pitch_of compute_pitch
#define places_of read_positions
#define planning_law planning_rtl_profile
#define release_cloud take_cloud
#define returns_of_shots number_of_returns
#define sense_on_way sense_en_route
#define sensed_on_way sensed_en_route
#define stand_off min_standoff
#define station_length capture_leg_length
#define take_in add_scan
#define view_of to_view
#define view_of_target make_target_view
#define views_on_way en_route_views
#define wanted_coverage target_coverage
#define yaw_of compute_yaw
// NOLINTEND(cppcoreguidelines-macro-usage)
