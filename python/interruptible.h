/// Execution of long operations while other Python threads run and Ctrl-C is handled.
#pragma once

#include <functional>
#include <stop_token>

namespace skycap::python {

/// Runs `work` on a separate thread without the GIL and waits for it. Signals are checked
/// meanwhile. If a signal handler raises an exception, as for Ctrl-C, the token is stopped, and the
/// exception is raised after `work` has returned.
///
/// Exceptions of `work` are rethrown. `work` may acquire the GIL, and its Python exceptions are
/// raised, too. Must be called with the GIL held.
void run_interruptibly(const std::function<void(const std::stop_token&)>& work);

}  // namespace skycap::python
