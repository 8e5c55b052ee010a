/// Joint flight to all targets of a district. The waypoints are ordered across targets and divided
/// into sorties from several pads according to battery energy.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/route/route.h"
#include "geometry/io/output_folder.h"
#include "missions/batch/benchmark/trials.h"
#include "missions/batch/district/preparation.h"
#include "missions/package/flight_files.h"

namespace skycap::missions::batch {

/// Results of a completed survey.
struct SurveyFigures {
  std::filesystem::path folder;  ///< folder of its package
  std::size_t views = 0;
  double coverage = 0.0;  ///< coverage of the target's objects, as a fraction of their surface
  /// Coverage as a fraction of the visible surface of the scene.
  std::optional<double> coverage_visible;
  double planning_time = 0.0;   ///< processor time for all views [s]
  double time = 0.0;            ///< duration of a separate flight for this target [s]
  double length = 0.0;          ///< length of a separate flight for this target [m]
  double wall_time = 0.0;       ///< elapsed time of the item [s]
  std::size_t peak_memory = 0;  ///< peak memory of the process up to the end of the item [byte]
  std::size_t file_bytes = 0;   ///< size of the package [byte]
  std::string stop_reason;
};

struct SurveyedTarget {
  DistrictTarget target;
  std::optional<SurveyFigures> figures;  ///< results, if the survey is completed
  std::string failure_reason;            ///< reason for missing results
};

/// Reads the results of the package in `folder`, run as described by `record`. Throws
/// Error{bad_file}.
SurveyFigures compute_figures(const std::filesystem::path& folder, const TrialRecord& record);

/// Flight from one pad.
struct PadFlight {
  std::size_t pad = 0;  ///< index of the district's pad
  flight::Route route;  ///< `view_index` of its waypoints is an index of DistrictFlight::stations
  package::FlightFiles files{};
};

/// View of a target.
struct DistrictCapturePoint {
  std::size_t target = 0;
  std::uint32_t view = 0;
  std::string skip_reason;  ///< reason why it is not visited; empty if it is visited
};

struct DistrictFlight {
  std::vector<PadFlight> pads;  ///< only pads with a flight
  std::vector<DistrictCapturePoint>
      capture_points;         ///< views of all targets, in the order of the targets
  double order_length = 0.0;  ///< length of straight lines in the chosen order [m]
  std::vector<std::string> notes;

  std::size_t sorties() const;
  double duration() const;  ///< total duration of all sorties [s]
  double length() const;    ///< total length of all sorties [m]
};

/// Plans the joint flight through the views of all surveys. Free space is space observed free in
/// any survey, and space outside the unknown boxes of all targets, including targets without a
/// survey. All objects of the input files are obstacles, as in the missions of the pads. A waypoint
/// that cannot be reached from its best pad is tried from the next two pads. Every leg is verified
/// as in plan_route(). Planning ends without a flight once `stop` is requested.
DistrictFlight plan_district(const DistrictFile& district, const DistrictPlan& district_plan,
                             std::span<const SurveyedTarget> targets,
                             const std::filesystem::path& out,
                             const ReportProgress& report_progress, const std::stop_token& stop);

}  // namespace skycap::missions::batch
