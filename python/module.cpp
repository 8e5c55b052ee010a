// Module skycap._skycap, which `import skycap` exports. It uses only public headers, like user
// programs (docs/reference/cpp-api.md).
#include "python/bindings.h"

namespace py = pybind11;

PYBIND11_MODULE(_skycap, module) {
  py::options options;
  options.disable_function_signatures();  // docstrings begin with handwritten Python signatures
  const py::object name = module.attr("__name__");
  module.attr("__name__") = "skycap";  // name of the module in the output of help()
  module.doc() = "Plans and simulates aerial surveys of buildings.";
  module.attr("__version__") = SKYCAP_VERSION;
  skycap::python::bind_errors(module);
  skycap::python::bind_poses(module);
  skycap::python::bind_surfaces(module);
  skycap::python::bind_missions(module);
  skycap::python::bind_planner(module);
  skycap::python::bind_surveys(module);
  skycap::python::bind_scans(module);
  skycap::python::bind_certificates(module);
  module.attr("__name__") = name;
}
