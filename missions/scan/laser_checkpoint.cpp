#include "missions/scan/laser_checkpoint.h"

#include "geometry/error.h"
#include "missions/support/json_text.h"

namespace skycap::missions::scan {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const CloudState& state) {
  Json json{{"bytes", state.bytes},
            {"points", state.totals.points},
            {"points_by_return", state.totals.points_by_return},
            {"checksum", state.totals.checksum}};
  if (!state.totals.bounds.isEmpty()) {
    json["low"] = support::to_json(state.totals.bounds.min());
    json["high"] = support::to_json(state.totals.bounds.max());
  }
  return json;
}

CloudState parse_state(const Json& json) {
  CloudState state;
  state.bytes = json.at("bytes").get<std::uint64_t>();
  state.totals.points = json.at("points").get<std::uint64_t>();
  json.at("points_by_return").get_to(state.totals.points_by_return);
  // Not present in checkpoints of earlier versions.
  state.totals.checksum = json.value("checksum", std::uint64_t{0});
  if (json.contains("low")) {
    state.totals.bounds = {support::to_vector(json["low"]), support::to_vector(json.at("high"))};
  }
  return state;
}

}  // namespace

Json to_json(const LaserCheckpoint& checkpoint) {
  Json files = Json::array();
  for (const CloudState& state : checkpoint.files) files.push_back(to_json(state));
  return {{"firings", checkpoint.progress.firings},
          {"points", checkpoint.progress.points},
          {"simulation_s", checkpoint.time},
          {"files", files}};
}

LaserCheckpoint parse_laser_checkpoint(const Json& json, std::size_t files,
                                       const std::string& name) {
  const auto fail = [&](const std::string& reason) -> void {
    throw Error(ErrorKind::bad_file,
                name + ": the last line is damaged (" + reason + "); start again without --resume");
  };
  LaserCheckpoint checkpoint;
  try {
    checkpoint.progress.firings = json.at("firings").get<std::uint64_t>();
    checkpoint.progress.points = json.at("points").get<std::uint64_t>();
    checkpoint.time = json.at("simulation_s").get<double>();
    for (const Json& file : json.at("files")) checkpoint.files.push_back(parse_state(file));
  } catch (const Json::exception& failure) {
    fail(failure.what());
  }
  if (checkpoint.files.size() != files) fail("other files");
  return checkpoint;
}

}  // namespace skycap::missions::scan
