/// Long work while other threads of Python go on and Ctrl-C is heard.
#pragma once

#include <functional>
#include <stop_token>

namespace skycap::python {

/// Runs `work` on a thread of its own, without Python's lock, and waits for it. Signals are looked
/// for meanwhile: one that raises (Ctrl-C does) stops the token, and is raised once `work` has
/// returned. What `work` throws is thrown on. It may take Python's lock; an exception of Python's
/// that it lets out is raised, too. Call with Python's lock held.
void run_interruptibly(const std::function<void(const std::stop_token&)>& work);

}  // namespace skycap::python
