// Plans a survey with a custom sensor, either a driver or a simulator: here, rays that hit a ball.
// Prints each view. Exit code 0 when the survey is complete.
#include <cmath>
#include <cstdio>

#include <skycap/survey/surfel_planner.h>
#include <skycap/survey/survey_loop.h>

using Eigen::Vector3d;
using namespace skycap;

constexpr double ball_radius = 1.0;  // [m], around the origin

geometry::Scan measure(const geometry::Camera& camera, const geometry::View& view) {
  geometry::Scan scan;
  scan.world_from_sensor = geometry::camera_pose(view);
  for (int row = 0; row < camera.height(); ++row) {
    for (int column = 0; column < camera.width(); ++column) {
      const Vector3d ray =
          (scan.world_from_sensor.linear() * camera.ray({column, row})).normalized();
      const double halfway = -view.position.dot(ray);
      const double gap = (view.position + halfway * ray).norm();
      if (halfway < 0.0 || gap > ball_radius) continue;  // no return
      const double distance = halfway - std::sqrt(ball_radius * ball_radius - gap * gap);
      scan.points.push_back((view.position + distance * ray).cast<float>());
      scan.pixels.push_back(static_cast<std::uint32_t>(row * camera.width() + column));
    }
  }
  return scan;
}

int main() {
  const geometry::Camera camera({.width = 160, .height = 120});
  survey::surfel::SurfelPlanner planner({.coverage_radius = 0.05}, camera);
  const survey::SurveyCallbacks callbacks{
      .sense = [&](const geometry::View& view, geometry::Scan) { return measure(camera, view); },
      .report =
          [](const survey::SurveyedView& surveyed, const geometry::Scan&) {
            const Vector3d& position = surveyed.view.position;
            std::printf("view from %6.2f %6.2f %6.2f, %zu points so far\n", position.x(),
                        position.y(), position.z(), surveyed.points);
          }};
  const survey::SurveyResult result = survey::run_survey(
      planner, geometry::look_at({3.0, 0.0, 1.0}, Vector3d::Zero()), {.max_views = 40}, callbacks);
  std::printf("%zu views, %zu points, %.1f %% estimated coverage\n", result.views.size(),
              planner.cloud().size(), 100.0 * planner.predicted_coverage());
  return result.stop_reason == survey::StopReason::complete ? 0 : 1;
}
