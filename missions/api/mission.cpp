#include "missions/api/mission.h"

#include <utility>

#include "missions/api/mission_contents.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/survey_scene.h"

namespace skycap::missions::api {
namespace {

std::vector<config::KeyOverride> make_overrides(const std::vector<Setting>& settings) {
  std::vector<config::KeyOverride> overrides;
  for (const Setting& setting : settings) {
    overrides.push_back({"setting " + setting.key, setting.key, setting.value, true});
  }
  return overrides;
}

}  // namespace

Mission Mission::load(const std::filesystem::path& file, const std::vector<Setting>& settings) {
  return Mission(std::make_shared<const Contents>(
      Contents{config::read_mission(file, make_overrides(settings)), file.parent_path()}));
}

Mission Mission::parse(const std::string& text, const std::string& name,
                       const std::vector<Setting>& settings) {
  return Mission(std::make_shared<const Contents>(
      Contents{config::parse_mission(text, name, make_overrides(settings)),
               std::filesystem::path(name).parent_path()}));
}

const std::string& Mission::name() const { return contents_->setup.name; }

std::uint64_t Mission::seed() const { return contents_->setup.run.seed; }

const geometry::CameraConfig& Mission::camera() const {
  return contents_->setup.survey().planner.camera;
}

double Mission::coverage_distance() const {
  return contents_->setup.evaluation().registration_distance;
}

geometry::Mesh Mission::model() const {
  return evaluation::placed_model(contents_->setup.scene(), contents_->folder);
}

std::unique_ptr<survey::Planner> Mission::planner() const {
  const session::RunOptions& run = contents_->setup.run;
  return survey::make_planner(contents_->setup.survey().planner, {run.seed, run.threads, {}});
}

}  // namespace skycap::missions::api
