#include "missions/batch/district/preparation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "flight/route/route.h"
#include "geometry/error.h"
#include "geometry/io/output_folder.h"
#include "missions/batch/district/city_text.h"
#include "missions/batch/district/pad_choice.h"
#include "missions/batch/district/targets.h"
#include "missions/config/resolve.h"
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
using wizard::MissionValues;

constexpr const char* sites_folder = "sites";
constexpr const char* city_name = "district.city.json";

AlignedBox3d box_around(const std::vector<Object>& objects, const Group& group) {
  AlignedBox3d box;
  for (const std::size_t i : group) box.extend(geometry::bounding_box(objects[i].mesh));
  return box;
}

/// A name of a file, and of a mission, for a thing whatever it is called; none is given twice.
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

/// Prepares one district; the members are what its steps find.
class Preparer {
 public:
  Preparer(const DistrictFile& district, fs::path out, const Tell& tell)
      : district_(district), out_(std::move(out)), tell_(tell) {}

  Prepared run(std::string digest) {
    tell_("reading " + district_.wishes.map.filename().string());
    // First, since missions name their files as seen from there.
    geometry::OutputFolder folder(out_);
    files_ = wizard::files_of(district_.wishes);
    chosen_ = choose_targets(district_, files_);
    draft_ = read_draft();
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

  /// All that the files hold, in the district's frame.
  config::MissionSetup read_draft() const {
    MissionValues values = basics(out_ / "all.yaml");
    values.sources =
        wizard::sources_of(files_, chosen_.are_all ? std::vector<std::string>() : chosen_.ids);
    const AlignedBox3d somewhere(Vector3d::Zero(), Vector3d::Ones());
    const std::string text =
        mission_text(wizard::values_for(values, somewhere, 0.0, has_terrain()));
    return config::parse_mission(text, values.file.string(), district_.set);
  }

  /// Splits what is in the way into things, which are cut out for each target, and files that each
  /// mission names.
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
      // Whatever else is beside it, a thing is looked at as closely as by itself.
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

  /// So far from a fence nothing that it encloses comes near to, nor is it reported to.
  double beyond_fence() const {
    return draft_.flight().clearance + flight::reported_surplus + thing_error_;
  }

  /// A model of the targets and of all that stands within the fence or near it.
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
    // In thousandths, and no less than it is, rounding of the file included.
    const double error = std::max(thing_error_, target_error_) + 2.0 * city_step;
    source.uncertainty = std::ceil(1000.0 * error) / 1000.0;
    std::vector<Source> sources{source, source};
    sources[0].role = Role::target;
    sources[0].select.ids = ids;
    sources.insert(sources.end(), rest_.begin(), rest_.end());
    return sources;
  }

  /// The boxes of other targets as far as the sensor of one reaches from its own.
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
  std::vector<Object> things_;  ///< in the way, with names of their own
  std::vector<AlignedBox3d> thing_boxes_;
  std::vector<Group> groups_;
  std::vector<MissionValues> values_;
  Prepared prepared_;
};

}  // namespace

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
