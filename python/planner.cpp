// Planner for a sensor loop: receives scans and returns the next view.
#include "survey/planner.h"

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>

#include <pybind11/stl.h>

#include "geometry/points/usable_scan.h"
#include "missions/api/mission.h"
#include "python/arrays.h"
#include "python/bindings.h"

namespace skycap::python {
namespace {

using geometry::View;
using missions::api::Mission;
using survey::PlanningStep;
using Lock = std::unique_lock<std::mutex>;

/// Planner with a lock, which allows one thread at a time and keeps the points in place while
/// arrays refer to them.
struct GuardedPlanner {
  explicit GuardedPlanner(const Mission& mission)
      : camera(mission.camera()), planner(mission.planner()) {}

  geometry::CameraConfig camera;
  std::unique_ptr<survey::Planner> planner;
  std::mutex in_use;
  std::atomic<int> clouds_shown = 0;
};

/// Reference of a Python array to the kept points. While it exists, the planner does not process
/// scans.
class ShownCloud {
 public:
  explicit ShownCloud(std::shared_ptr<GuardedPlanner> planner) : planner_(std::move(planner)) {
    ++planner_->clouds_shown;
  }
  ~ShownCloud() { --planner_->clouds_shown; }
  ShownCloud(const ShownCloud&) = delete;
  ShownCloud& operator=(const ShownCloud&) = delete;

  const geometry::PointCloud& cloud() const { return planner_->planner->cloud(); }

 private:
  std::shared_ptr<GuardedPlanner> planner_;
};

class Planner {
 public:
  explicit Planner(const Mission& mission) : guarded_(std::make_shared<GuardedPlanner>(mission)) {}

  std::optional<View> next_view(const Array<float>& points, const Array<double>& world_from_sensor,
                                const std::optional<py::object>& pixels) {
    geometry::ScanSpan scan;
    scan.points = points_in(points, "points");
    scan.world_from_sensor = pose_in(world_from_sensor, "world_from_sensor");
    Array<std::uint32_t> indices;
    if (pixels) {
      indices = indices_in(*pixels, "pixels");
      if (indices.ndim() != 1) throw py::value_error("pixels must have shape (N,)");
      scan.pixels = {indices.data(), static_cast<std::size_t>(indices.size())};
    }
    py::gil_scoped_release others_go_on;
    const Lock lock(guarded_->in_use);
    require_none_shown();
    geometry::require_usable(scan, guarded_->camera);
    return guarded_->planner->next_view(scan);
  }

  std::optional<View> next_alternative_view() {
    py::gil_scoped_release others_go_on;
    const Lock lock(guarded_->in_use);
    require_none_shown();
    return guarded_->planner->next_alternative_view();
  }

  std::unique_ptr<ShownCloud> cloud() const {
    py::gil_scoped_release others_go_on;
    const Lock lock(guarded_->in_use);
    return std::make_unique<ShownCloud>(guarded_);
  }

  PlanningStep last_step() const {
    py::gil_scoped_release others_go_on;
    const Lock lock(guarded_->in_use);
    return guarded_->planner->last_step();
  }

 private:
  void require_none_shown() const {
    if (guarded_->clouds_shown == 0) return;
    py::gil_scoped_acquire to_raise;
    PyErr_SetString(
        PyExc_BufferError,
        "arrays of cloud() are still in use and would become invalid; delete them or keep copies");
    throw py::error_already_set();
  }

  std::shared_ptr<GuardedPlanner> guarded_;
};

py::array_t<std::uint32_t> collect_views(const py::object& self,
                                         const geometry::PointCloud& cloud) {
  return make_array_view(cloud.views.data(), static_cast<py::ssize_t>(cloud.views.size()), 0, self);
}

py::dict times_to_dict(const PlanningStep& step) {
  py::dict times;
  for (const survey::PartTime& time : step.times) times[py::str(time.part)] = time.seconds;
  return times;
}

void bind_step(py::module_& module) {
  py::class_<PlanningStep>(module, "PlanningStep", py::is_final(),
                           "Statistics of the planner's last step.")
      .def_readonly("points_new", &PlanningStep::points_new, "Number of points kept from the scan.")
      .def_readonly("frontiers", &PlanningStep::frontiers, "Number of frontiers.")
      .def_readonly("frontiers_resolved", &PlanningStep::frontiers_resolved,
                    "Number of frontiers resolved by this scan.")
      .def_readonly("target_resolved", &PlanningStep::target_resolved,
                    "Whether the target of the view was resolved; None if the view had no target.")
      .def_property_readonly(
          "times", &times_to_dict,
          "Time of each part in seconds, in order; the sum is the planning time.");
}

void bind_clouds(py::module_& module) {
  const char* xyz = "World frame, in metres: float32, shape (N, 3); read-only, not copied.";
  const char* views =
      "0-based index of the scan that measured each point: uint32, shape (N,); read-only.";
  py::class_<ShownCloud>(
      module, "PlannerCloud", py::is_final(),
      "The measurements kept by a planner. While this object or one of its arrays is alive, the\n"
      "planner does not accept scans.")
      .def_property_readonly(
          "xyz",
          [](const py::object& self) {
            return make_array_view(self.cast<const ShownCloud&>().cloud().positions, self);
          },
          xyz)
      .def_property_readonly(
          "views",
          [](const py::object& self) {
            return collect_views(self, self.cast<const ShownCloud&>().cloud());
          },
          views)
      .def("__len__", [](const ShownCloud& shown) { return shown.cloud().size(); });
  py::class_<geometry::PointCloud>(module, "PointCloud", py::is_final(), "The points of a survey.")
      .def_property_readonly(
          "xyz",
          [](const py::object& self) {
            return make_array_view(self.cast<const geometry::PointCloud&>().positions, self);
          },
          xyz)
      .def_property_readonly(
          "views",
          [](const py::object& self) {
            return collect_views(self, self.cast<const geometry::PointCloud&>());
          },
          views)
      .def("__len__", &geometry::PointCloud::size);
}

}  // namespace

void bind_planner(py::module_& module) {
  bind_step(module);
  bind_clouds(module);
  py::class_<Planner>(
      module, "Planner", py::is_final(),
      "View planner: Planner(mission) creates the planner of the mission, which accepts scans "
      "of\na real or simulated sensor and proposes the next view. May be used from any thread, "
      "one\ncall at a time; other Python threads continue to run.")
      .def(py::init<const Mission&>(), py::arg("mission"), py::call_guard<py::gil_scoped_release>())
      .def(
          "next_view", &Planner::next_view, py::arg("points"), py::arg("world_from_sensor"),
          py::arg("pixels") = py::none(),
          "next_view($self, points, world_from_sensor, pixels=None)\n--\n\nAdds a scan and "
          "proposes the next view; None when the survey is complete.\n\npoints: the returns in the "
          "world frame, in metres, shape (N, 3); a C-contiguous\nfloat32 array is not copied, "
          "others are converted.\nworld_from_sensor: the pose of the optical frame (x right, y "
          "down, z forward) during\nthe measurement, shape (4, 4); it may differ from the proposed "
          "view.\npixels: row * width + column in the mission's camera of each point, uint32, "
          "shape\n(N,), strictly ascending; all others are no-return pixels. None: the sensor has "
          "no\nimage.\n\nRaises Error for an unusable scan, and BufferError while arrays of "
          "cloud() are alive.\nOther threads must not modify the arrays during the call.")
      .def("replacement_view", &Planner::next_alternative_view,
           "replacement_view($self)\n"
           "--\n"
           "\n"
           "Another view instead of the last one, which is unreachable; None if no views are left.")
      .def(
          "next_view_instead",
          [](Planner& planner) {
            warn_deprecated_name("next_view_instead", "replacement_view");
            return planner.next_alternative_view();
          },
          "next_view_instead($self)\n--\n\nFormer name of replacement_view.")
      .def("cloud", &Planner::cloud,
           "cloud($self)\n"
           "--\n"
           "\n"
           "The measurements kept so far, as a PlannerCloud, without a copy.")
      .def_property_readonly("last_step", &Planner::last_step,
                             "Statistics of the last next_view().");
}

}  // namespace skycap::python
