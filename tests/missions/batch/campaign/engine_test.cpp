// Runs of a scheduler's tasks, and the job scripts that start them.
#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "missions/batch/campaign/task_job.h"
#include "missions/support/external_program.h"

namespace skycap::missions::batch {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Environment make_environment(const std::map<std::string, std::string>& variables) {
  return [variables](const std::string& name) -> std::optional<std::string> {
    const auto found = variables.find(name);
    return found == variables.end() ? std::nullopt : std::optional(found->second);
  };
}

std::string rejection_message(const std::string& index, const Environment& environment) {
  try {
    task_index(index, environment);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// First and eighth task of each scheduler, numbered as in its manual.
TEST(TaskIndex, FollowsNumberingOfEachScheduler) {
  const auto task = [](const std::string& engine, const char* variable, const char* value) {
    const Environment environment = make_environment({{variable, value}});
    EXPECT_EQ(task_index("auto", environment), task_index(engine, environment));
    return task_index(engine, environment);
  };
  EXPECT_EQ(task("slurm", "SLURM_ARRAY_TASK_ID", "0"), 0U);
  EXPECT_EQ(task("slurm", "SLURM_ARRAY_TASK_ID", "7"), 7U);
  EXPECT_EQ(task("mpi", "OMPI_COMM_WORLD_RANK", "0"), 0U);
  EXPECT_EQ(task("mpi", "OMPI_COMM_WORLD_RANK", "7"), 7U);
  EXPECT_EQ(task("kubernetes", "JOB_COMPLETION_INDEX", "0"), 0U);
  EXPECT_EQ(task("kubernetes", "JOB_COMPLETION_INDEX", "7"), 7U);
  EXPECT_EQ(task("parallel", "PARALLEL_SEQ", "1"), 0U);
  EXPECT_EQ(task("parallel", "PARALLEL_SEQ", "8"), 7U);
  EXPECT_EQ(task_index("7", make_environment({{"PARALLEL_SEQ", "1"}})), 7U);
}

TEST(TaskIndex, RejectsInvalidIndices) {
  const Environment none = make_environment({});
  for (const char* wrong : {"-1", "1.5", "", "7 ", "0x3", "99999999999999999999", "all"}) {
    EXPECT_THAT(rejection_message(wrong, none), HasSubstr("--index is")) << wrong;
  }
  EXPECT_THAT(rejection_message("slurm", none), HasSubstr("SLURM_ARRAY_TASK_ID is not set"));
  EXPECT_THAT(rejection_message("auto", none), HasSubstr("none of SLURM_ARRAY_TASK_ID"));
  EXPECT_THAT(rejection_message("parallel", make_environment({{"PARALLEL_SEQ", "0"}})),
              HasSubstr("PARALLEL_SEQ is '0'; it must be an integer of at least 1"));
  EXPECT_THAT(rejection_message(
                  "auto", make_environment({{"PARALLEL_SEQ", "1"}, {"SLURM_ARRAY_TASK_ID", "4"}})),
              HasSubstr("SLURM_ARRAY_TASK_ID and PARALLEL_SEQ are both set; use --index slurm"));
}

// Property: the tasks of a job contain each run once, for any chunk size.
TEST(TaskIndex, AssignsEachRunToOneTask) {
  for (std::size_t items = 1; items <= 30; ++items) {
    for (std::size_t chunk = 1; chunk <= items + 2; ++chunk) {
      std::size_t next = 0;
      for (std::size_t task = 0; task < items + 3; ++task) {
        const ItemRange range = items_in_task(task, chunk, items);
        if (range.size() == 0) continue;
        EXPECT_EQ(range.first, next);
        EXPECT_LE(range.size(), chunk);
        next = range.end;
      }
      EXPECT_EQ(next, items);
    }
  }
}

JobRequest request(std::size_t items, std::size_t chunk = 0, unsigned jobs = 4) {
  return {.command = {"/opt/my tools/skycap", "campaign", "/data/it's/c.yaml"},
          .out = "/data/out",
          .title = "Campaign c",
          .name = "c",
          .items = items,
          .chunk = chunk,
          .jobs = jobs};
}

TEST(SchedulerJob, SplitsRunsBySchedulerLimits) {
  const auto describe_split = [](EngineName engine, const JobRequest& requested) {
    const TaskSplit tasks = split(engine, requested);
    return std::vector<std::size_t>{tasks.tasks, tasks.chunk};
  };
  EXPECT_THAT(describe_split(EngineName::slurm, request(1000)), ElementsAre(1000, 1));
  EXPECT_THAT(describe_split(EngineName::slurm, request(1001)), ElementsAre(501, 2));
  EXPECT_THAT(describe_split(EngineName::slurm, request(100, 30)), ElementsAre(4, 30));
  EXPECT_THAT(describe_split(EngineName::mpi, request(10)), ElementsAre(4, 3));
  EXPECT_THAT(describe_split(EngineName::mpi, request(2)), ElementsAre(2, 1));
  EXPECT_THAT(describe_split(EngineName::parallel, request(7)), ElementsAre(7, 1));
}

// A shell parses the quoted arguments and prints them.
TEST(SchedulerJob, QuotesShellArgumentsInScripts) {
  const std::string script =
      job_script("t", {}, {"printf", "<%s>", "a b", "it's", "$HOME `x` \\ \"q\"", "-n", ""});
  EXPECT_THAT(script, testing::StartsWith("#!/bin/sh\n# t, written by skycap"));
  const auto result = support::run_external_program({"sh", "-c", script}, "/");
  EXPECT_EQ(result.output, "<a b><it's><$HOME `x` \\ \"q\"><-n><>");
}

TEST(SchedulerJob, HasSubmitCommandAndFiles) {
  const EngineJob slurm = engine_job(EngineName::slurm, request(5, 2));
  EXPECT_EQ(slurm.command.front(), "sbatch");
  EXPECT_EQ(slurm.command.back(), "/data/out/slurm.sh");
  EXPECT_THAT(slurm.files.at(0).text, HasSubstr("#SBATCH --array=0-2\n"));
  EXPECT_THAT(slurm.files.at(0).text, HasSubstr("#SBATCH --requeue\n"));
  EXPECT_THAT(slurm.files.at(0).text,
              HasSubstr("exec '/opt/my tools/skycap' 'campaign' '/data/it'\\''s/c.yaml'"));
  const EngineJob mpi = engine_job(EngineName::mpi, request(10));
  EXPECT_THAT(mpi.command, testing::IsSupersetOf({"mpirun", "-n", "4", "--index", "mpi", "--chunk",
                                                  "3", "/data/it's/c.yaml"}));
  const EngineJob parallel = engine_job(EngineName::parallel, request(3));
  EXPECT_EQ(parallel.files.at(1).text, "0\n1\n2\n");
}

}  // namespace
}  // namespace skycap::missions::batch
