/// Modules loaded on demand, because their libraries take longer to load than most commands take to
/// run. Modules are searched for in $SKYCAP_PLUGINS, next to the executable, and in ../lib/skycap
/// relative to it, where they are installed.
#pragma once

#include <string>

namespace skycap::missions::support {

/// Returns the address of an extern "C" function in a module. Modules are never unloaded, because
/// objects created by them may outlive any scope. Throws Error{bad_file} if the module or one of
/// its libraries is missing.
void* module_symbol(const std::string& module, const std::string& function);

template <typename Function>
Function* module_function(const std::string& module, const std::string& function) {
  return reinterpret_cast<Function*>(module_symbol(module, function));
}

}  // namespace skycap::missions::support
