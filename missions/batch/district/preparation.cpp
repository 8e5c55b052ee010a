#include "missions/batch/district/preparation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "flight/export/geodesy.h"
#include "flight/flight_options.h"
#include "flight/route/route.h"
#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/json.h"
#include "geometry/io/output_folder.h"
#include "missions/batch/district/city_text.h"
#include "missions/batch/district/targets.h"
#include "missions/config/resolve.h"
#include "missions/site_data/file_reader.h"
#include "missions/support/json_text.h"
#include "missions/support/sha256.h"
#include "missions/version.h"
#include "missions/wizard/pad_search.h"
#include "missions/wizard/proposal.h"
#include "missions/wizard/target.h"

namespace skycap::missions::batch {
namespace {

namespace fs = std::filesystem;
using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using site_data::Object;
using site_data::Role;
using site_data::Source;
using support::json_of;
using support::vector_of;
using wizard::MissionValues;
using Json = nlohmann::ordered_json;

Json box_json(const Eigen::AlignedBox3d& box) {
  return {{"min", json_of(Eigen::Vector3d(box.min()))},
          {"max", json_of(Eigen::Vector3d(box.max()))}};
}

Eigen::AlignedBox3d box_of(const Json& json) {
  return {vector_of(json.at("min")), vector_of(json.at("max"))};
}

/// Rounds to centimetres, which is sufficient for a map.
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

/// Returns a checksum of all inputs of the preparation. Throws Error{bad_file} if a file named by
/// the district cannot be read.
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

/// Maximum distance between a target and a pad of the joint flight [m].
constexpr double most_to_pad = 300.0;

std::vector<AlignedBox3d> unknown_boxes(std::span<const PreparedTarget> targets) {
  std::vector<AlignedBox3d> boxes;
  for (const PreparedTarget& target : targets) boxes.push_back(target.unknown);
  return boxes;
}

/// Returns the horizontal distance [m].
double distance(const Vector3d& pad, const AlignedBox3d& box) {
  const Eigen::AlignedBox2d base(box.min().head<2>().eval(), box.max().head<2>().eval());
  return base.exteriorDistance(Eigen::Vector2d(pad.head<2>()));
}

/// Selects the pads of the target surveys and of the joint flight.
class PadChoice {
 public:
  /// Stores references to all arguments. Throws Error{bad_config} if a pad of the district is
  /// invalid.
  PadChoice(const DistrictFile& district, const flight::FlightOptions& draft,
            const flight::GeodeticPoint& origin, std::span<const PreparedTarget> targets);

  /// Returns the pad of a target's survey: next to the target, or else the nearest pad of the
  /// district.
  std::optional<Vector3d> pad_of(std::size_t target, double top);

  /// Returns the pads given by the district. Otherwise selects pads of the target surveys until no
  /// target is farther than 300 m from a pad. The first is the one nearest to the centre; then the
  /// pads of the farthest targets are added.
  std::vector<Vector3d> pads_of_flight() const;

 private:
  void take_given(const DistrictFile& district, const flight::GeodeticPoint& origin);

  std::span<const PreparedTarget> targets_;
  wizard::PadSearch search_;
  std::vector<Vector3d> given_;
  std::vector<std::optional<Vector3d>> own_;  ///< pads of the target surveys, by target
};

PadChoice::PadChoice(const DistrictFile& district, const flight::FlightOptions& draft,
                     const flight::GeodeticPoint& origin, std::span<const PreparedTarget> targets)
    : targets_(targets), search_(draft, unknown_boxes(targets)), own_(targets.size()) {
  take_given(district, origin);
}

void PadChoice::take_given(const DistrictFile& district, const flight::GeodeticPoint& origin) {
  const flight::LocalFrame frame(origin);
  double top = 0.0;
  for (const PreparedTarget& target : targets_) top = std::max(top, target.unknown.max().z());
  for (const wizard::Click& click : district.pads) {
    const Vector3d place = frame.to_local({click.latitude_deg, click.longitude_deg, origin.height});
    const auto pad = search_.at(place.head<2>());
    if (!pad || search_.room_over(*pad, top, 1.0) <= 0.0) {
      throw Error(ErrorKind::bad_config,
                  fmt::format("{}: key pads: {:.7f},{:.7f} is not free, level and even ground "
                              "outside the surveyed objects; use another position",
                              district.file.string(), click.latitude_deg, click.longitude_deg));
    }
    given_.push_back(*pad);
  }
}

std::optional<Vector3d> PadChoice::pad_of(std::size_t target, double top) {
  const AlignedBox3d& unknown = targets_[target].unknown;
  own_[target] = search_.beside(unknown, top);
  if (own_[target] || given_.empty()) return own_[target];
  return *std::ranges::min_element(given_, {},
                                   [&](const Vector3d& pad) { return distance(pad, unknown); });
}

std::vector<Vector3d> PadChoice::pads_of_flight() const {
  if (!given_.empty()) return given_;
  AlignedBox3d all;
  for (const PreparedTarget& target : targets_) all.extend(target.unknown);
  std::vector<Vector3d> pads;
  const Vector3d* next = nullptr;
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& pad : own_) {
    if (!pad) continue;
    const double here = (pad->head<2>() - all.center().head<2>()).norm();
    if (here < nearest) next = &*pad;
    nearest = std::min(nearest, here);
  }
  while (next != nullptr) {
    pads.push_back(*next);
    next = nullptr;
    double farthest = most_to_pad;
    for (std::size_t i = 0; i < targets_.size(); ++i) {
      if (!own_[i]) continue;
      double off = std::numeric_limits<double>::infinity();
      for (const Vector3d& pad : pads) off = std::min(off, distance(pad, targets_[i].unknown));
      if (off > farthest) next = &*own_[i];
      farthest = std::max(farthest, off);
    }
  }
  return pads;
}

constexpr const char* sites_folder = "sites";
constexpr const char* city_name = "district.city.json";

AlignedBox3d box_around(const std::vector<Object>& objects, const Group& group) {
  AlignedBox3d box;
  for (const std::size_t i : group) box.extend(geometry::bounding_box(objects[i].mesh));
  return box;
}

/// Generates unique titles that are valid file and mission names.
class Titles {
 public:
  std::string title_of(const std::string& id, std::size_t members) {
    constexpr std::size_t most = 60;
    std::string title;
    for (const char c : id.substr(0, most)) {
      const bool is_plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') ||
                            (c >= 'A' && c <= 'Z') || c == '-' || c == '_' || c == '.';
      title += is_plain ? c : '_';
    }
    if (title.empty() || title[0] == '.') title = "_" + title;
    if (members > 1) title += "_and_" + std::to_string(members - 1);
    const std::size_t times = ++given_[title];
    return times == 1 ? title : title_of(title + "-" + std::to_string(times), 1);
  }

 private:
  std::map<std::string, std::size_t> given_;
};

/// Prepares one district. Its members are the results of the preparation steps.
class Preparer {
 public:
  Preparer(const DistrictFile& district, fs::path out, const Tell& tell)
      : district_(district), out_(std::move(out)), tell_(tell) {}

  Prepared run(std::string digest) {
    tell_("reading " + district_.wishes.map.filename().string());
    // Opened first, because file paths in missions are relative to this folder.
    geometry::OutputFolder folder(out_);
    read_files();
    take_things();
    group();
    place_pads();
    prepared_.digest = std::move(digest);
    write_missions();
    write_flights(folder);
    folder.write(prepared_name, prepared_json(prepared_));
    folder.commit();
    return std::move(prepared_);
  }

 private:
  MissionValues basics(const fs::path& file) const {
    return {.file = file,
            .verb = "skycap district",
            .vehicle = district_.wishes.vehicle,
            .sources = {},
            .origin = chosen_.origin,
            .origin_is = "the centre of the district's targets",
            .unknown = {}};
  }

  bool has_terrain() const { return district_.wishes.terrain.has_value(); }

  void read_files() {
    const site_data::ReadOnce once;
    files_ = wizard::files_of(district_.wishes);
    chosen_ = choose_targets(district_, files_);
    draft_ = read_draft();
  }

  /// Reads all objects of the input files in the district frame.
  config::MissionSetup read_draft() const {
    MissionValues values = basics(out_ / "all.yaml");
    values.sources =
        wizard::sources_of(files_, chosen_.are_all ? std::vector<std::string>() : chosen_.ids);
    const AlignedBox3d somewhere(Vector3d::Zero(), Vector3d::Ones());
    const std::string text =
        mission_text(wizard::values_for(values, somewhere, 0.0, has_terrain()));
    return config::parse_mission(text, values.file.string(), district_.set);
  }

  /// Divides the obstacles into individual objects, written for each target, and files referenced
  /// by every mission.
  void take_things() {
    const site_data::SitePriors& site = *draft_.scene().priors;
    targets_ = &site.priors[0].objects;
    target_error_ = site.priors[0].uncertainty;
    std::map<std::string, int> times;
    for (std::size_t i = 1; i < site.priors.size(); ++i) {
      if (site.sources[i].role != Role::obstacle || site.priors[i].objects.empty()) {
        rest_.push_back(site.sources[i]);
        continue;
      }
      thing_error_ = std::max(thing_error_, site.priors[i].uncertainty);
      for (const Object& object : site.priors[i].objects) {
        if (!site_data::has_area(object.mesh)) continue;
        things_.push_back(object);
        if (const int before = times[object.id]++; before > 0) {
          things_.back().id += "#" + std::to_string(before + 1);
        }
        thing_boxes_.push_back(geometry::bounding_box(object.mesh));
      }
    }
  }

  void group() {
    Titles titles;
    for (const Group& group : grouped(*targets_, district_.merge_distance)) {
      const std::size_t first = group.front();
      PreparedTarget target{.title = titles.title_of((*targets_)[first].id, group.size()),
                            .ids = {},
                            .outlines = {},
                            .box = box_around(*targets_, group),
                            .unknown = {},
                            .refusal = {}};
      const fs::path file = out_ / missions_folder / (target.title + ".yaml");
      MissionValues values =
          wizard::values_for(basics(file), target.box, target_error_, has_terrain());
      // The coverage and view distances of a target are determined by its objects, not by its
      // group.
      values.registration_distance = values.view_distance = 0.0;
      for (const std::size_t i : group) {
        const Object& object = (*targets_)[i];
        target.ids.push_back(object.id);
        for (Ring& ring : outline_of(object.mesh)) target.outlines.push_back(std::move(ring));
        const MissionValues own = wizard::values_for(
            basics(file), geometry::bounding_box(object.mesh), target_error_, has_terrain());
        values.registration_distance =
            std::max(values.registration_distance, own.registration_distance);
        values.view_distance = std::max(values.view_distance, own.view_distance);
      }
      values.ground = has_terrain() ? std::round(100.0 * target.box.min().z()) / 100.0 : 0.0;
      values.clearance = draft_.flight().clearance;
      target.unknown = values.unknown;
      prepared_.targets.push_back(std::move(target));
      values_.push_back(std::move(values));
      groups_.push_back(group);
    }
  }

  void place_pads() {
    tell_(fmt::format("searching for take-off points beside {} targets", values_.size()));
    PadChoice choice(district_, draft_.flight(), chosen_.origin, prepared_.targets);
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const auto pad = choice.pad_of(i, wizard::top_of_climbs(values_[i]));
      if (!pad) {
        prepared_.targets[i].refusal =
            "no take-off point within 100 m of it is free, level and even; set pads";
        continue;
      }
      prepared_.targets[i].pad = *pad;
      values_[i] = with_pad(std::move(values_[i]), *pad);
    }
    prepared_.pads = choice.pads_of_flight();
  }

  /// Returns the distance from a fence beyond which enclosed objects cannot affect clearances or
  /// their reports [m].
  double beyond_fence() const {
    return draft_.flight().clearance + flight::reported_surplus + thing_error_;
  }

  /// Returns a city model of the targets and of all objects within or near the fence.
  std::string city_near(const AlignedBox3d& fence, const Group& targets) const {
    std::vector<const Object*> objects;
    std::set<std::string> ids;
    for (const std::size_t i : targets) {
      objects.push_back(&(*targets_)[i]);
      ids.insert(objects.back()->id);
    }
    for (const std::size_t i : things_near(fence)) {
      if (!ids.contains(things_[i].id)) objects.push_back(&things_[i]);
    }
    return city_text(objects);
  }

  std::vector<std::size_t> things_near(AlignedBox3d fence) const {
    fence.min().head<2>().array() -= beyond_fence();
    fence.max().head<2>().array() += beyond_fence();
    fence.min().z() = -1e6, fence.max().z() = 1e6;
    std::vector<std::size_t> near;
    for (std::size_t i = 0; i < things_.size(); ++i) {
      if (fence.intersects(thing_boxes_[i])) near.push_back(i);
    }
    return near;
  }

  std::vector<Source> sources_in(const fs::path& city, const std::vector<std::string>& ids) const {
    Source source;
    source.file = city;
    source.role = Role::obstacle;
    // Rounded up to millimetres, including the rounding of coordinates in the file.
    const double error = std::max(thing_error_, target_error_) + 2.0 * city_step;
    source.uncertainty = std::ceil(1000.0 * error) / 1000.0;
    std::vector<Source> sources{source, source};
    sources[0].role = Role::target;
    sources[0].select.ids = ids;
    sources.insert(sources.end(), rest_.begin(), rest_.end());
    return sources;
  }

  /// Returns the boxes of other targets within sensor range of a target's own box.
  std::vector<AlignedBox3d> boxes_beside(std::size_t target) const {
    const AlignedBox3d& own = values_[target].unknown;
    const Vector3d reach = Vector3d::Constant(wizard::sensor_range(values_[target]));
    const AlignedBox3d reached(own.min() - reach, own.max() + reach);
    std::vector<AlignedBox3d> boxes;
    for (std::size_t i = 0; i < values_.size(); ++i) {
      if (i != target && reached.intersects(values_[i].unknown))
        boxes.push_back(values_[i].unknown);
    }
    return boxes;
  }

  void write_missions() {
    tell_(fmt::format("writing {} missions", values_.size()));
    geometry::OutputFolder missions(out_ / missions_folder), sites(out_ / sites_folder);
    missions.replace([](std::string_view name) { return name.ends_with(".yaml"); });
    sites.replace([](std::string_view name) { return name.ends_with(".city.json"); });
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const PreparedTarget& target = prepared_.targets[i];
      if (!target.refusal.empty()) continue;
      MissionValues& values = values_[i];
      const std::string city = target.title + ".city.json";
      sites.write(city, city_near(values.fence, groups_[i]));
      values.sources = sources_in(out_ / sites_folder / city, target.ids);
      values.sees_neighbours = true;
      values.unknown_beside = boxes_beside(i);
      missions.write(target.title + ".yaml", mission_text(values));
    }
    sites.commit();
    missions.commit();
  }

  void write_flights(geometry::OutputFolder& folder) {
    if (prepared_.pads.empty()) return;
    MissionValues values = basics(out_);
    Group all;
    std::set<std::string> names;
    std::vector<std::string> ids;
    for (std::size_t i = 0; i < values_.size(); ++i) {
      values.unknown.extend(values_[i].unknown);
      values.fence.extend(values_[i].fence);
      values.registration_distance =
          std::max(values.registration_distance, values_[i].registration_distance);
      values.view_distance = std::max(values.view_distance, values_[i].view_distance);
      all.insert(all.end(), groups_[i].begin(), groups_[i].end());
      for (const std::string& id : prepared_.targets[i].ids) ids.push_back(id);
    }
    names.insert(ids.begin(), ids.end());
    for (const Vector3d& pad : prepared_.pads) {
      values.fence.extend(wizard::with_pad(values, pad).fence);
    }
    values.clearance = draft_.flight().clearance;
    for (const std::size_t i : things_near(values.fence)) {
      if (names.contains(things_[i].id)) continue;
      for (Ring& ring : outline_of(things_[i].mesh)) {
        prepared_.neighbours.push_back(std::move(ring));
      }
    }
    values.sources = sources_in(out_ / city_name, ids);
    folder.write(city_name, city_near(values.fence, all));
    geometry::OutputFolder flights(out_ / flights_folder);
    flights.replace([](std::string_view name) { return !name.starts_with("."); });
    for (std::size_t pad = 0; pad < prepared_.pads.size(); ++pad) {
      values.file = out_ / flights_folder / (pad_name(pad) + ".yaml");
      values.pad = prepared_.pads[pad];
      flights.write(pad_name(pad) + ".yaml", mission_text(values));
    }
    flights.commit();
  }

  const DistrictFile& district_;
  fs::path out_;
  const Tell& tell_;
  std::vector<Source> files_, rest_;
  ChosenTargets chosen_;
  config::MissionSetup draft_;
  const std::vector<Object>* targets_ = nullptr;
  double target_error_ = 0.0, thing_error_ = 0.0;
  std::vector<Object> things_;  ///< obstacles with unique names
  std::vector<AlignedBox3d> thing_boxes_;
  std::vector<Group> groups_;
  std::vector<MissionValues> values_;
  Prepared prepared_;
};

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

CampaignFile campaign_of(const DistrictFile& district, const Prepared& prepared,
                         const fs::path& out) {
  CampaignFile file{.name = district.name,
                    .folder = out / missions_folder,
                    .missions = {},
                    .planners = {district.planner},
                    .seeds = 1,
                    .first_seed = district.seed,
                    .variants = {{"", district.set}},
                    .results = ItemResults::package};
  for (const PreparedTarget& target : prepared.targets) {
    if (target.refusal.empty()) file.missions.push_back(target.title + ".yaml");
  }
  return file;
}

Prepared prepare(const DistrictFile& district, const fs::path& out, const Tell& tell) {
  tell("reading the district's files");
  std::string digest = digest_of(district);
  const fs::path kept = out / prepared_name;
  if (fs::exists(kept)) {
    Prepared prepared = read_prepared(kept);
    if (prepared.digest == digest) return prepared;
  }
  return Preparer(district, out, tell).run(std::move(digest));
}

}  // namespace skycap::missions::batch
