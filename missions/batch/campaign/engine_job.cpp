#include "missions/batch/campaign/engine_job.h"

#include <algorithm>

namespace skycap::missions::batch {
namespace {

constexpr std::size_t most_array_tasks = 1000;

std::size_t quotient_up(std::size_t a, std::size_t b) { return (a + b - 1) / b; }

/// As a POSIX shell reads it back.
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
      "#SBATCH --requeue",  // a task that runs again skips what is complete
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
  // A rank that fails must not end the others. Ranks may be more than the machine has cores.
  Words command{"mpirun",
                "--mca",
                "orte_abort_on_non_zero_status",
                "0",
                "--bind-to",
                "none",
                "-n",
                std::to_string(tasks.tasks),
                "--oversubscribe"};
  // mpirun would wait forever for a rank that a signal has ended; a shell ends with a status.
  append(command, {"sh", "-c", "\"$@\"; exit $?", "rank"});
  append(command, task_words(request, "mpi", tasks.chunk));
  return {{{"mpi.sh", job_script(request.title, {}, command)}}, command};
}

}  // namespace

EngineName engine_named(const std::string& name) {
  if (name == "slurm") return EngineName::slurm;
  return name == "mpi" ? EngineName::mpi : EngineName::parallel;
}

TaskSplit split(EngineName engine, const JobRequest& request) {
  std::size_t chunk = request.chunk;
  if (chunk == 0 && engine == EngineName::slurm) {
    chunk = quotient_up(request.items, most_array_tasks);
  }
  if (chunk == 0 && engine == EngineName::mpi) chunk = quotient_up(request.items, request.jobs);
  chunk = std::max<std::size_t>(1, chunk);
  return {quotient_up(request.items, chunk), chunk};
}

std::string job_script(const std::string& title, const std::vector<std::string>& directives,
                       const Words& command) {
  std::string script = "#!/bin/sh\n# " + title + ", written by skycap --submit.\n";
  for (const std::string& directive : directives) script += directive + "\n";
  script += "exec";  // so that signals reach the program itself
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

Words slurm_collection(const JobRequest& request, const std::string& job) {
  return {"sbatch",
          "--parsable",
          "--dependency=afterany:" + job,
          "--job-name=" + request.name,
          "--output=" + (request.out / "logs" / "collect.txt").string(),
          request.out / "slurm_collect.sh"};
}

}  // namespace skycap::missions::batch
