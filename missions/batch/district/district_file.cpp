#include "missions/batch/district/district_file.h"

#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "missions/batch/benchmark/methods.h"
#include "missions/batch/campaign/campaign_file.h"
#include "missions/config/former_names.h"
#include "missions/support/yaml_section.h"

namespace skycap::missions::batch {
namespace {

namespace fs = std::filesystem;
using support::YamlSection;

// [byte]; sufficient for 100,000 names.
constexpr std::size_t largest_district_file = std::size_t{16} << 20;
constexpr double farthest = 50e3;  // maximum distance of any object from the site [m]

/// Reads the keys of a district in the order of the manual.
class DistrictReader {
 public:
  DistrictReader(const support::YamlNode& root, const std::string& name)
      : root_(root, "", name), file_(name) {}

  DistrictFile read() {
    district_.file = file_;
    district_.name = read_name(root_, file_);
    read_files();
    if (auto targets = root_.section("targets")) read_targets(*targets);
    district_.merge_distance = bounded("merge_distance", 0.5, 0.0, 100.0);
    district_.pads = clicks(root_, "pads");
    std::string& vehicle = district_.request.vehicle;
    vehicle = root_.text("vehicle", "generic");
    // The value is a preset name, or a path if it ends in .yaml.
    if (fs::path(vehicle).extension() == ".yaml") vehicle = resolve_path(vehicle).string();
    read_planner();
    const int seed = root_.integer("seed", 1);
    if (seed < 0) root_.fail_at("seed", fmt::format("is {}; it must be 0 or more", seed));
    district_.seed = static_cast<std::uint64_t>(seed);
    read_changes();
    root_.finish();
    return district_;
  }

 private:
  fs::path resolve_path(const std::string& path) const {
    return fs::path(file_).parent_path() / path;
  }

  void read_files() {
    wizard::SiteRequest& request = district_.request;
    request.map = resolve_path(root_.text("map"));
    wizard::ImportOptions& import_options = request.import_options;
    import_options.crs = root_.text("crs", "");
    if (root_.has("vertical")) {
      import_options.vertical = root_.choice<site_data::HeightDatum>(
          "vertical", {{"ellipsoid", site_data::HeightDatum::ellipsoid},
                       {"geoid", site_data::HeightDatum::geoid}});
    }
    if (root_.has("base")) import_options.base = bounded("base", 0.0, -1e4, 1e4);
    if (root_.has("height")) import_options.height = bounded("height", 0.0, 0.01, 1e4);
    if (root_.has("terrain")) request.terrain = resolve_path(root_.text("terrain"));
    for (const std::string& path : root_.texts("obstacles")) {
      request.obstacles.push_back(resolve_path(path));
    }
  }

  void read_targets(YamlSection& section) {
    TargetChoice& choice = district_.targets;
    choice.ids = section.texts("id");
    for (const support::YamlEntry& entry : section.entries("attribute")) {
      if (entry.value.kind != support::YamlNode::Kind::scalar) {
        section.fail_at("attribute", "must have a value for each key, such as {street: Am Ring}");
      }
      choice.attributes[entry.key] = entry.value.text;
    }
    choice.within = clicks(section, "within");
    if (section.has("within") && choice.within.size() != 2) {
      section.fail_at("within", fmt::format("has {} positions; list two opposite corners of a box",
                                            choice.within.size()));
    }
    if (section.has("near") != section.has("distance")) {
      section.fail_at(section.has("near") ? "near" : "distance",
                      "requires both near (a position) and distance (metres)");
    }
    if (section.has("near")) {
      choice.near = click(section, "near", section.text("near"));
      choice.distance = section.number("distance");
      section.require_between("distance", choice.distance, 0.0, farthest, "m");
    }
    section.finish();
  }

  void read_planner() {
    district_.planner = root_.text("planner", "skycap");
    if (find_method(district_.planner) != nullptr) return;
    std::string known;
    for (const Method& one : methods()) {
      known += (known.empty() ? "" : ", ") + one.name;
    }
    root_.fail_at("planner", "is " + district_.planner + "; it must be one of " + known);
  }

  void read_changes() {
    static const FollowingKeys following{
        {"name", "seed", "threads", "planner.name", "planner.scene_box", "prior", "scene.",
         "site.latitude_deg", "site.longitude_deg", "site.ellipsoid_height", "site.geofence",
         "flight.vehicle", "flight.vehicles", "flight.takeoff", "flight.rally",
         "flight.unknown_box", "flight.extra_unknown_boxes", "flight.order"},
        "the district's files, targets, pads, vehicle, planner and seed; set those instead"};
    district_.set = key_changes(root_.entries("set"), "set.", file_, following);
  }

  double bounded(const std::string& key, double fallback, double min, double max) {
    const double number = root_.number(key, fallback);
    root_.require_between(key, number, min, max, "m");
    return number;
  }

  static wizard::Click click(YamlSection& section, const std::string& key,
                             const std::string& text) {
    const auto found = wizard::click_in(text);
    if (!found)
      section.fail_at(key, "has " + text + "; it must be " + wizard::click_form + ", in quotes");
    return *found;
  }

  static std::vector<wizard::Click> clicks(YamlSection& section, const std::string& key) {
    std::vector<wizard::Click> found;
    for (const std::string& text : section.texts(key)) found.push_back(click(section, key, text));
    return found;
  }

  YamlSection root_;
  const std::string& file_;
  DistrictFile district_;
};

}  // namespace

DistrictFile parse_district(const std::string& text, const std::string& name) {
  support::YamlNode root = support::parse_map(text, name, "a district");
  config::replace_former_batch_names(root, name);
  return DistrictReader(root, name).read();
}

DistrictFile read_district(const fs::path& file) {
  return parse_district(geometry::read_file(file, largest_district_file), file.string());
}

}  // namespace skycap::missions::batch
