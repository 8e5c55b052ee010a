#include "missions/plugins/module.h"

#include <cstdlib>
#include <filesystem>
#include <system_error>

#include <dlfcn.h>

#include "geometry/error.h"

namespace skycap::missions::plugins {
namespace {

namespace fs = std::filesystem;

/// Where the modules are: with the program, wherever that was put, or where its installation puts
/// them; SKYCAP_PLUGINS_OF_PROGRAM is the way there from the program's folder.
fs::path module_folder(const std::string& module) {
  const char* folder = std::getenv("SKYCAP_PLUGINS");  // NOLINT(concurrency-mt-unsafe): never set
  if (folder != nullptr && *folder != '\0') return folder;
  std::error_code failure;
  const fs::path program = fs::read_symlink("/proc/self/exe", failure);
  if (failure) {
    throw Error(ErrorKind::bad_file, "/proc/self/exe cannot be read (" + failure.message() +
                                         "); name the folder of libskycap_*.so in $SKYCAP_PLUGINS");
  }
  const fs::path installed = program.parent_path() / SKYCAP_PLUGINS_OF_PROGRAM;
  return fs::exists(installed / module, failure) ? installed : program.parent_path();
}

}  // namespace

void* module_symbol(const std::string& module, const std::string& function) {
  const std::string path = (module_folder(module) / module).string();
  void* const handle = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const symbol = handle != nullptr ? ::dlsym(handle, function.c_str()) : nullptr;
  if (symbol == nullptr) {
    throw Error(ErrorKind::bad_file,
                path + ": this part of the program cannot be loaded (" + ::dlerror() +
                    "); put it beside the program, or name its folder in $SKYCAP_PLUGINS");
  }
  return symbol;
}

}  // namespace skycap::missions::plugins
