// The planner in the hands of a sensor loop: scans in, next view out.
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

/// One thread at a time; the points that arrays look at stay where they are.
struct GuardedPlanner {
  explicit GuardedPlanner(const Mission& mission)
      : camera(mission.camera()), planner(mission.planner()) {}

  geometry::CameraConfig camera;
  std::unique_ptr<survey::Planner> planner;
  std::mutex in_use;
  std::atomic<int> clouds_shown = 0;
};

/// What Python holds of the kept points. While it lives, the planner takes in nothing.
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
      if (indices.ndim() != 1) throw py::value_error("pixels has not one axis; give shape (N,)");
      scan.pixels = {indices.data(), static_cast<std::size_t>(indices.size())};
    }
    py::gil_scoped_release others_go_on;
    const Lock lock(guarded_->in_use);
    require_none_shown();
    geometry::require_usable(scan, guarded_->camera);
    return guarded_->planner->next_view(scan);
  }

  std::optional<View> next_view_instead() {
    py::gil_scoped_release others_go_on;
    const Lock lock(guarded_->in_use);
    require_none_shown();
    return guarded_->planner->next_view_instead();
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
    PyErr_SetString(PyExc_BufferError,
                    "what cloud() gave is still in use, and its arrays would move; delete it and "
                    "them, or keep copies");
    throw py::error_already_set();
  }

  std::shared_ptr<GuardedPlanner> guarded_;
};

py::array_t<std::uint32_t> views_of(const py::object& self, const geometry::PointCloud& cloud) {
  return view_of(cloud.views.data(), static_cast<py::ssize_t>(cloud.views.size()), 0, self);
}

py::dict times_of(const PlanningStep& step) {
  py::dict times;
  for (const survey::PartTime& time : step.times) times[py::str(time.part)] = time.seconds;
  return times;
}

void bind_step(py::module_& module) {
  py::class_<PlanningStep>(module, "PlanningStep", "What a planner did with the last scan.")
      .def_readonly("points_new", &PlanningStep::points_new, "Points kept of the scan.")
      .def_readonly("frontiers", &PlanningStep::frontiers, "Places still worth looking at.")
      .def_readonly("frontiers_resolved", &PlanningStep::frontiers_resolved,
                    "Places that are no longer worth it because of this scan.")
      .def_readonly("target_resolved", &PlanningStep::target_resolved,
                    "Whether the place that the view was for is among them; None: it was for none.")
      .def_property_readonly("times", &times_of,
                             "Seconds that each part took, in order; their sum is the planning.");
}

void bind_clouds(py::module_& module) {
  const char* xyz = "World frame, in metres: float32, shape (N, 3); read-only, not copied.";
  const char* views = "The scan, from 0, that each point is of: uint32, shape (N,); read-only.";
  py::class_<ShownCloud>(module, "KeptPoints",
                         "The measurements that a planner keeps. While this or an array of it is\n"
                         "alive, the planner takes in no scan.")
      .def_property_readonly(
          "xyz",
          [](const py::object& self) {
            return view_of(self.cast<const ShownCloud&>().cloud().positions, self);
          },
          xyz)
      .def_property_readonly(
          "views",
          [](const py::object& self) {
            return views_of(self, self.cast<const ShownCloud&>().cloud());
          },
          views)
      .def("__len__", [](const ShownCloud& shown) { return shown.cloud().size(); });
  py::class_<geometry::PointCloud>(module, "PointCloud", "The points of a survey.")
      .def_property_readonly(
          "xyz",
          [](const py::object& self) {
            return view_of(self.cast<const geometry::PointCloud&>().positions, self);
          },
          xyz)
      .def_property_readonly(
          "views",
          [](const py::object& self) {
            return views_of(self, self.cast<const geometry::PointCloud&>());
          },
          views)
      .def("__len__", &geometry::PointCloud::size);
}

}  // namespace

void bind_planner(py::module_& module) {
  bind_step(module);
  bind_clouds(module);
  py::class_<Planner>(
      module, "Planner",
      "Takes what a sensor measured and says where to look next: Planner(mission), the planner\n"
      "that the mission names. It is no matter whether the sensor is real. May be used from any\n"
      "thread, one call at a time; other threads of Python go on meanwhile.")
      .def(py::init<const Mission&>(), py::arg("mission"), py::call_guard<py::gil_scoped_release>())
      .def("next_view", &Planner::next_view, py::arg("points"), py::arg("world_from_sensor"),
           py::arg("pixels") = py::none(),
           "next_view($self, points, world_from_sensor, pixels=None)\n--\n\n"
           "Takes in a scan and proposes the next view; None when the survey is complete.\n\n"
           "points: the returns in the world frame, in metres, shape (N, 3); a C-contiguous\n"
           "float32 array is looked at where it lies, others are converted.\n"
           "world_from_sensor: the pose of the optical frame (x right, y down, z forward) they\n"
           "were measured from, shape (4, 4); it need not be the one that was proposed.\n"
           "pixels: row * width + column in the mission's camera of each point, uint32, shape\n"
           "(N,), strictly ascending; the others gave no return. None: the sensor has no image.\n\n"
           "Raises Error for a scan that cannot be worked with, and BufferError while arrays of\n"
           "cloud() are alive. Other threads must leave the arrays as they are.")
      .def("next_view_instead", &Planner::next_view_instead,
           "next_view_instead($self)\n--\n\n"
           "Another view in place of the last one, which cannot be reached; None when there is\n"
           "none left.")
      .def("cloud", &Planner::cloud,
           "cloud($self)\n--\n\nThe measurements kept so far, as KeptPoints: nothing is copied.")
      .def_property_readonly("last_step", &Planner::last_step, "What the last next_view() did.");
}

}  // namespace skycap::python
