/// Converts a mission document to a setup that can be run.
///
/// A document is completed in a fixed order (docs/development/architecture.md): vehicle and sensor
/// profiles, site frame, prior data in this frame, then derived values. resolve() is a pure
/// function of its arguments. Resolving a completed document again results in the same setup.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/pose/photo_camera.h"
#include "missions/config/mission_reader.h"
#include "missions/config/mission_setup.h"
#include "missions/site_data/site_priors.h"

namespace skycap::missions::config {

/// Callback for progress messages of long operations. May be empty.
using Report = std::function<void(const std::string& what)>;

/// Vehicles and scanner named in a document.
struct Profiles {
  std::optional<flight::Vehicle> vehicle;
  /// CRC-32 of the first vehicle's file; nullopt for presets
  std::optional<std::uint32_t> vehicle_checksum;
  std::vector<flight::Vehicle> fleet;
  std::vector<flight::Vehicle> substitutes;  ///< vehicles of other autopilots, see FlightOptions
  std::optional<sim::LidarConfig> scanner;
  std::optional<geometry::PhotoCameraConfig> photo_camera;
};

/// Reads the vehicle and scanner descriptions named in the document. Throws Error{bad_config}
/// through MissionDocument::reject().
Profiles read_profiles(const MissionDocument& document);

/// Returns the EGM96 undulation [m] at the site if a vehicle or prior data requires it and no key
/// sets it. Returns nullopt if the PROJ grid is not installed.
std::optional<double> geoid_undulation(const MissionDocument& document);

/// Returns the frame in which prior data is read. `geoid` is the undulation at the site [m], if
/// known.
site_data::SiteFrame site_frame(const MissionDocument& document, std::optional<double> geoid);

/// Reads the prior data of a document; returns null without prior data. The document's own keys
/// must already be checked. Throws Error{bad_config} through MissionDocument::reject() for the key
/// of the source. `report` receives the name of each file, as there may be thousands.
std::shared_ptr<const site_data::SitePriors> read_priors(const MissionDocument& document,
                                                         const site_data::SiteFrame& frame,
                                                         const Report& report = {});

/// Derives missing values, and checks the key combinations and the planner's settings. Throws
/// Error{bad_config} through MissionDocument::reject() for the first violation.
MissionSetup resolve(MissionDocument document, const Profiles& profiles,
                     std::shared_ptr<const site_data::SitePriors> priors,
                     std::optional<double> geoid = {});

/// Reads the profiles, geoid undulation and prior data that the document names, and then resolves
/// it. Throws Error{bad_config} and Error{bad_file}.
MissionSetup resolve(MissionDocument document, const Report& report = {});

/// Resolves the mission again with changed keys. Prior data is not read again. Mission name and run
/// options are preserved.
MissionSetup with_keys(const MissionSetup& setup, const std::vector<KeyOverride>& changes);

/// read_mission_document() and resolve(); throws what they throw, and Error{bad_config} if the
/// mission has neither a scene nor a photo camera: it is for live surveys.
MissionSetup read_mission(const std::filesystem::path& file,
                          const std::vector<KeyOverride>& overrides = {},
                          const Report& report = {});

/// Reads and resolves a mission file with or without a scene. Throws Error{bad_config} for keys
/// that a mission without a scene requires.
MissionSetup read_live_mission(const std::filesystem::path& file,
                               const std::vector<KeyOverride>& overrides = {},
                               const Report& report = {});

/// Reads and resolves a mission from a string, with or without a scene. `name` is the file name in
/// messages.
MissionSetup parse_mission(const std::string& text, const std::string& name,
                           const std::vector<KeyOverride>& overrides = {});

}  // namespace skycap::missions::config
