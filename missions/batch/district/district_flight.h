/// One flight of all targets of a district: their stations in an order across targets, in sorties
/// by energy from several pads.
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

/// A survey that is over.
struct SurveyFigures {
  std::filesystem::path folder;  ///< its package's
  std::size_t views = 0;
  double coverage = 0.0;                   ///< of the surface of the target's things
  std::optional<double> coverage_visible;  ///< of what can be seen of the scene
  double planning_time = 0.0;              ///< of all views [s] of a processor
  double time = 0.0;                       ///< of its own mission, flown by itself [s]
  double length = 0.0;                     ///< likewise [m]
  double wall_time = 0.0;                  ///< of the item [s]
  std::size_t peak_memory = 0;             ///< of the program until then [byte]
  std::size_t file_bytes = 0;              ///< of the package
  std::string stop_reason;
};

struct SurveyedTarget {
  PreparedTarget target;
  std::optional<SurveyFigures> figures;  ///< of a survey that is over
  std::string why_none;                  ///< else
};

/// The figures of a package in `folder`, whose survey ran as `record` says. Throws Error{bad_file}.
SurveyFigures figures_of(const std::filesystem::path& folder, const TrialRecord& record);

/// What is flown from one pad.
struct PadFlight {
  std::size_t pad = 0;  ///< of the district's
  flight::Route route;  ///< its stations' view_index is a DistrictStation
  package::FlightFiles files{};
};

/// A view of a target.
struct DistrictStation {
  std::size_t target = 0;
  std::uint32_t view = 0;
  std::string why_not;  ///< it is flown to; empty: it is
};

struct DistrictFlight {
  std::vector<PadFlight> pads;            ///< those that something is flown from
  std::vector<DistrictStation> stations;  ///< of all targets, in their order
  double order_length = 0.0;              ///< straight lines in the order chosen [m]
  std::vector<std::string> notes;

  std::size_t sorties() const;
  double duration() const;  ///< of all sorties [s]
  double length() const;    ///< [m]
};

/// Plans it through the views of all surveys. Free is what some survey has measured to be free, and
/// what lies outside of the unknown boxes of all targets, whether they were surveyed or not; all
/// that the files hold is in the way, as the missions of the pads have it. A station that cannot be
/// flown to from the pad that is best for it is tried from the next two. Every leg is proven as
/// plan_route() does it. Nothing is planned once `stop` is requested.
DistrictFlight plan_district(const DistrictFile& district, const Prepared& prepared,
                             std::span<const SurveyedTarget> targets,
                             const std::filesystem::path& out, const Tell& tell,
                             const std::stop_token& stop);

}  // namespace skycap::missions::batch
