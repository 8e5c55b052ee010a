// Mission files, the sensors they name, and the simulation that stands for the world.
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

std::string yaml_of(const py::handle& value);

/// Inside of a list or table a text stands in quotes: it may hold what parts entries.
std::string entry_of(const py::handle& value) {
  if (!py::isinstance<py::str>(value)) return yaml_of(value);
  std::string text = "'";
  for (const char c : value.cast<std::string>())
    text += c == '\'' ? std::string("''") : std::string(1, c);
  return text + "'";
}

/// As a mission file says it: numbers, truth, lists and tables of Python are those of YAML's flow
/// style but for a few words. A text is what would stand behind `--set KEY=`.
std::string yaml_of(const py::handle& value) {
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  if (value.is_none()) return "null";
  if (value.ptr() == Py_True) return "true";
  if (value.ptr() == Py_False) return "false";
  std::string text;
  if (py::isinstance<py::dict>(value)) {
    for (const auto& [key, entry] : py::reinterpret_borrow<py::dict>(value)) {
      text += (text.empty() ? "" : ", ") + entry_of(key) + ": " + entry_of(entry);
    }
    return "{" + text + "}";
  }
  if (py::hasattr(value, "tolist")) return yaml_of(value.attr("tolist")());  // numpy's
  if (py::isinstance<py::sequence>(value)) {
    for (const py::handle entry : value) text += (text.empty() ? "" : ", ") + entry_of(entry);
    return "[" + text + "]";
  }
  return py::str(value).cast<std::string>();
}

std::vector<Setting> settings_of(const std::optional<py::dict>& set) {
  std::vector<Setting> settings;
  if (!set) return settings;
  for (const auto& [key, value] : *set) {
    settings.push_back({key.cast<std::string>(), yaml_of(value)});
  }
  return settings;
}

Mission load(const std::filesystem::path& file, const std::optional<py::dict>& set) {
  const std::vector<Setting> settings = settings_of(set);
  py::gil_scoped_release others_go_on;
  return Mission::load(file, settings);
}

Mission parse(const std::string& text, const std::string& name,
              const std::optional<py::dict>& set) {
  const std::vector<Setting> settings = settings_of(set);
  py::gil_scoped_release others_go_on;
  return Mission::parse(text, name, settings);
}

/// The points, pose and pixels of a scan, in the order in which Planner.next_view takes them.
py::tuple arrays_of(geometry::Scan&& measured) {
  const auto [scan, keeper] = kept(std::move(measured));
  py::object pixels = py::none();
  if (!scan->pixels.empty()) {
    pixels = view_of(scan->pixels.data(), static_cast<py::ssize_t>(scan->pixels.size()), 0, keeper);
  }
  return py::make_tuple(view_of(scan->points, keeper), array_of(scan->world_from_sensor), pixels);
}

py::tuple simulated_scan(const Simulation& simulation, const geometry::View& view,
                         std::uint64_t frame) {
  geometry::Scan scan;
  {
    py::gil_scoped_release others_go_on;
    scan = simulation.scan(view, frame);
  }
  return arrays_of(std::move(scan));
}

void bind_simulation(py::module_& module) {
  using without_lock = py::call_guard<py::gil_scoped_release>;
  py::class_<Simulation>(
      module, "Simulation",
      "What stands for the world in plan(): Simulation(mission) makes the mission's scene ready\n"
      "and measures it with the mission's sensor. For survey loops of one's own; any number of\n"
      "threads may use it.")
      .def(py::init<const Mission&>(), py::arg("mission"), without_lock())
      .def_property_readonly("first_view", &Simulation::first_view, "Where plan() begins.")
      .def("scan", &simulated_scan, py::arg("view"), py::arg("frame"),
           "scan($self, view, frame)\n--\n\n"
           "What the sensor measures from `view`, with its noise, which the mission's seed and\n"
           "`frame`, the number of the scan from 0, decide. Gives (points, world_from_sensor,\n"
           "pixels), as Planner.next_view takes them: planner.next_view(*simulation.scan(v, 0)).");
}

}  // namespace

void bind_missions(py::module_& module) {
  py::class_<Mission>(module, "Mission",
                      "A mission file, read, checked and completed as `skycap plan` does it.\n"
                      "Immutable. Made by Mission.load and Mission.parse.")
      .def_static("load", &load, py::arg("file"), py::arg("set") = py::none(),
                  "load(file, set=None)\n--\n\n"
                  "Reads a mission file; `set` maps keys such as 'planner.name' to values that\n"
                  "take the place of the file's: text, numbers, bools, lists. Raises Error, with\n"
                  "file, line and key, for whatever is wrong.")
      .def_static("parse", &parse, py::arg("text"), py::arg("name") = "mission.yaml",
                  py::arg("set") = py::none(),
                  "parse(text, name='mission.yaml', set=None)\n--\n\n"
                  "The same of the text of a mission; `name` stands for the file in messages, and\n"
                  "its folder is where relative paths start.")
      .def_property_readonly("name", &Mission::name, "Of the mission.")
      .def_property_readonly("seed", &Mission::seed, "Of the start view and the sensor's noise.")
      .def_property_readonly("camera", &Mission::camera,
                             "The camera by which planners choose views; of a laser scanner, the\n"
                             "one that stands for it.")
      .def_property_readonly("coverage_distance", &Mission::coverage_distance,
                             "A surface point with a measurement this near is covered, in metres.")
      .def("model", &Mission::model, py::call_guard<py::gil_scoped_release>(),
           "model($self)\n--\n\n"
           "The model of the scene, placed, without ground: the truth, which no planner sees.")
      .def("__repr__",
           [](const Mission& mission) { return "<skycap.Mission " + mission.name() + ">"; });
  bind_simulation(module);
  module.def("sensors", &missions::api::sensor_names,
             "sensors()\n--\n\nThe names of the sensors that come with Skycap.");
  module.def(
      "camera", [](const std::string& name) { return missions::api::depth_camera(name).camera; },
      py::arg("name"),
      "camera(name)\n--\n\n"
      "The depth camera of that name, or that a .yaml file describes; see sensors().");
}

}  // namespace skycap::python
