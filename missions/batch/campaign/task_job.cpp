#include "missions/batch/campaign/task_job.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "geometry/error.h"
#include "missions/support/external_program.h"

namespace skycap::missions::batch {
namespace {

struct Engine {
  const char* name;
  const char* variable;
  std::size_t first;  ///< number of the first task
};

constexpr std::array engines{
    Engine{"slurm", "SLURM_ARRAY_TASK_ID", 0}, Engine{"mpi", "OMPI_COMM_WORLD_RANK", 0},
    Engine{"kubernetes", "JOB_COMPLETION_INDEX", 0}, Engine{"parallel", "PARALLEL_SEQ", 1}};

[[noreturn]] void reject(const std::string& what) { throw Error(ErrorKind::bad_usage, what); }

std::size_t number_in(const std::string& text, std::size_t first, const std::string& origin) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < first ||
      number - first >= max_items) {
    reject(origin + " is '" + text + "'; it must be an integer of at least " +
           std::to_string(first));
  }
  return number - first;
}

/// Returns the task number from the scheduler's variable, or nullopt if it is not set.
std::optional<std::size_t> find_task(const Engine& engine, const Environment& environment) {
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
      reject("--index auto: " + std::string(found->variable) + " and " + engine.variable +
             " are both set; use --index " + found->name + " or --index " + engine.name);
    }
    found = &engine;
  }
  if (!found) reject("--index auto: none of " + known + " is set; use --index N");
  return *find_task(*found, environment);
}

constexpr std::size_t max_array_tasks = 1000;

std::size_t quotient_up(std::size_t a, std::size_t b) { return (a + b - 1) / b; }

/// Quotes a word for a POSIX shell.
std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

void append(Words& words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
}

Words task_words(const JobRequest& request, const std::string& index, std::size_t chunk) {
  Words words = request.command;
  append(words, {"--index", index, "--chunk", std::to_string(chunk), "--threads", "1", "--quiet"});
  return words;
}

Words collection_words(const JobRequest& request) {
  Words words = request.command;
  append(words, {"--collect", "--quiet"});
  return words;
}

EngineJob slurm_job(const JobRequest& request, const TaskSplit& tasks) {
  const std::vector<std::string> directives{
      "#SBATCH --array=0-" + std::to_string(tasks.tasks - 1),
      "#SBATCH --cpus-per-task=1",
      "#SBATCH --requeue",  // a repeated task skips completed items
      "#SBATCH --open-mode=append",
  };
  return {{{"slurm.sh",
            job_script(request.title, directives, task_words(request, "slurm", tasks.chunk))},
           {"slurm_collect.sh",
            job_script(request.title + ", collected", {}, collection_words(request))}},
          {"sbatch", "--parsable", "--job-name=" + request.name,
           "--output=" + (request.out / "logs" / "%A_%a.txt").string(), request.out / "slurm.sh"}};
}

EngineJob parallel_job(const JobRequest& request, const TaskSplit& tasks) {
  std::string list;
  for (std::size_t task = 0; task < tasks.tasks; ++task) list += std::to_string(task) + "\n";
  Words command{"parallel",
                "--quote",
                "-N0",
                "--jobs",
                std::to_string(request.jobs),
                "--joblog",
                request.out / "logs" / "parallel.txt",
                "--arg-file",
                request.out / "parallel_tasks.txt"};
  append(command, task_words(request, "parallel", tasks.chunk));
  return {{{"parallel.sh", job_script(request.title, {}, command)}, {"parallel_tasks.txt", list}},
          command};
}

EngineJob mpi_job(const JobRequest& request, const TaskSplit& tasks) {
  // A failed rank must not abort the other ranks. There may be more ranks than cores.
  Words command{"mpirun",
                "--mca",
                "orte_abort_on_non_zero_status",
                "0",
                "--bind-to",
                "none",
                "-n",
                std::to_string(tasks.tasks),
                "--oversubscribe"};
  // mpirun waits indefinitely for a rank terminated by a signal. A shell exits with a status
  // instead.
  append(command, {"sh", "-c", "\"$@\"; exit $?", "rank"});
  append(command, task_words(request, "mpi", tasks.chunk));
  return {{{"mpi.sh", job_script(request.title, {}, command)}}, command};
}

/// Returns the command that queues the collection of results after a Slurm job.
Words slurm_collection(const JobRequest& request, const std::string& job) {
  return {"sbatch",
          "--parsable",
          "--dependency=afterany:" + job,
          "--job-name=" + request.name,
          "--output=" + (request.out / "logs" / "collect.txt").string(),
          request.out / "slurm_collect.sh"};
}

/// Runs a scheduler command and returns its output, or an empty string after an error.
std::string started(const Words& command, const std::stop_token& stop,
                    const std::function<void(const std::string&)>& warn) {
  const support::ProgramResult result = support::run_external_program(command, ".", stop);
  if (result.exit_code == 127 && result.output.empty()) {
    throw Error(ErrorKind::bad_usage,
                "unknown program " + command[0] + "; install the scheduler or use another one");
  }
  if (result.exit_code != 0 && !stop.stop_requested()) {
    warn(fmt::format("{} ended with {}: {}", command[0], result.exit_code, result.output));
  }
  return result.exit_code == 0 ? result.output : "";
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
  if (const auto task = find_task(*engine, environment)) return *task;
  reject("--index " + index + ": " + engine->variable +
         " is not set; this process is not a task of that scheduler");
}

ItemRange items_in_task(std::size_t task, std::size_t chunk, std::size_t items) {
  const std::size_t first = task < items ? std::min(items, task * chunk) : items;
  return {first, std::min(items, first + chunk)};
}

EngineName engine_named(const std::string& name) {
  if (name == "slurm") return EngineName::slurm;
  return name == "mpi" ? EngineName::mpi : EngineName::parallel;
}

TaskSplit split(EngineName engine, const JobRequest& request) {
  std::size_t chunk = request.chunk;
  if (chunk == 0 && engine == EngineName::slurm) {
    chunk = quotient_up(request.items, max_array_tasks);
  }
  if (chunk == 0 && engine == EngineName::mpi) chunk = quotient_up(request.items, request.jobs);
  chunk = std::max<std::size_t>(1, chunk);
  return {quotient_up(request.items, chunk), chunk};
}

std::string job_script(const std::string& title, const std::vector<std::string>& directives,
                       const Words& command) {
  std::string script = "#!/bin/sh\n# " + title + ", written by skycap --submit.\n";
  for (const std::string& directive : directives) script += directive + "\n";
  script += "exec";  // passes signals to the program itself
  for (const std::string& word : command) script += " " + quoted(word);
  return script + "\n";
}

EngineJob engine_job(EngineName engine, const JobRequest& request) {
  const TaskSplit tasks = split(engine, request);
  switch (engine) {
    case EngineName::slurm:
      return slurm_job(request, tasks);
    case EngineName::parallel:
      return parallel_job(request, tasks);
    case EngineName::mpi:
      break;
  }
  return mpi_job(request, tasks);
}

Submission submit(EngineName engine, const JobRequest& request, geometry::OutputFolder& folder,
                  const std::stop_token& stop,
                  const std::function<void(const std::string&)>& warn) {
  std::error_code failure;  // reported by the scheduler
  std::filesystem::create_directories(request.out / "logs", failure);
  const EngineJob job = engine_job(engine, request);
  for (const auto& [name, text] : job.files) folder.write(name, text);
  folder.commit();
  const std::string job_output = started(job.command, stop, warn);
  Submission submission{.is_queued = engine == EngineName::slurm, .tasks = split(engine, request)};
  if (!submission.is_queued) return submission;
  submission.job = job_output.substr(0, job_output.find_first_of(";\n"));  // JOB or JOB;CLUSTER
  submission.is_accepted = !submission.job.empty() &&
                           !started(slurm_collection(request, submission.job), stop, warn).empty();
  return submission;
}

}  // namespace skycap::missions::batch
