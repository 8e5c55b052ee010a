// Meshes from models, files and arrays, and comparison of clouds with them.
#include <filesystem>
#include <optional>
#include <string>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "geometry/io/mesh_io.h"
#include "geometry/surfaces/mesh.h"
#include "missions/api/evaluation.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/interruptible.h"
#include "sim/models/models.h"

namespace skycap::python {
namespace {

using geometry::Mesh;
using missions::api::Evaluation;

Mesh mesh_from(const Array<double>& vertices, const py::object& corners) {
  const Array<std::uint32_t> triangles = indices_in(corners, "triangles");
  if (triangles.ndim() != 2 || triangles.shape(1) != 3) {
    throw py::value_error("triangles must have shape (M, 3)");
  }
  Mesh mesh;
  mesh.vertices = positions_in(vertices, "vertices");
  for (py::ssize_t i = 0; i < triangles.shape(0); ++i) {
    mesh.triangles.push_back({triangles.at(i, 0), triangles.at(i, 1), triangles.at(i, 2)});
  }
  geometry::validate(mesh);
  return mesh;
}

py::array_t<std::uint32_t> to_triangles(const py::object& self) {
  const auto& mesh = self.cast<const Mesh&>();
  return make_array_view(mesh.triangles.data()->data(),
                         static_cast<py::ssize_t>(mesh.triangles.size()), 3, self);
}

std::vector<std::string> model_names() {
  const auto names = sim::builtin_models();
  return {names.begin(), names.end()};
}

Evaluation evaluate(const Array<float>& points, const Mesh& model, double distance,
                    std::size_t samples) {
  const auto cloud = points_in(points, "points");
  Evaluation evaluation;
  run_interruptibly([&](const std::stop_token&) {
    evaluation = missions::api::evaluate(cloud, model, {.distance = distance, .samples = samples});
  });
  return evaluation;
}

void bind_evaluation(py::module_& module) {
  py::class_<Evaluation>(module, "Evaluation", py::is_final(),
                         "Evaluation of a cloud against a reference surface. Distances are those "
                         "of the cloud's\npoints to the surface, in metres.")
      .def_readonly(
          "coverage", &Evaluation::coverage,
          "Fraction of the surface with a point within the coverage distance, from 0 to 1.")
      .def_readonly("mean", &Evaluation::mean, "Mean distance, in metres.")
      .def_readonly("root_mean_square", &Evaluation::root_mean_square,
                    "Root mean square distance, in metres.")
      .def_readonly("median", &Evaluation::median, "Median distance, in metres.")
      .def_readonly("percentile_95", &Evaluation::percentile_95,
                    "95th percentile of the distances, in metres.")
      .def_readonly("largest", &Evaluation::largest, "Maximum distance, in metres.")
      .def_readonly("area", &Evaluation::area, "Area of the surface, in square metres.")
      .def_readonly("density", &Evaluation::density, "Points per square metre of the surface.");
  module.def(
      "evaluate", &evaluate, py::arg("points"), py::arg("model"), py::arg("distance"),
      py::arg("samples") = missions::api::EvaluationRequest{}.samples,
      "evaluate(points, model, distance, samples=100000)\n"
      "--\n"
      "\n"
      "Evaluates a cloud, (N, 3) in the frame of the mesh `model`, as `skycap evaluate` does.\n"
      "A surface sample is covered if a point is within `distance` metres; `samples` samples\n"
      "are used. float32 arrays are not copied.");
}

}  // namespace

void bind_surfaces(py::module_& module) {
  py::class_<Mesh>(
      module, "Mesh", py::is_final(),
      "A triangle mesh: Mesh(vertices, triangles). The vertices are (N, 3) float64 in metres,\n"
      "z up. The triangles are (M, 3) uint32, counter-clockwise seen from outside. Both are "
      "copied.")
      .def(py::init(&mesh_from), py::arg("vertices"), py::arg("triangles"))
      .def_property_readonly(
          "vertices",
          [](const py::object& self) {
            return make_array_view(self.cast<const Mesh&>().vertices, self);
          },
          "float64, shape (N, 3), in metres; read-only, not copied.")
      .def_property_readonly("triangles", &to_triangles,
                             "uint32, shape (M, 3); read-only, not copied.")
      .def_property_readonly("area", &geometry::surface_area, "Surface area, in square metres.");
  module.def(
      "read_mesh", [](const std::filesystem::path& file) { return geometry::read_mesh(file); },
      py::arg("file"), py::call_guard<py::gil_scoped_release>(),
      "read_mesh(file)\n--\n\nReads a mesh from a PLY, OBJ, STL, OFF or Draco file, without "
      "changes.");
  module.def("models", &model_names,
             "models()\n"
             "--\n"
             "\n"
             "Names of the scenes available to model().");
  module.def(
      "model", [](const std::string& name) { return sim::builtin_model(name); }, py::arg("name"),
      py::call_guard<py::gil_scoped_release>(),
      "model(name)\n--\n\nA builtin scene, standing on z = 0, in metres.");
  bind_evaluation(module);
}

}  // namespace skycap::python
