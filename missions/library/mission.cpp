#include "missions/library/mission.h"

#include <utility>

#include "missions/derived/planner_factory.h"
#include "missions/derived/resolved_mission.h"
#include "missions/library/mission_contents.h"
#include "missions/scene/survey_scene.h"

namespace skycap::missions::library {
namespace {

std::vector<file::KeyOverride> overrides_of(const std::vector<Setting>& settings) {
  std::vector<file::KeyOverride> overrides;
  for (const Setting& setting : settings) {
    overrides.push_back({"setting " + setting.key, setting.key, setting.value});
  }
  return overrides;
}

}  // namespace

Mission Mission::load(const std::filesystem::path& file, const std::vector<Setting>& settings) {
  return Mission(std::make_shared<const Contents>(
      Contents{derived::read_mission(file, overrides_of(settings)), file.parent_path()}));
}

Mission Mission::parse(const std::string& text, const std::string& name,
                       const std::vector<Setting>& settings) {
  return Mission(std::make_shared<const Contents>(
      Contents{derived::parse_mission(text, name, overrides_of(settings)),
               std::filesystem::path(name).parent_path()}));
}

const std::string& Mission::name() const { return contents_->mission.name; }

std::uint64_t Mission::seed() const { return contents_->mission.seed; }

const geometry::CameraConfig& Mission::camera() const {
  return contents_->mission.sensor.camera.camera;
}

double Mission::coverage_distance() const {
  return contents_->mission.evaluation.registration_distance;
}

geometry::Mesh Mission::model() const {
  return scene::placed_model(contents_->mission, contents_->folder);
}

std::unique_ptr<survey::Planner> Mission::planner() const {
  return derived::make_planner(contents_->mission, contents_->mission.threads);
}

}  // namespace skycap::missions::library
