// Views and cameras.
#include <string>

#include "geometry/pose/camera.h"
#include "geometry/pose/pose.h"
#include "python/arrays.h"
#include "python/bindings.h"

namespace skycap::python {
namespace {

using geometry::CameraConfig;
using geometry::View;

View view_from(const Array<double>& position, const Array<double>& direction) {
  const Eigen::Vector3d towards = vector_in(direction, "direction");
  if (!(towards.norm() > 0.0)) {
    throw py::value_error("direction must not have zero length");
  }
  return {vector_in(position, "position"), towards.normalized()};
}

View look_at(const Array<double>& position, const Array<double>& target) {
  const Eigen::Vector3d from = vector_in(position, "position"), to = vector_in(target, "target");
  if (from == to) throw py::value_error("position and target must differ");
  return geometry::look_at(from, to);
}

std::string to_string(const View& view) {
  const auto list = [](const Eigen::Vector3d& vector) {
    return py::str(to_array(vector).attr("tolist")()).cast<std::string>();
  };
  return "View(position=" + list(view.position) + ", direction=" + list(view.direction) + ")";
}

py::array_t<double> make_rays(const CameraConfig& config) {
  const geometry::Camera camera(config);
  py::array_t<double> rays({camera.height(), camera.width(), 3});
  auto* next = rays.mutable_data();
  for (int row = 0; row < camera.height(); ++row) {
    for (int column = 0; column < camera.width(); ++column, next += 3) {
      Eigen::Map<Eigen::Vector3d>{next} = camera.ray({column, row});
    }
  }
  return rays;
}

void bind_camera(py::module_& module) {
  py::class_<CameraConfig>(module, "Camera", py::is_final(),
                           "A pinhole depth camera. Optical frame: x right, y down, z forward, in "
                           "metres; pixel (0, 0)\nis the centre of the top-left pixel.")
      .def_readonly("width", &CameraConfig::width, "Image width, in pixels.")
      .def_readonly("height", &CameraConfig::height, "Image height, in pixels.")
      .def_readonly("horizontal_fov", &CameraConfig::horizontal_fov,
                    "Full horizontal field of view, in radians.")
      .def_readonly("vertical_fov", &CameraConfig::vertical_fov,
                    "Full vertical field of view, in radians.")
      .def_readonly("min_range", &CameraConfig::min_range, "Minimum depth along z, in metres.")
      .def_readonly("max_range", &CameraConfig::max_range, "Maximum depth along z, in metres.")
      .def("rays", &make_rays,
           "rays($self)\n--\n\n"
           "Directions of all pixels in the optical frame, with z = 1: float64, shape\n"
           "(height, width, 3). A point at depth t is t * ray.");
}

}  // namespace

void bind_poses(py::module_& module) {
  py::class_<View>(module, "View", py::is_final(),
                   "A viewpoint: View(position, direction), arrays of shape (3,) in the world "
                   "frame (x east,\ny north, z up), in metres. The direction is normalised.")
      .def(py::init(&view_from), py::arg("position"), py::arg("direction"))
      .def_property_readonly(
          "position", [](const View& view) { return to_array(view.position); },
          "World frame, in metres: float64, shape (3,).")
      .def_property_readonly(
          "direction", [](const View& view) { return to_array(view.direction); },
          "Unit vector from the sensor to the scene, world frame: float64, shape (3,).")
      .def(
          "pose", [](const View& view) { return to_array(geometry::camera_pose(view)); },
          "pose($self)\n--\n\n"
          "world_from_sensor of a camera that takes this view upright: float64, shape (4, 4),\n"
          "from its optical frame (x right, y down, z forward).")
      .def("__repr__", &to_string);
  module.def("look_at", &look_at, py::arg("position"), py::arg("target"),
             "look_at(position, target)\n--\n\n"
             "The view from `position` to `target`, arrays of shape (3,) in the world frame.");
  bind_camera(module);
}

}  // namespace skycap::python
