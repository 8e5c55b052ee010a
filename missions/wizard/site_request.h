/// User input from which a mission is proposed.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "missions/site_data/source.h"

namespace skycap::missions::wizard {

/// WGS84 position on a map.
struct Click {
  double latitude_deg = 0.0, longitude_deg = 0.0;
};

/// Parses "LATITUDE,LONGITUDE" in degrees, the clipboard format of web maps. Returns nullopt for
/// other strings.
std::optional<Click> click_in(const std::string& text);

/// Description of the expected format, for messages.
inline constexpr const char* click_form = "LATITUDE,LONGITUDE in degrees, such as 48.7631,11.3991";

/// Selection of the object to survey by one criterion; may be empty if the file contains a single
/// object.
struct Pick {
  std::vector<std::string> ids;
  /// Required attributes, such as parts of an address.
  std::map<std::string, std::string> attributes;
  std::optional<Click> click;
};

/// Interpretation of the files, as specified by the `prior` keys of the same names.
struct ImportOptions {
  std::string crs;  ///< Overrides the CRS of the map; applies to files without one.
  std::optional<site_data::HeightDatum> vertical;
  std::optional<double> base, height;  ///< base and height of extruded outlines [m]
};

struct SiteRequest {
  std::filesystem::path map;  ///< file with the target and its neighbours
  Pick target;
  ImportOptions import_options;
  std::optional<std::filesystem::path> terrain;
  std::vector<std::filesystem::path> obstacles;  ///< further files with obstacles
  std::string vehicle = "generic";
  std::string
      sensor;  ///< preset; LiDARs also NAME.yaml. Empty: the vehicle's camera, if it has one
  std::optional<double> gsd;  ///< Ground sampling distance of a photo camera, `sensor` [m].
};

}  // namespace skycap::missions::wizard
