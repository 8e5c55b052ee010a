#include "missions/batch/campaign/submission.h"

#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "geometry/error.h"
#include "missions/support/external_program.h"

namespace skycap::missions::batch {
namespace {

/// Runs an engine's command; returns what it said, nothing if it has failed.
std::string started(const Words& command, const std::stop_token& stop,
                    const std::function<void(const std::string&)>& warn) {
  const support::ProgramResult result = support::run_external_program(command, ".", stop);
  if (result.exit_code == 127 && result.output.empty()) {
    throw Error(ErrorKind::bad_usage,
                "unknown program " + command[0] + "; install the scheduler, or use another one");
  }
  if (result.exit_code != 0 && !stop.stop_requested()) {
    warn(fmt::format("{} ended with {}: {}", command[0], result.exit_code, result.output));
  }
  return result.exit_code == 0 ? result.output : "";
}

}  // namespace

Submission submit(EngineName engine, const JobRequest& request, geometry::OutputFolder& folder,
                  const std::stop_token& stop,
                  const std::function<void(const std::string&)>& warn) {
  std::error_code failure;  // which the engine will tell of
  std::filesystem::create_directories(request.out / "logs", failure);
  const EngineJob job = engine_job(engine, request);
  for (const auto& [name, text] : job.files) folder.write(name, text);
  folder.commit();
  const std::string said = started(job.command, stop, warn);
  Submission submission{.is_queued = engine == EngineName::slurm, .tasks = split(engine, request)};
  if (!submission.is_queued) return submission;
  submission.job = said.substr(0, said.find_first_of(";\n"));  // JOB or JOB;CLUSTER
  submission.is_accepted = !submission.job.empty() &&
                           !started(slurm_collection(request, submission.job), stop, warn).empty();
  return submission;
}

}  // namespace skycap::missions::batch
