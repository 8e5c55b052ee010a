/// Summary of an inspection in its results folder.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "missions/config/key_override.h"
#include "missions/config/mission_setup.h"

namespace skycap::missions::package {

struct InspectionSummary {
  config::MissionSetup mission;        ///< Mission with all effective keys.
  std::optional<Eigen::Vector3d> pad;  ///< Take-off point of the route files, if there are any.
  std::size_t attainable = 0;          ///< Points of the structure that some position sees.
};

/// Reads the summary of the inspection in `folder`. Returns nullopt for results of other missions.
/// `overrides` replace keys of the mission. With another vehicle, the limits of motion are derived
/// from it again. Throws Error{bad_file} naming the file if it is missing or invalid.
std::optional<InspectionSummary> read_inspection_summary(
    const std::filesystem::path& folder, const std::vector<config::KeyOverride>& overrides);

}  // namespace skycap::missions::package
