#include "python/interruptible.h"

#include <chrono>
#include <exception>
#include <future>
#include <optional>
#include <thread>

#include <pybind11/pybind11.h>

namespace skycap::python {

namespace py = pybind11;

void run_interruptibly(const std::function<void(const std::stop_token&)>& work) {
  constexpr std::chrono::milliseconds poll_interval{20};
  std::stop_source stop;
  std::packaged_task<void()> task([&] { work(stop.get_token()); });
  std::future<void> done = task.get_future();
  std::optional<py::error_already_set> raised;
  {
    py::gil_scoped_release others_go_on;
    std::jthread worker(std::move(task));
    while (done.wait_for(poll_interval) != std::future_status::ready) {
      py::gil_scoped_acquire lock;
      if (!raised && PyErr_CheckSignals() != 0) {
        raised.emplace();
        stop.request_stop();
      }
    }
  }
  if (raised) throw std::move(*raised);
  done.get();
}

}  // namespace skycap::python
