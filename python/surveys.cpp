// Complete surveys, like `skycap plan`.
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include <pybind11/functional.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "missions/api/mission.h"
#include "missions/api/survey.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/interruptible.h"

namespace skycap::python {
namespace {

using missions::api::Mission;
using missions::api::Survey;
using survey::SurveyedView;

Survey plan(const Mission& mission, const std::optional<std::filesystem::path>& out,
            const py::object& progress) {
  Survey survey;
  run_interruptibly([&](const std::stop_token& stop) {
    missions::api::SurveyRequest request{.folder = out, .report = {}, .stop = stop};
    if (!progress.is_none()) {
      request.report = [&](const SurveyedView& view, double coverage) {
        py::gil_scoped_acquire lock;
        progress(py::cast(view), coverage);
      };
    }
    survey = missions::api::plan(mission, request);
  });
  return survey;
}

void bind_surveyed_view(py::module_& module) {
  py::class_<SurveyedView>(module, "SurveyedView", py::is_final(),
                           "A view of a survey, with the planner's statistics of its scan.")
      .def_readonly("view", &SurveyedView::view, "Position and direction of the sensor.")
      .def_readonly("distance", &SurveyedView::distance,
                    "Path length up to and including this view, in metres.")
      .def_readonly("points", &SurveyedView::points, "Number of points kept so far.")
      .def_readonly("returns", &SurveyedView::returns, "Number of returns of the scan.")
      .def_readonly("planning_time", &SurveyedView::planning_time,
                    "Time of the planner's update, in seconds.")
      .def_readonly("step", &SurveyedView::step, "Statistics of the planner's step.");
}

}  // namespace

void bind_surveys(py::module_& module) {
  bind_surveyed_view(module);
  py::class_<Survey>(module, "Survey", py::is_final(), "A survey from its first to its last view.")
      .def_property_readonly(
          "end", [](const Survey& whole) { return survey::to_string(whole.end); },
          "Stop reason: 'complete', 'view_limit', 'distance_limit', 'time_limit' "
          "or\n'no_reachable_view'.")
      .def_readonly("views", &Survey::views, "The views in order.")
      .def_property_readonly("coverage", &Survey::coverage,
                             "Covered fraction of the surface at the end, from 0 to 1.")
      .def_property_readonly(
          "coverages",
          [](const py::object& self) {
            const auto& coverages = self.cast<const Survey&>().coverages;
            return make_array_view(coverages.data(), static_cast<py::ssize_t>(coverages.size()), 0,
                                   self);
          },
          "Covered fraction after each view: float64, shape (number of views,); read-only.")
      .def_readonly("cloud", &Survey::cloud, "The measured points.")
      .def_readonly("visible_coverage", &Survey::visible_coverage,
                    "Covered fraction of the visible surface; None if no surface is visible.")
      .def_readonly("attainable_coverage", &Survey::attainable_coverage,
                    "Attainable coverage, as a fraction of the surface; None if not computed.")
      .def_property_readonly(
          "summary",
          [](const Survey& survey) {
            return py::module_::import("json").attr("loads")(survey.summary);
          },
          "Contents of summary.json, as a dict: all values and the complete settings.")
      .def_readonly("failure", &Survey::failure,
                    "Reason why no route was planned; '' if the survey has a route.");
  module.def(
      "plan", &plan, py::arg("mission"), py::arg("out") = py::none(),
      py::arg("progress") = py::none(),
      "plan(mission, out=None, progress=None)\n"
      "--\n"
      "\n"
      "Surveys the mission's scene in simulation, as `skycap plan` does.\n"
      "\n"
      "out: folder for the mission package. It has the same bytes as the package of the program,\n"
      "except for times and without the report. None: nothing is written, and no route is "
      "planned.\n"
      "progress: called with each SurveyedView and the covered fraction after it; an\n"
      "exception raised by it ends the survey.\n"
      "\n"
      "Ctrl-C ends the survey after the view that is being planned; the results so far are\n"
      "written, then KeyboardInterrupt is raised.");
}

}  // namespace skycap::python
