/// The parts of the module, one source each. Each adds its classes and functions; those before it
/// are there already.
#pragma once

#include <pybind11/pybind11.h>

namespace skycap::python {

void bind_errors(pybind11::module_& module);
void bind_places(pybind11::module_& module);
void bind_surfaces(pybind11::module_& module);
void bind_missions(pybind11::module_& module);
void bind_planner(pybind11::module_& module);
void bind_surveys(pybind11::module_& module);
void bind_scans(pybind11::module_& module);
void bind_certificates(pybind11::module_& module);

/// Emits a DeprecationWarning for a name of version 0.1; throws if warnings are errors.
void warn_of_former_name(const char* former, const char* current);

}  // namespace skycap::python
