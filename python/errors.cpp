// skycap.Error, with the same messages as the program.
#include "geometry/error.h"
#include "python/bindings.h"

namespace skycap::python {
namespace {

namespace py = pybind11;

const char* to_string(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::bad_usage:
      return "bad_usage";
    case ErrorKind::bad_config:
      return "bad_config";
    case ErrorKind::bad_file:
      return "bad_file";
    case ErrorKind::bad_geometry:
      return "bad_geometry";
  }
  return "";
}

PyObject* error_type = nullptr;  // lives as long as the module, which is never unloaded

void raise(const Error& error) {
  const py::object raised = py::reinterpret_borrow<py::object>(error_type)(error.what());
  raised.attr("kind") = to_string(error.kind());
  PyErr_SetObject(error_type, raised.ptr());
}

}  // namespace

void bind_errors(py::module_& module) {
  static py::exception<Error> type(module, "Error");
  type.doc() =
      "Error of a failed operation. The message states the reason in one sentence.\n"
      "\n"
      "`kind` is 'bad_config' (a key or a setting), 'bad_file' (cannot be read or written),\n"
      "'bad_geometry' (an unusable mesh, cloud or scan) or 'bad_usage'.";
  error_type = type.ptr();
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& error) {
      raise(error);
    }
  });
}

void warn_deprecated_name(const char* former, const char* current) {
  const std::string text = std::string(former) + " is now " + current;
  if (PyErr_WarnEx(PyExc_DeprecationWarning, text.c_str(), 1) != 0) throw py::error_already_set();
}

}  // namespace skycap::python
