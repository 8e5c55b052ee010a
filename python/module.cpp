// skycap._skycap: what `import skycap` shows. It uses public headers alone, as any program of users
// does (docs/reference/cpp-api.md).
#include "python/bindings.h"

namespace py = pybind11;

PYBIND11_MODULE(_skycap, module) {
  py::options options;
  options.disable_function_signatures();  // docstrings begin with Python's own
  const py::object name = module.attr("__name__");
  module.attr("__name__") = "skycap";  // where all of it is found, in the words of help()
  module.doc() = "Plans and simulates aerial surveys of buildings.";
  module.attr("__version__") = SKYCAP_VERSION;
  skycap::python::bind_errors(module);
  skycap::python::bind_places(module);
  skycap::python::bind_surfaces(module);
  skycap::python::bind_missions(module);
  skycap::python::bind_planner(module);
  skycap::python::bind_surveys(module);
  skycap::python::bind_scans(module);
  skycap::python::bind_certificates(module);
  module.attr("__name__") = name;
}
