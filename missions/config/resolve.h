/// From what a mission file says to what is run.
///
/// A document is completed in a stated order (docs/development/architecture.md): profiles of
/// vehicle and sensor, the frame of the site, prior data in this frame, then the values that follow
/// from others. resolve() is a function of its arguments alone, and of a document that it has
/// completed itself it makes the same setup.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "missions/config/mission_reader.h"
#include "missions/config/mission_setup.h"
#include "missions/site_data/site_priors.h"

namespace skycap::missions::config {

/// Told what is being done, where that may take long. May be empty.
using Report = std::function<void(const std::string& what)>;

/// What the names in a document stand for.
struct Profiles {
  std::optional<flight::Vehicle> vehicle;
  std::optional<std::uint32_t> vehicle_checksum;  ///< CRC-32 of the first vehicle's file, if any
  std::vector<flight::Vehicle> fleet;
  std::vector<flight::Vehicle> stand_ins;  ///< see FlightOptions
  std::optional<sim::LidarConfig> scanner;
};

/// Reads the descriptions of vehicles and of the scanner that the document names. Throws
/// Error{bad_config} as MissionDocument::refuse().
Profiles read_profiles(const MissionDocument& document);

/// EGM96's undulation where a geoid is asked for and no key says it; nothing where PROJ does not
/// have it, or nobody asks.
std::optional<double> geoid_undulation(const MissionDocument& document);

/// The frame that prior data is read in. `geoid` is its undulation at the site, if it is known.
site_data::SiteFrame site_frame(const MissionDocument& document, std::optional<double> geoid);

/// Reads the prior data of a document that is checked as far as that needs; null if it has none.
/// Throws Error{bad_config} as MissionDocument::refuse(), naming the key of the source. `report` is
/// told which file it is at: there may be thousands.
std::shared_ptr<const site_data::SitePriors> read_priors(const MissionDocument& document,
                                                         const site_data::SiteFrame& frame,
                                                         const Report& report = {});

/// Fills in the values that follow from others, and checks that the keys go together and that the
/// mission's planner can work with its settings. Throws Error{bad_config} as
/// MissionDocument::refuse() for the first that is wrong.
MissionSetup resolve(MissionDocument document, const Profiles& profiles,
                     std::shared_ptr<const site_data::SitePriors> priors,
                     std::optional<double> geoid = {});

/// The same with all that the document asks for read from files.
MissionSetup resolve(MissionDocument document, const Report& report = {});

/// The setup of the same mission with other values of some keys; prior data is not read again.
MissionSetup with_keys(const MissionSetup& setup, const std::vector<KeyOverride>& changes);

/// read_mission_document() and resolve(); throws what they throw, and Error{bad_config} if the
/// mission has no scene: it is for live surveys.
MissionSetup read_mission(const std::filesystem::path& file,
                          const std::vector<KeyOverride>& overrides = {},
                          const Report& report = {});

/// The same with or without a scene. Throws Error{bad_config} naming a key that a mission without
/// one has to give.
MissionSetup read_live_mission(const std::filesystem::path& file,
                               const std::vector<KeyOverride>& overrides = {},
                               const Report& report = {});

/// The same for a mission that is already in memory; `name` stands for the file in messages.
MissionSetup parse_mission(const std::string& text, const std::string& name,
                           const std::vector<KeyOverride>& overrides = {});

}  // namespace skycap::missions::config
