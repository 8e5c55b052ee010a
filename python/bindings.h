/// Parts of the module, one per source file. Each adds classes and functions and may use those of
/// the preceding parts.
#pragma once

#include <pybind11/pybind11.h>

namespace skycap::python {

void bind_errors(pybind11::module_& module);
void bind_poses(pybind11::module_& module);
void bind_surfaces(pybind11::module_& module);
void bind_missions(pybind11::module_& module);
void bind_planner(pybind11::module_& module);
void bind_surveys(pybind11::module_& module);
void bind_scans(pybind11::module_& module);
void bind_certificates(pybind11::module_& module);

/// Emits a DeprecationWarning for a name of version 0.1. Throws if warnings are configured as
/// errors.
void warn_deprecated_name(const char* former, const char* current);

}  // namespace skycap::python
