#include "missions/session/own_planner_loader.h"

#include <exception>
#include <filesystem>
#include <memory>

#include <dlfcn.h>

#include "geometry/error.h"
#include "missions/session/python_planner.h"

namespace skycap::missions::session {
namespace {

[[noreturn]] void fail(const std::string& file, const std::string& what) {
  throw Error(ErrorKind::bad_file, file + ": " + what);
}

survey::external::LoadedPlanner load_library(const std::string& file,
                                             const survey::OwnPlannerTask& task) {
  void* const library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) fail(file, std::string("cannot load the library: ") + ::dlerror());
  const auto interface =
      reinterpret_cast<int (*)()>(::dlsym(library, "skycap_own_planner_interface"));
  const auto make =
      reinterpret_cast<void* (*)(const void*)>(::dlsym(library, "skycap_make_own_planner"));
  if (interface == nullptr || make == nullptr) {
    fail(file, "is not a planner library; add SKYCAP_OWN_PLANNER (docs/howto/write-a-planner.md)");
  }
  if (interface() != survey::own_planner_interface) {
    fail(file, "was built for version " + std::to_string(interface()) +
                   " of the planner interface; build it with version " +
                   std::to_string(survey::own_planner_interface));
  }
  try {
    return {.planner =
                std::unique_ptr<survey::OwnPlanner>(static_cast<survey::OwnPlanner*>(make(&task)))};
  } catch (const std::exception& failure) {
    fail(file, failure.what());
  }
}

}  // namespace

survey::external::LoadedPlanner load_own_planner(const std::string& file,
                                                 const survey::OwnPlannerTask& task) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) {
    fail(file, "cannot open the planner; set planner.file to an existing file");
  }
  if (file.ends_with(".py")) return load_python_planner(file, task);
  if (file.ends_with(".so")) return load_library(file, task);
  fail(file, "unsupported planner; expected a shared library (.so) or a Python file (.py)");
}

}  // namespace skycap::missions::session
