/// What a surveyor says of a site before there is a mission.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "missions/site_data/source.h"

namespace skycap::missions::wizard {

/// A place on the map.
struct Click {
  double latitude_deg = 0.0, longitude_deg = 0.0;
};

/// "LATITUDE,LONGITUDE" in degrees, as maps on the web copy it; nothing if it is not that.
std::optional<Click> click_in(const std::string& text);

/// What a click is to be written as, for messages.
inline constexpr const char* click_form = "LATITUDE,LONGITUDE in degrees, such as 48.7631,11.3991";

/// Which thing of a file is to be surveyed: by one of these, or the file has but one.
struct Pick {
  std::vector<std::string> ids;
  std::map<std::string, std::string> attributes;  ///< such as parts of an address
  std::optional<Click> click;
};

/// How the files are to be understood, as the keys of `prior` of these names say.
struct Reading {
  std::string crs;
  std::optional<site_data::HeightDatum> vertical;
  std::optional<double> base, height;  ///< of outlines
};

struct Wishes {
  std::filesystem::path map;  ///< where the target and its neighbours are
  Pick target;
  Reading reading;
  std::optional<std::filesystem::path> terrain;
  std::vector<std::filesystem::path> obstacles;  ///< further files of what is in the way
  std::string vehicle = "generic";
};

}  // namespace skycap::missions::wizard
