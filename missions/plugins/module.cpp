#include "missions/plugins/module.h"

#include <dlfcn.h>

#include "geometry/error.h"

namespace skycap::missions::plugins {

void* module_symbol(const std::string& module, const std::string& function) {
  const std::string path = std::string(SKYCAP_MODULE_FOLDER) + "/" + module;
  void* const handle = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const symbol = handle != nullptr ? ::dlsym(handle, function.c_str()) : nullptr;
  if (symbol == nullptr) {
    throw Error(ErrorKind::bad_file,
                path + ": this part of the program cannot be loaded: " + ::dlerror());
  }
  return symbol;
}

}  // namespace skycap::missions::plugins
