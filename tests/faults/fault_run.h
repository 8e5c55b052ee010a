/// Runs the program with an injected fault (injector.cpp) and checks its results.
///
/// With FAULT_POINTS=all in the environment, all points on the disk are tried instead of a sample.
/// Memory faults are always sampled. tests/faults/run sets this variable.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <sys/types.h>

#include "tests/support/temporary_folder.h"

namespace skycap::faults {

/// File names and contents, without durations, which differ between runs. Of JSON files it contains
/// the lines with the seed and the completion flag. Of CSV files it contains all columns except the
/// last, and of reports the first line. Of folders, such as those of finished trials, it contains
/// the name. Files for resuming an unfinished survey are excluded.
using Content = std::map<std::string, std::string>;

Content read_content(const std::filesystem::path& folder);

struct Fault {
  std::string kind;  ///< value of FAULT_KIND
  long at = 0;
  std::filesystem::path count;  ///< file for the number of steps
};

/// Starts the program. Its output goes to the descriptor `output`, or is discarded.
pid_t start(const std::vector<std::string>& arguments, const Fault& fault, int output = -1);

/// Returns the exit code, or 128 plus the signal number.
int wait_for_exit_code(pid_t program);

int run(const std::vector<std::string>& arguments, const Fault& fault);

/// Command that changes a folder and runs with a fault. Returns an exit code.
using Change = std::function<int(const std::filesystem::path& out, const Fault& fault)>;

/// Initial folder and the command that changes it.
struct Trial {
  std::filesystem::path old_folder;
  Change change;
  /// False if the command never overwrites a result. A second run then fails.
  bool can_be_repeated = true;
  /// Accepts contents other than the complete old and new results, if the exit code reports a
  /// failure.
  std::function<bool(const Content& found, const Content& after)> may_also_be;
};

/// Returns true if the result is a survey whose route did not fit on the disk.
bool is_survey_without_route(const Content& found, const Content& after);

/// Tries about `sample` evenly spaced faults of each kind, or all faults with FAULT_POINTS=all.
/// Afterwards the folder contains the complete old or the complete new result, and at most the
/// files for resuming a survey. A second run after a crash produces the new result. The program
/// only ends by a signal if it is killed or has no memory at its start.
void try_faults(const Trial& trial, const std::vector<std::string>& kinds, long sample);

/// Command whose result depends on the seed: 1 gives the old result, 2 the new one.
using Command =
    std::function<std::vector<std::string>(const std::string& seed, const std::filesystem::path&)>;

void try_faults(const Command& command, const std::vector<std::string>& kinds, long sample);

/// Tries faults on the disk in commands that can be interrupted. A second run always resumes and
/// completes the result.
void try_going_on(const Trial& trial, long sample);

inline constexpr long all = 1'000'000;

/// Missions whose surveys take half a second: a teapot with a length of 1 m,
extern const char* const quick;
/// and a house of 20 m with a flight and a route in every format.
extern const char* const flight_mission_text;

/// Survey with a flight, planned once for each seed. Input of the tested commands.
class Surveys {
 public:
  Surveys();
  std::filesystem::path operator[](const std::string& seed) const { return folder_.path() / seed; }
  const std::string& mission() const { return mission_; }

 private:
  testing_support::TemporaryFolder folder_;
  std::string mission_;
};

}  // namespace skycap::faults
