/// The program with a fault injected (injector.cpp), and what must be true of its results then.
///
/// With FAULT_POINTS=all in the environment all points on the disk are tried, not a sample (of
/// memory it is always one): tests/faults/run does so.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <sys/types.h>

#include "tests/support/temporary_folder.h"

namespace skycap::faults {

/// Names, and contents without what differs from run to run, which is durations: of JSON files the
/// lines that tell the seed and whether the run was complete, of CSV files all columns but the
/// last, of reports the first line. Of folders, such as those of finished trials, the name. What an
/// unfinished survey is gone on with is no part of it.
using Content = std::map<std::string, std::string>;

Content read_content(const std::filesystem::path& folder);

struct Fault {
  std::string kind;  ///< FAULT_KIND
  long at = 0;
  std::filesystem::path count;  ///< where the number of steps goes
};

/// Starts the program; what it says goes to `output`, or nowhere.
pid_t start(const std::vector<std::string>& arguments, const Fault& fault, int output = -1);

/// Its exit code, or 128 and the signal that ended it.
int wait_for_exit_code(pid_t program);

int run(const std::vector<std::string>& arguments, const Fault& fault);

/// What changes a folder, and is run with a fault. Returns an exit code.
using Change = std::function<int(const std::filesystem::path& out, const Fault& fault)>;

/// A folder as it was, and what changes it.
struct Trial {
  std::filesystem::path old_folder;
  Change change;
  /// False where a result is never written over: then a second run says so.
  bool can_be_repeated = true;
  /// What may stand but for the whole old and the whole new, if the exit code tells of it.
  std::function<bool(const Content& found, const Content& after)> may_also_be;
};

/// A survey whose route did not find room on the disk.
bool is_survey_without_route(const Content& found, const Content& after);

/// Tries about `sample` faults of each kind, evenly spread, or all with FAULT_POINTS=all: the
/// folder then holds the whole old result or the whole new one, and nothing else but what an
/// unfinished survey can go on from. Run again after it died, the program gives the new result.
/// Nothing but being killed, or having no memory to begin with, ends it by a signal.
void try_faults(const Trial& trial, const std::vector<std::string>& kinds, long sample);

/// A verb whose result depends on the seed: 1 gives the old one, 2 the new one.
using Command =
    std::function<std::vector<std::string>(const std::string& seed, const std::filesystem::path&)>;

void try_faults(const Command& command, const std::vector<std::string>& kinds, long sample);

/// The same, on the disk, for what may stop half-way: run again, whatever happened, it goes on to
/// where it would have been.
void try_going_on(const Trial& trial, long sample);

inline constexpr long all = 1'000'000;

/// Missions whose surveys take half a second: a teapot of a metre,
extern const char* const quick;
/// and a house of 20 m that is flown round, with a route in every format.
extern const char* const flight_mission_text;

/// A survey with a flight, planned once with each seed: what verbs read.
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
