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
using support::to_json;
using support::to_vector;
using wizard::MissionValues;
using Json = nlohmann::ordered_json;

Json box_json(const Eigen::AlignedBox3d& box) {
  return {{"min", to_json(Eigen::Vector3d(box.min()))},
          {"max", to_json(Eigen::Vector3d(box.max()))}};
}

Eigen::AlignedBox3d parse_box(const Json& json) {
  return {to_vector(json.at("min")), to_vector(json.at("max"))};
}

/// Rounds to centimetres, which is sufficient for a map.
Json rings_json(const std::vector<Ring>& rings) {
  const auto shown = [](double value) { return std::round(100.0 * value) / 100.0; };
  Json list = Json::array();
  for (const Ring& ring : rings) {
    Json& footprint = list.emplace_back(Json::array());
    for (const Eigen::Vector2d& position : ring) {
      footprint.push_back({shown(position.x()), shown(position.y())});
    }
  }
  return list;
}

std::vector<Ring> parse_rings(const Json& json) {
  std::vector<Ring> rings;
  for (const Json& footprint : json) {
    Ring& ring = rings.emplace_back();
    for (const Json& position : footprint) {
      ring.emplace_back(position.at(0).get<double>(), position.at(1).get<double>());
    }
  }
  return rings;
}

Json to_json(const DistrictTarget& target) {
  return {{"title", target.title},
          {"ids", target.ids},
          {"box", box_json(target.box)},
          {"unknown", box_json(target.unknown)},
          {"pad", to_json(target.pad)},
          {"refusal", target.rejection_reason},
          {"outlines", rings_json(target.outlines)}};
}

DistrictTarget parse_target(const Json& json) {
  return {.title = json.at("title"),
          .ids = json.at("ids"),
          .outlines = parse_rings(json.at("outlines")),
          .box = parse_box(json.at("box")),
          .unknown = parse_box(json.at("unknown")),
          .pad = to_vector(json.at("pad")),
          .rejection_reason = json.at("refusal")};
}

/// Returns a checksum of all inputs of the preparation. Throws Error{bad_file} if a file named by
/// the district cannot be read.
std::string compute_checksum(const DistrictFile& district) {
  std::string inputs = std::string(version) + "\n" + geometry::read_file(district.file);
  std::vector<fs::path> files{district.request.map};
  if (district.request.terrain) files.push_back(*district.request.terrain);
  files.insert(files.end(), district.request.obstacles.begin(), district.request.obstacles.end());
  for (const fs::path& file : files) {
    geometry::require_regular_file(file);
    inputs += "\n" + support::compute_file_sha256(file);
  }
  return support::sha256(std::as_bytes(std::span(inputs)));
}

/// Maximum distance between a target and a pad of the joint flight [m].
constexpr double max_pad_distance = 300.0;

std::vector<AlignedBox3d> unknown_boxes(std::span<const DistrictTarget> targets) {
  std::vector<AlignedBox3d> boxes;
  for (const DistrictTarget& target : targets) boxes.push_back(target.unknown);
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
            const flight::GeodeticPoint& origin, std::span<const DistrictTarget> targets);

  /// Returns the pad of a target's survey: next to the target, or else the nearest pad of the
  /// district.
  std::optional<Vector3d> find_pad(std::size_t target, double top);

  /// Returns the pads given by the district. Otherwise selects pads of the target surveys until no
  /// target is farther than 300 m from a pad. The first is the one nearest to the centre; then the
  /// pads of the farthest targets are added.
  std::vector<Vector3d> find_flight_pads() const;

 private:
  void read_configured_pads(const DistrictFile& district, const flight::GeodeticPoint& origin);

  std::span<const DistrictTarget> targets_;
  wizard::PadSearch search_;
  std::vector<Vector3d> configured_pads_;
  std::vector<std::optional<Vector3d>> own_;  ///< pads of the target surveys, by target
};

PadChoice::PadChoice(const DistrictFile& district, const flight::FlightOptions& draft,
                     const flight::GeodeticPoint& origin, std::span<const DistrictTarget> targets)
    : targets_(targets), search_(draft, unknown_boxes(targets)), own_(targets.size()) {
  read_configured_pads(district, origin);
}

void PadChoice::read_configured_pads(const DistrictFile& district,
                                     const flight::GeodeticPoint& origin) {
  const flight::LocalFrame frame(origin);
  double top = 0.0;
  for (const DistrictTarget& target : targets_) top = std::max(top, target.unknown.max().z());
  for (const wizard::Click& click : district.pads) {
    const Vector3d position =
        frame.to_local({click.latitude_deg, click.longitude_deg, origin.height});
    const auto pad = search_.at(position.head<2>());
    if (!pad || search_.climb_clearance(*pad, top, 1.0) <= 0.0) {
      throw Error(ErrorKind::bad_config,
                  fmt::format("{}: key pads: the position {:.7f},{:.7f} must be on free, level and "
                              "even ground outside the surveyed objects; use another position",
                              district.file.string(), click.latitude_deg, click.longitude_deg));
    }
    configured_pads_.push_back(*pad);
  }
}

std::optional<Vector3d> PadChoice::find_pad(std::size_t target, double top) {
  const AlignedBox3d& unknown = targets_[target].unknown;
  own_[target] = search_.find_pad_beside(unknown, top);
  if (own_[target] || configured_pads_.empty()) return own_[target];
  return *std::ranges::min_element(configured_pads_, {},
                                   [&](const Vector3d& pad) { return distance(pad, unknown); });
}

std::vector<Vector3d> PadChoice::find_flight_pads() const {
  if (!configured_pads_.empty()) return configured_pads_;
  AlignedBox3d all;
  for (const DistrictTarget& target : targets_) all.extend(target.unknown);
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
    double farthest = max_pad_distance;
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
  std::string make_title(const std::string& id, std::size_t members) {
    constexpr std::size_t max = 60;
    std::string title;
    for (const char c : id.substr(0, max)) {
      const bool is_plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') ||
                            (c >= 'A' && c <= 'Z') || c == '-' || c == '_' || c == '.';
      title += is_plain ? c : '_';
    }
    if (title.empty() || title[0] == '.') title = "_" + title;
    if (members > 1) title += "_and_" + std::to_string(members - 1);
    const std::size_t times = ++configured_pads_[title];
    return times == 1 ? title : make_title(title + "-" + std::to_string(times), 1);
  }

 private:
  std::map<std::string, std::size_t> configured_pads_;
};

/// Prepares one district. Its members are the results of the preparation steps.
class Preparer {
 public:
  Preparer(const DistrictFile& district, fs::path out, const ReportProgress& report_progress)
      : district_(district), out_(std::move(out)), report_progress_(report_progress) {}

  DistrictPlan run(std::string content_checksum) {
    report_progress_("reading " + district_.request.map.filename().string());
    // Opened first, because file paths in missions are relative to this folder.
    geometry::OutputFolder folder(out_);
    read_files();
    split_obstacles();
    group();
    place_pads();
    district_plan_.content_checksum = std::move(content_checksum);
    write_missions();
    write_flights(folder);
    folder.write(district_plan_name, district_plan_json(district_plan_));
    folder.commit();
    return std::move(district_plan_);
  }

 private:
  MissionValues basics(const fs::path& file) const {
    return {.file = file,
            .command = "skycap district",
            .vehicle = district_.request.vehicle,
            .sources = {},
            .origin = chosen_.origin,
            .origin_is = "the centre of the district's targets",
            .unknown = {}};
  }

  bool has_terrain() const { return district_.request.terrain.has_value(); }

  void read_files() {
    const site_data::ReadOnce once;
    files_ = wizard::collect_files(district_.request);
    chosen_ = choose_targets(district_, files_);
    draft_ = read_draft();
  }

  /// Reads all objects of the input files in the district frame.
  config::MissionSetup read_draft() const {
    MissionValues values = basics(out_ / "all.yaml");
    values.sources =
        wizard::select_sources(files_, chosen_.are_all ? std::vector<std::string>() : chosen_.ids);
    const AlignedBox3d somewhere(Vector3d::Zero(), Vector3d::Ones());
    const std::string text =
        mission_text(wizard::values_for(values, somewhere, 0.0, has_terrain()));
    return config::parse_mission(text, values.file.string(), district_.set);
  }

  /// Divides the obstacles into individual objects, written for each target, and files referenced
  /// by every mission.
  void split_obstacles() {
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
      DistrictTarget target{.title = titles.make_title((*targets_)[first].id, group.size()),
                            .ids = {},
                            .outlines = {},
                            .box = box_around(*targets_, group),
                            .unknown = {},
                            .rejection_reason = {}};
      const fs::path file = out_ / missions_folder / (target.title + ".yaml");
      MissionValues values =
          wizard::values_for(basics(file), target.box, target_error_, has_terrain());
      // The coverage and view distances of a target are determined by its objects, not by its
      // group.
      values.registration_distance = values.view_distance = 0.0;
      for (const std::size_t i : group) {
        const Object& object = (*targets_)[i];
        target.ids.push_back(object.id);
        for (Ring& ring : compute_outline(object.mesh)) target.outlines.push_back(std::move(ring));
        const MissionValues own = wizard::values_for(
            basics(file), geometry::bounding_box(object.mesh), target_error_, has_terrain());
        values.registration_distance =
            std::max(values.registration_distance, own.registration_distance);
        values.view_distance = std::max(values.view_distance, own.view_distance);
      }
      values.ground = has_terrain() ? std::round(100.0 * target.box.min().z()) / 100.0 : 0.0;
      values.clearance = draft_.flight().clearance;
      target.unknown = values.unknown;
      district_plan_.targets.push_back(std::move(target));
      values_.push_back(std::move(values));
      groups_.push_back(group);
    }
  }

  void place_pads() {
    report_progress_(
        fmt::format("searching for take-off points next to {} targets", values_.size()));
    PadChoice choice(district_, draft_.flight(), chosen_.origin, district_plan_.targets);
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const auto pad = choice.find_pad(i, wizard::compute_max_climb_altitude(values_[i]));
      if (!pad) {
        district_plan_.targets[i].rejection_reason =
            "no free, level and even take-off point within 100 m of the target; set pads";
        continue;
      }
      district_plan_.targets[i].pad = *pad;
      values_[i] = with_pad(std::move(values_[i]), *pad);
    }
    district_plan_.pads = choice.find_flight_pads();
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
  std::vector<AlignedBox3d> neighbour_boxes(std::size_t target) const {
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
    report_progress_(fmt::format("writing {} missions", values_.size()));
    geometry::OutputFolder missions(out_ / missions_folder), sites(out_ / sites_folder);
    missions.replace([](std::string_view name) { return name.ends_with(".yaml"); });
    sites.replace([](std::string_view name) { return name.ends_with(".city.json"); });
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const DistrictTarget& target = district_plan_.targets[i];
      if (!target.rejection_reason.empty()) continue;
      MissionValues& values = values_[i];
      const std::string city = target.title + ".city.json";
      sites.write(city, city_near(values.fence, groups_[i]));
      values.sources = sources_in(out_ / sites_folder / city, target.ids);
      values.sees_neighbours = true;
      values.extra_unknown_boxes = neighbour_boxes(i);
      missions.write(target.title + ".yaml", mission_text(values));
    }
    sites.commit();
    missions.commit();
  }

  void write_flights(geometry::OutputFolder& folder) {
    if (district_plan_.pads.empty()) return;
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
      for (const std::string& id : district_plan_.targets[i].ids) ids.push_back(id);
    }
    names.insert(ids.begin(), ids.end());
    for (const Vector3d& pad : district_plan_.pads) {
      values.fence.extend(wizard::with_pad(values, pad).fence);
    }
    values.clearance = draft_.flight().clearance;
    for (const std::size_t i : things_near(values.fence)) {
      if (names.contains(things_[i].id)) continue;
      for (Ring& ring : compute_outline(things_[i].mesh)) {
        district_plan_.neighbours.push_back(std::move(ring));
      }
    }
    values.sources = sources_in(out_ / city_name, ids);
    folder.write(city_name, city_near(values.fence, all));
    geometry::OutputFolder flights(out_ / flights_folder);
    flights.replace([](std::string_view name) { return !name.starts_with("."); });
    for (std::size_t pad = 0; pad < district_plan_.pads.size(); ++pad) {
      values.file = out_ / flights_folder / (pad_name(pad) + ".yaml");
      values.pad = district_plan_.pads[pad];
      flights.write(pad_name(pad) + ".yaml", mission_text(values));
    }
    flights.commit();
  }

  const DistrictFile& district_;
  fs::path out_;
  const ReportProgress& report_progress_;
  std::vector<Source> files_, rest_;
  ChosenTargets chosen_;
  config::MissionSetup draft_;
  const std::vector<Object>* targets_ = nullptr;
  double target_error_ = 0.0, thing_error_ = 0.0;
  std::vector<Object> things_;  ///< obstacles with unique names
  std::vector<AlignedBox3d> thing_boxes_;
  std::vector<Group> groups_;
  std::vector<MissionValues> values_;
  DistrictPlan district_plan_;
};

}  // namespace

std::string pad_name(std::size_t pad) { return "pad_" + std::to_string(pad + 1); }

std::string district_plan_json(const DistrictPlan& district_plan) {
  Json json{{"digest", district_plan.content_checksum},
            {"pads", to_json(district_plan.pads)},
            {"targets", Json::array()}};
  for (const DistrictTarget& target : district_plan.targets)
    json["targets"].push_back(to_json(target));
  json["neighbours"] = rings_json(district_plan.neighbours);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

DistrictPlan read_district_plan(const fs::path& file) {
  try {
    const Json json = geometry::parse_json<Json>(geometry::read_file(file, geometry::largest_json));
    DistrictPlan district_plan{.content_checksum = json.at("digest"),
                               .pads = {},
                               .targets = {},
                               .neighbours = parse_rings(json.at("neighbours"))};
    for (const Json& pad : json.at("pads")) district_plan.pads.push_back(to_vector(pad));
    for (const Json& target : json.at("targets"))
      district_plan.targets.push_back(parse_target(target));
    return district_plan;
  } catch (const Json::exception& error) {
    throw Error(ErrorKind::bad_file, file.string() + ": is damaged (" + error.what() +
                                         "); remove it and run skycap district to create it again");
  }
}

CampaignFile make_campaign(const DistrictFile& district, const DistrictPlan& district_plan,
                           const fs::path& out) {
  CampaignFile file{.name = district.name,
                    .folder = out / missions_folder,
                    .missions = {},
                    .planners = {district.planner},
                    .seeds = 1,
                    .first_seed = district.seed,
                    .variants = {{"", district.set}},
                    .results = ItemResults::package};
  for (const DistrictTarget& target : district_plan.targets) {
    if (target.rejection_reason.empty()) file.missions.push_back(target.title + ".yaml");
  }
  return file;
}

DistrictPlan prepare(const DistrictFile& district, const fs::path& out,
                     const ReportProgress& report_progress) {
  report_progress("reading the district's files");
  std::string content_checksum = compute_checksum(district);
  const fs::path kept = out / district_plan_name;
  if (fs::exists(kept)) {
    DistrictPlan district_plan = read_district_plan(kept);
    if (district_plan.content_checksum == content_checksum) return district_plan;
  }
  return Preparer(district, out, report_progress).run(std::move(content_checksum));
}

}  // namespace skycap::missions::batch
