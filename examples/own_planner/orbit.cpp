// Planner that flies one level circle of 12 views around the points measured so far.
#include <cmath>
#include <numbers>
#include <optional>

#include <skycap/survey/own_planner.h>

using skycap::geometry::View;
namespace survey = skycap::survey;

class Orbit final : public survey::OwnPlanner {
 public:
  explicit Orbit(const survey::OwnPlannerTask& task) : distance_(task.view_distance) {}

  std::optional<View> next_view(const skycap::geometry::ScanSpan& scan,
                                const skycap::geometry::PointCloud& cloud) override {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3f& point : cloud.positions) box.extend(point.cast<double>());
    centre_ = box.center();
    if (taken_ == 0) {  // the circle contains the first view
      const Eigen::Vector3d start = scan.sensor_position() - centre_;
      azimuth_ = std::atan2(start.y(), start.x());
      radius_ = distance_ + 0.5 * box.diagonal().norm();
    }
    return next_alternative_view();
  }

  std::optional<View> next_alternative_view() override {
    if (++taken_ >= views) return std::nullopt;
    azimuth_ += 2.0 * std::numbers::pi / views;
    const Eigen::Vector3d outwards(std::cos(azimuth_), std::sin(azimuth_), 0.0);
    return View{centre_ + radius_ * outwards, -outwards};
  }

 private:
  static constexpr int views = 12;
  double distance_, radius_ = 0.0, azimuth_ = 0.0;
  int taken_ = 0;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
};

SKYCAP_OWN_PLANNER(Orbit)
