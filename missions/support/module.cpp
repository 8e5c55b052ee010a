#include "missions/support/module.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

#include <dlfcn.h>

#include "geometry/error.h"

namespace skycap::missions::support {
namespace {

namespace fs = std::filesystem;

/// Returns the executable, or the library or Python module that contains this code.
fs::path find_module_file() {
  Dl_info info;
  const bool is_known = ::dladdr(reinterpret_cast<void*>(&module_symbol), &info) != 0;
  const fs::path file = is_known && info.dli_fname != nullptr ? info.dli_fname : "";
  if (file.filename().string().find(".so") != std::string::npos) return fs::canonical(file);
  std::error_code failure;  // dladdr() returns the invocation path of executables
  const fs::path program = fs::read_symlink("/proc/self/exe", failure);
  if (!failure) return program;
  throw Error(ErrorKind::bad_file, "cannot read /proc/self/exe (" + failure.message() +
                                       "); set $SKYCAP_PLUGINS to the folder of libskycap_*.so");
}

/// Module folders relative to this file. They cover the build and installation folders of the
/// program, of shared libraries, and of the Python module (lib/python3/dist-packages/skycap).
constexpr std::array folders{SKYCAP_PROGRAM_PLUGINS, ".", "skycap", "../..", "../../../skycap"};

fs::path module_folder(const std::string& module) {
  const char* folder = std::getenv("SKYCAP_PLUGINS");  // NOLINT(concurrency-mt-unsafe): never set
  if (folder != nullptr && *folder != '\0') return folder;
  const fs::path here = find_module_file().parent_path();
  std::error_code ignored;
  const auto found = std::ranges::find_if(
      folders, [&](const char* prefix) { return fs::exists(here / prefix / module, ignored); });
  return found == folders.end() ? here : here / *found;
}

}  // namespace

void* module_symbol(const std::string& module, const std::string& function) {
  const std::string path = (module_folder(module) / module).string();
  void* const handle = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const symbol = handle != nullptr ? ::dlsym(handle, function.c_str()) : nullptr;
  if (symbol == nullptr) {
    throw Error(ErrorKind::bad_file,
                path + ": cannot load this program module (" + ::dlerror() +
                    "); copy it to the program's folder, or set $SKYCAP_PLUGINS to its folder");
  }
  return symbol;
}

}  // namespace skycap::missions::support
