#include "missions/batch/district/prepared.h"

#include <cmath>
#include <span>

#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/json.h"
#include "missions/support/json_text.h"
#include "missions/support/sha256.h"
#include "missions/version.h"

namespace skycap::missions::batch {
namespace {

namespace fs = std::filesystem;
using support::json_of;
using support::vector_of;
using Json = nlohmann::ordered_json;

Json box_json(const Eigen::AlignedBox3d& box) {
  return {{"min", json_of(Eigen::Vector3d(box.min()))},
          {"max", json_of(Eigen::Vector3d(box.max()))}};
}

Eigen::AlignedBox3d box_of(const Json& json) {
  return {vector_of(json.at("min")), vector_of(json.at("max"))};
}

/// To the centimetre, which is all that a map shows.
Json rings_json(const std::vector<Ring>& rings) {
  const auto shown = [](double value) { return std::round(100.0 * value) / 100.0; };
  Json list = Json::array();
  for (const Ring& ring : rings) {
    Json& places = list.emplace_back(Json::array());
    for (const Eigen::Vector2d& place : ring) {
      places.push_back({shown(place.x()), shown(place.y())});
    }
  }
  return list;
}

std::vector<Ring> rings_of(const Json& json) {
  std::vector<Ring> rings;
  for (const Json& places : json) {
    Ring& ring = rings.emplace_back();
    for (const Json& place : places) {
      ring.emplace_back(place.at(0).get<double>(), place.at(1).get<double>());
    }
  }
  return rings;
}

Json json_of(const PreparedTarget& target) {
  return {{"title", target.title},
          {"ids", target.ids},
          {"box", box_json(target.box)},
          {"unknown", box_json(target.unknown)},
          {"pad", json_of(target.pad)},
          {"refusal", target.refusal},
          {"outlines", rings_json(target.outlines)}};
}

PreparedTarget target_of(const Json& json) {
  return {.title = json.at("title"),
          .ids = json.at("ids"),
          .outlines = rings_of(json.at("outlines")),
          .box = box_of(json.at("box")),
          .unknown = box_of(json.at("unknown")),
          .pad = vector_of(json.at("pad")),
          .refusal = json.at("refusal")};
}

}  // namespace

std::string pad_name(std::size_t pad) { return "pad_" + std::to_string(pad + 1); }

std::string prepared_json(const Prepared& prepared) {
  Json json{
      {"digest", prepared.digest}, {"pads", json_of(prepared.pads)}, {"targets", Json::array()}};
  for (const PreparedTarget& target : prepared.targets) json["targets"].push_back(json_of(target));
  json["neighbours"] = rings_json(prepared.neighbours);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Prepared read_prepared(const fs::path& file) {
  try {
    const Json json = geometry::parse_json<Json>(geometry::read_file(file, geometry::largest_json));
    Prepared prepared{.digest = json.at("digest"),
                      .pads = {},
                      .targets = {},
                      .neighbours = rings_of(json.at("neighbours"))};
    for (const Json& pad : json.at("pads")) prepared.pads.push_back(vector_of(pad));
    for (const Json& target : json.at("targets")) prepared.targets.push_back(target_of(target));
    return prepared;
  } catch (const Json::exception& error) {
    throw Error(ErrorKind::bad_file, file.string() + ": is damaged (" + error.what() +
                                         "); remove it; skycap district creates it again");
  }
}

std::string digest_of(const DistrictFile& district) {
  std::string inputs = std::string(version) + "\n" + geometry::read_file(district.file);
  std::vector<fs::path> files{district.wishes.map};
  if (district.wishes.terrain) files.push_back(*district.wishes.terrain);
  files.insert(files.end(), district.wishes.obstacles.begin(), district.wishes.obstacles.end());
  for (const fs::path& file : files) {
    geometry::require_regular_file(file);
    inputs += "\n" + support::sha256_of_file(file);
  }
  return support::sha256(std::as_bytes(std::span(inputs)));
}

batch::CampaignFile campaign_of(const DistrictFile& district, const Prepared& prepared,
                                const fs::path& out) {
  batch::CampaignFile file{.name = district.name,
                           .folder = out / missions_folder,
                           .missions = {},
                           .planners = {district.planner},
                           .seeds = 1,
                           .first_seed = district.seed,
                           .variants = {{"", district.set}},
                           .results = batch::ItemResults::package};
  for (const PreparedTarget& target : prepared.targets) {
    if (target.refusal.empty()) file.missions.push_back(target.title + ".yaml");
  }
  return file;
}

}  // namespace skycap::missions::batch
