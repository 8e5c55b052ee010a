#include "missions/batch/campaign/manifest.h"

#include <algorithm>

#include <nlohmann/json.hpp>

namespace skycap::missions::batch {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* own_planner = "own";  // no contestant has this name

const std::string& named(const std::string& planner) {
  static const std::string own = own_planner;
  return planner.empty() ? own : planner;
}

}  // namespace

std::filesystem::path ManifestLine::folder() const {
  return std::filesystem::path("items") / entry.title / named(entry.planner) /
         ("seed_" + std::to_string(seed));
}

std::string ManifestLine::json() const {
  Json set = Json::object();
  for (const auto& [origin, path, value] : entry.variant->changes) set[path] = value;
  const Json line{{"item", number},
                  {"mission", entry.mission},
                  {"variant", entry.variant->name},
                  {"planner", named(entry.planner)},
                  {"seed", seed},
                  {"set", set},
                  {"folder", folder().generic_string()}};
  return line.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::size_t Manifest::planners() const { return std::max<std::size_t>(1, file_.planners.size()); }

std::size_t Manifest::entries() const {
  return file_.missions.size() * file_.variants.size() * planners();
}

ManifestEntry Manifest::entry(std::size_t index) const {
  const std::size_t of_mission = file_.variants.size() * planners();
  const std::string& mission = file_.missions[index / of_mission];
  const Variant& variant = file_.variants[index % of_mission / planners()];
  const std::string title = mission_title(mission);
  return {.mission = mission,
          .title = variant.name.empty() ? title : title + "/" + variant.name,
          .planner = file_.planners.empty() ? "" : file_.planners[index % planners()],
          .variant = &variant};
}

ManifestLine Manifest::line(std::size_t number) const {
  return {number, entry(number % entries()), file_.first_seed + number / entries()};
}

std::string Manifest::text() const {
  std::string lines;
  for (std::size_t number = 0; number < size(); ++number) lines += line(number).json() + "\n";
  return lines;
}

}  // namespace skycap::missions::batch
