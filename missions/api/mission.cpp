#include "missions/api/mission.h"

#include <utility>

#include "missions/api/mission_contents.h"
#include "missions/config/planner_factory.h"
#include "missions/config/resolved_mission.h"
#include "missions/evaluation/survey_scene.h"

namespace skycap::missions::api {
namespace {

std::vector<config::KeyOverride> overrides_of(const std::vector<Setting>& settings) {
  std::vector<config::KeyOverride> overrides;
  for (const Setting& setting : settings) {
    overrides.push_back({"setting " + setting.key, setting.key, setting.value});
  }
  return overrides;
}

}  // namespace

Mission Mission::load(const std::filesystem::path& file, const std::vector<Setting>& settings) {
  return Mission(std::make_shared<const Contents>(
      Contents{config::read_mission(file, overrides_of(settings)), file.parent_path()}));
}

Mission Mission::parse(const std::string& text, const std::string& name,
                       const std::vector<Setting>& settings) {
  return Mission(std::make_shared<const Contents>(
      Contents{config::parse_mission(text, name, overrides_of(settings)),
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
  return evaluation::placed_model(contents_->mission, contents_->folder);
}

std::unique_ptr<survey::Planner> Mission::planner() const {
  return config::make_planner(contents_->mission, contents_->mission.threads);
}

}  // namespace skycap::missions::api
