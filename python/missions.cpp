// Mission files, their sensors, and the simulation.
#include <filesystem>
#include <optional>
#include <string>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "missions/api/mission.h"
#include "missions/api/sensors.h"
#include "missions/api/simulation.h"
#include "python/arrays.h"
#include "python/bindings.h"

namespace skycap::python {
namespace {

using missions::api::Mission;
using missions::api::Setting;
using missions::api::Simulation;

std::string to_yaml(const py::handle& value);

/// Converts a value inside a list or table. Strings are quoted, because they may contain
/// separators.
std::string make_entry(const py::handle& value) {
  if (!py::isinstance<py::str>(value)) return to_yaml(value);
  std::string text = "'";
  for (const char c : value.cast<std::string>())
    text += c == '\'' ? std::string("''") : std::string(1, c);
  return text + "'";
}

/// Converts a Python value to YAML for a mission file. Numbers, booleans, lists and tables of
/// Python are valid YAML flow style, except for a few words. A string is used like the value of
/// `--set KEY=`.
std::string to_yaml(const py::handle& value) {
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  if (value.is_none()) return "null";
  if (value.ptr() == Py_True) return "true";
  if (value.ptr() == Py_False) return "false";
  std::string text;
  if (py::isinstance<py::dict>(value)) {
    for (const auto& [key, entry] : py::reinterpret_borrow<py::dict>(value)) {
      text += (text.empty() ? "" : ", ") + make_entry(key) + ": " + make_entry(entry);
    }
    return "{" + text + "}";
  }
  if (py::hasattr(value, "tolist"))
    return to_yaml(value.attr("tolist")());  // numpy array or scalar
  if (py::isinstance<py::sequence>(value)) {
    for (const py::handle entry : value) text += (text.empty() ? "" : ", ") + make_entry(entry);
    return "[" + text + "]";
  }
  return py::str(value).cast<std::string>();
}

std::vector<Setting> to_settings(const std::optional<py::dict>& set) {
  std::vector<Setting> settings;
  if (!set) return settings;
  for (const auto& [key, value] : *set) {
    settings.push_back({key.cast<std::string>(), to_yaml(value)});
  }
  return settings;
}

Mission load(const std::filesystem::path& file, const std::optional<py::dict>& set) {
  const std::vector<Setting> settings = to_settings(set);
  py::gil_scoped_release others_go_on;
  return Mission::load(file, settings);
}

Mission parse(const std::string& text, const std::string& name,
              const std::optional<py::dict>& set) {
  const std::vector<Setting> settings = to_settings(set);
  py::gil_scoped_release others_go_on;
  return Mission::parse(text, name, settings);
}

/// Returns the points, pose and pixels of a scan in the order of the parameters of
/// Planner.next_view.
py::tuple to_arrays(geometry::Scan&& measured) {
  const auto [scan, keeper] = kept(std::move(measured));
  py::object pixels = py::none();
  if (!scan->pixels.empty()) {
    pixels = make_array_view(scan->pixels.data(), static_cast<py::ssize_t>(scan->pixels.size()), 0,
                             keeper);
  }
  return py::make_tuple(make_array_view(scan->points, keeper), to_array(scan->world_from_sensor),
                        pixels);
}

py::tuple simulated_scan(const Simulation& simulation, const geometry::View& view,
                         std::uint64_t frame) {
  geometry::Scan scan;
  {
    py::gil_scoped_release others_go_on;
    scan = simulation.scan(view, frame);
  }
  return to_arrays(std::move(scan));
}

void bind_simulation(py::module_& module) {
  using without_lock = py::call_guard<py::gil_scoped_release>;
  py::class_<Simulation>(
      module, "Simulation", py::is_final(),
      "The simulated world of plan(): Simulation(mission) loads the mission's scene and "
      "measures\nit with the mission's sensor. For custom survey loops. Thread-safe.")
      .def(py::init<const Mission&>(), py::arg("mission"), without_lock())
      .def_property_readonly("first_view", &Simulation::first_view, "First view of plan().")
      .def("scan", &simulated_scan, py::arg("view"), py::arg("frame"),
           "scan($self, view, frame)\n--\n\nSimulates a scan from `view`. Its noise depends on the "
           "mission's seed and on `frame`,\nthe 0-based index of the scan. Returns (points, "
           "world_from_sensor, pixels), the\narguments of Planner.next_view: "
           "planner.next_view(*simulation.scan(v, 0)).");
}

}  // namespace

void bind_missions(py::module_& module) {
  py::class_<Mission>(module, "Mission", py::is_final(),
                      "A mission file, read, checked and completed with defaults as by `skycap "
                      "plan`. Immutable. Created by\n"
                      "Mission.load and Mission.parse.")
      .def_static("load", &load, py::arg("file"), py::arg("set") = py::none(),
                  "load(file, set=None)\n--\n\nReads a mission file. `set` maps keys such as "
                  "'planner.name' to values that override the\nfile: strings, numbers, bools, "
                  "lists. Raises Error with file, line and key for an\ninvalid mission.")
      .def_static(
          "parse", &parse, py::arg("text"), py::arg("name") = "mission.yaml",
          py::arg("set") = py::none(),
          "parse(text, name='mission.yaml', set=None)\n--\n\nLike load(), but from a string. "
          "`name` is used in messages, and its folder is the base\nof relative paths.")
      .def_property_readonly("name", &Mission::name, "Name of the mission.")
      .def_property_readonly("seed", &Mission::seed,
                             "Random seed of the start view and the sensor noise.")
      .def_property_readonly(
          "camera", &Mission::camera,
          "Camera used by planners to choose views; for a laser scanner, its substitute camera.")
      .def_property_readonly("coverage_distance", &Mission::coverage_distance,
                             "Coverage distance: a surface sample within this distance of a "
                             "measurement is covered,\nin metres.")
      .def("model", &Mission::model, py::call_guard<py::gil_scoped_release>(),
           "model($self)\n"
           "--\n"
           "\n"
           "Scene model in the world frame, without the ground plane. It is the ground truth;\n"
           "planners do not use it.")
      .def("__repr__",
           [](const Mission& mission) { return "<skycap.Mission " + mission.name() + ">"; });
  bind_simulation(module);
  module.def("sensors", &missions::api::sensor_names,
             "sensors()\n--\n\nNames of the sensor presets.");
  module.def(
      "camera", [](const std::string& name) { return missions::api::depth_camera(name).camera; },
      py::arg("name"),
      "camera(name)\n"
      "--\n"
      "\n"
      "The depth camera preset of that name, or the camera in a .yaml sensor file; see sensors().");
}

}  // namespace skycap::python
