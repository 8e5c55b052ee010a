/// Parts of the program that are loaded when they are needed, because the libraries behind them
/// take longer to load than most verbs take to run. They are looked for beside the running program
/// and in ../lib/skycap from there, where an installation has them, or in $SKYCAP_PLUGINS.
#pragma once

#include <string>

namespace skycap::missions::support {

/// The address of an extern "C" function of a module, which is never unloaded: what it has made may
/// outlive any scope. Throws Error{bad_file} if the module or its libraries are not there.
void* module_symbol(const std::string& module, const std::string& function);

template <typename Function>
Function* module_function(const std::string& module, const std::string& function) {
  return reinterpret_cast<Function*>(module_symbol(module, function));
}

}  // namespace skycap::missions::support
