// Meshes: built-in models, files, arrays; and clouds against them.
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
    throw py::value_error("triangles has not the shape (M, 3)");
  }
  Mesh mesh;
  mesh.vertices = places_in(vertices, "vertices");
  for (py::ssize_t i = 0; i < triangles.shape(0); ++i) {
    mesh.triangles.push_back({triangles.at(i, 0), triangles.at(i, 1), triangles.at(i, 2)});
  }
  geometry::validate(mesh);
  return mesh;
}

py::array_t<std::uint32_t> triangles_of(const py::object& self) {
  const auto& mesh = self.cast<const Mesh&>();
  return view_of(mesh.triangles.data()->data(), static_cast<py::ssize_t>(mesh.triangles.size()), 3,
                 self);
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
  py::class_<Evaluation>(module, "Evaluation",
                         "A cloud against the true surface. Distances are those of the cloud's\n"
                         "points from the surface, in metres.")
      .def_readonly("coverage", &Evaluation::coverage,
                    "Share of the surface with a point within the distance, in [0, 1].")
      .def_readonly("mean", &Evaluation::mean, "Mean distance, in metres.")
      .def_readonly("root_mean_square", &Evaluation::root_mean_square, "In metres.")
      .def_readonly("median", &Evaluation::median, "In metres.")
      .def_readonly("percentile_95", &Evaluation::percentile_95, "In metres.")
      .def_readonly("largest", &Evaluation::largest, "In metres.")
      .def_readonly("area", &Evaluation::area, "Of the surface, in square metres.")
      .def_readonly("density", &Evaluation::density, "Points per square metre of the surface.");
  module.def("evaluate", &evaluate, py::arg("points"), py::arg("model"), py::arg("distance"),
             py::arg("samples") = missions::api::EvaluationRequest{}.samples,
             "evaluate(points, model, distance, samples=100000)\n--\n\n"
             "Judges a cloud, (N, 3) in the frame of the mesh `model`, as `skycap evaluate` does.\n"
             "A surface point counts as covered with a point within `distance` metres; that is\n"
             "asked of `samples` surface points. float32 arrays are not copied.");
}

}  // namespace

void bind_surfaces(py::module_& module) {
  py::class_<Mesh>(
      module, "Mesh",
      "A triangle mesh: Mesh(vertices, triangles), of (N, 3) float64 in metres, z up,\n"
      "and (M, 3) uint32, anticlockwise seen from outside; both are copied.")
      .def(py::init(&mesh_from), py::arg("vertices"), py::arg("triangles"))
      .def_property_readonly(
          "vertices",
          [](const py::object& self) { return view_of(self.cast<const Mesh&>().vertices, self); },
          "float64, shape (N, 3), in metres; read-only, not copied.")
      .def_property_readonly("triangles", &triangles_of,
                             "uint32, shape (M, 3); read-only, not copied.")
      .def_property_readonly("area", &geometry::surface_area, "In square metres.");
  module.def(
      "read_mesh", [](const std::filesystem::path& file) { return geometry::read_mesh(file); },
      py::arg("file"), py::call_guard<py::gil_scoped_release>(),
      "read_mesh(file)\n--\n\n"
      "Reads a mesh from a PLY, OBJ, STL, OFF or Draco file, as it stands there.");
  module.def("models", &model_names, "models()\n--\n\nThe names of the scenes that model() makes.");
  module.def(
      "model", [](const std::string& name) { return sim::builtin_model(name); }, py::arg("name"),
      py::call_guard<py::gil_scoped_release>(),
      "model(name)\n--\n\nA scene that Skycap makes by itself, standing on z = 0, in metres.");
  bind_evaluation(module);
}

}  // namespace skycap::python
