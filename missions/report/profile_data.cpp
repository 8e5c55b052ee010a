#include "missions/report/profile_data.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "missions/package/profile_file.h"

namespace skycap::missions::report {

nlohmann::ordered_json profile_data(const ResultFinder& results) {
  using Json = nlohmann::ordered_json;
  const std::filesystem::path file = results(package::profile_name);
  if (!is_there(file)) return {};
  std::vector<package::ProfileRow> rows;
  try {
    rows = package::read_profile(geometry::read_file(file));
  } catch (const Error& error) {
    throw Error(error.kind(), file.string() + ": " + error.what());
  }
  const auto centimetres = [](double value) { return std::round(100.0 * value) / 100.0; };
  if (rows.empty()) return {};
  Json data{{"required_m", rows.front().required}};
  for (const char* name : {"begin_m", "end_m", "height_m", "ground_m", "is_terrain", "clearance_m",
                           "kind", "nearest"}) {
    data[name] = Json::array();
  }
  for (const package::ProfileRow& row : rows) {
    data["begin_m"].push_back(centimetres(row.begin));
    data["end_m"].push_back(centimetres(row.end));
    data["height_m"].push_back(centimetres(row.height));
    data["ground_m"].push_back(centimetres(row.ground));
    data["is_terrain"].push_back(row.is_terrain);
    data["clearance_m"].push_back(centimetres(row.clearance));
    data["kind"].push_back(row.kind);
    data["nearest"].push_back(row.obstacle);
  }
  return data;
}

}  // namespace skycap::missions::report
