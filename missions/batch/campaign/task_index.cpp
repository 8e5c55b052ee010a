#include "missions/batch/campaign/task_index.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <string_view>

#include "geometry/error.h"
#include "missions/batch/campaign/campaign_file.h"

namespace skycap::missions::batch {
namespace {

struct Engine {
  const char* name;
  const char* variable;
  std::size_t first;  ///< what it calls its first task
};

constexpr std::array engines{
    Engine{"slurm", "SLURM_ARRAY_TASK_ID", 0}, Engine{"mpi", "OMPI_COMM_WORLD_RANK", 0},
    Engine{"kubernetes", "JOB_COMPLETION_INDEX", 0}, Engine{"parallel", "PARALLEL_SEQ", 1}};

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorKind::bad_usage, what); }

std::size_t number_in(const std::string& text, std::size_t first, const std::string& origin) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < first ||
      number - first >= most_items) {
    refuse(origin + " is '" + text + "'; it must be an integer of at least " +
           std::to_string(first));
  }
  return number - first;
}

/// What the engine's variable says; nothing if it is not set.
std::optional<std::size_t> task_of(const Engine& engine, const Environment& environment) {
  const auto value = environment(engine.variable);
  if (!value) return std::nullopt;
  return number_in(*value, engine.first, engine.variable);
}

std::size_t the_only_task(const Environment& environment) {
  const Engine* found = nullptr;
  std::string known;
  for (const Engine& engine : engines) {
    known += (known.empty() ? "" : ", ") + std::string(engine.variable);
    if (!environment(engine.variable)) continue;
    if (found) {
      refuse("--index auto: " + std::string(found->variable) + " and " + engine.variable +
             " are both set; use --index " + found->name + " or --index " + engine.name);
    }
    found = &engine;
  }
  if (!found) refuse("--index auto: none of " + known + " is set; use --index N");
  return *task_of(*found, environment);
}

}  // namespace

Environment program_environment() {
  return [](const std::string& name) -> std::optional<std::string> {
    const char* const value = std::getenv(name.c_str());
    return value ? std::optional<std::string>(value) : std::nullopt;
  };
}

std::size_t task_index(const std::string& index, const Environment& environment) {
  if (index == "auto") return the_only_task(environment);
  const auto engine =
      std::ranges::find_if(engines, [&](const Engine& known) { return index == known.name; });
  if (engine == engines.end()) return number_in(index, 0, "--index");
  if (const auto task = task_of(*engine, environment)) return *task;
  refuse("--index " + index + ": " + engine->variable +
         " is not set; this is not a task of that scheduler");
}

ItemRange items_of_task(std::size_t task, std::size_t chunk, std::size_t items) {
  const std::size_t first = task < items ? std::min(items, task * chunk) : items;
  return {first, std::min(items, first + chunk)};
}

}  // namespace skycap::missions::batch
