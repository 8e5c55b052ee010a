#include "missions/cli/benchmark_inspections.h"

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/output_folder.h"
#include "missions/config/inspection_rules.h"
#include "missions/config/mission_document.h"
#include "missions/config/resolve.h"
#include "missions/inspection/flight_file.h"
#include "missions/inspection/flight_table.h"
#include "missions/inspection/inspection_mission.h"
#include "missions/inspection/inspection_site.h"
#include "missions/support/json_text.h"
#include "missions/version.h"

namespace skycap::missions::cli {
namespace {

using inspection::ComparedFlight;

/// Returns the processor time of this process [s].
double processor_time() {
  return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

/// Flights of other programs by the name of the mission.
using OtherFlights = std::multimap<std::string, std::filesystem::path>;

OtherFlights parse_others(const BenchmarkOptions& options) {
  OtherFlights flights;
  for (const std::filesystem::path& also : options.also) {
    const std::string text = also.string();
    const std::size_t sign = text.find('=');
    if (sign == std::string::npos || sign == 0 || sign + 1 == text.size()) {
      throw Error(ErrorKind::bad_usage,
                  "--also " + text +
                      ": must be MISSION=FILE for inspections, such as --also tower=flight.csv");
    }
    flights.emplace(text.substr(0, sign), text.substr(sign + 1));
  }
  return flights;
}

config::MissionSetup read_inspection_mission(const std::filesystem::path& file,
                                             const BenchmarkOptions& options,
                                             const config::Report& report) {
  config::MissionSetup setup = config::read_mission(file, options.overrides, report);
  if (!setup.document->is_inspection()) {
    throw Error(ErrorKind::bad_usage, file.string() +
                                          ": is not an inspection, but the first mission is one; "
                                          "compare them in separate benchmarks");
  }
  setup.run.threads = options.threads;
  return setup;
}

class InspectionBenchmark {
 public:
  InspectionBenchmark(const BenchmarkOptions& options, const Console& console)
      : options_(options),
        console_(console),
        progress_(console, options.is_quiet),
        others_(parse_others(options)) {
    if (!options.scenes.empty()) {
      throw Error(ErrorKind::bad_usage,
                  "--scenes conflicts with inspections, whose structure the mission names; remove "
                  "the option");
    }
    for (const std::filesystem::path& file : options.missions) {
      setups_.push_back(read_inspection_mission(file, options, progress_.progress_callback()));
      if (std::ranges::count(setups_, setups_.back().name, &config::MissionSetup::name) > 1) {
        throw Error(ErrorKind::bad_usage, file.string() + ": the name '" + setups_.back().name +
                                              "' is used twice; set the key 'name'");
      }
    }
    for (const auto& [mission, file] : others_) {
      if (std::ranges::find(setups_, mission, &config::MissionSetup::name) == setups_.end()) {
        throw Error(ErrorKind::bad_usage, "--also " + mission + "=" + file.string() +
                                              ": no mission has this name; expected " +
                                              setups_.front().name);
      }
    }
  }

  int run() {
    geometry::OutputFolder folder(options_.out.value_or("results/benchmark"));
    for (const config::MissionSetup& setup : setups_) compare(setup);
    const std::string table = inspection::comparison_table(flights_);
    folder.write("report.md", table);
    folder.write("inspections.json",
                 support::json_text(
                     {{"version", version}, {"flights", inspection::comparison_json(flights_)}}));
    folder.commit();
    progress_.clear();
    if (!options_.is_quiet) {
      console_.out << table << "\nresults: " << folder.path().string() << "\n" << std::flush;
    }
    const bool has_flight = std::ranges::any_of(
        flights_, [](const ComparedFlight& flight) { return flight.evaluation.has_value(); });
    return has_flight ? 0 : 1;
  }

 private:
  void skip(const config::MissionSetup& setup, const std::string& flight, const Error& error) {
    if (error.kind() != ErrorKind::bad_file)
      throw Error(error.kind(), setup.name + ": " + error.what());
    flights_.push_back({setup.name, flight, std::nullopt, error.what(), std::nullopt});
  }

  void compare(const config::MissionSetup& setup) {
    progress_.show(setup.name + ": reading the structure");
    std::optional<inspection::InspectionSpace> space;
    try {
      space.emplace(setup);
    } catch (const Error& error) {
      return skip(setup, "all flights", error);
    }
    const auto [begin, end] = others_.equal_range(setup.name);
    for (auto other = begin; other != end; ++other) {
      const std::string name = other->second.filename().string();
      progress_.show(setup.name + ": evaluating " + name);
      try {
        const auto samples = inspection::read_flight_csv(other->second);
        flights_.push_back({setup.name, name, evaluate_inspection(setup, *space, samples).flight,
                            "", std::nullopt});
      } catch (const Error& error) {
        skip(setup, name, error);
      }
    }
    for (std::size_t trial = 0; trial < options_.trials; ++trial) plan(setup, *space, trial);
  }

  void plan(const config::MissionSetup& setup, const inspection::InspectionSpace& space,
            std::size_t trial) {
    const std::uint64_t seed = setup.run.seed + trial;
    const std::string name = fmt::format("skycap, seed {}", seed);
    const double begin = processor_time();
    try {
      survey::inspection::InspectionPlan plan = survey::inspection::plan_inspection(
          config::inspection_options(*setup.document), space.site(),
          {seed, setup.run.threads, console_.stop, [&](const std::string& what) {
             progress_.show(setup.name + ", " + name + ": " + what);
           }});
      flights_.push_back(
          {setup.name, name, std::move(plan.evaluation), "", processor_time() - begin});
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::bad_geometry) throw;
      flights_.push_back({setup.name, name, std::nullopt, error.what(), std::nullopt});
    }
  }

  const BenchmarkOptions& options_;
  const Console& console_;
  ProgressLine progress_;
  OtherFlights others_;
  std::vector<config::MissionSetup> setups_;
  std::vector<ComparedFlight> flights_;
};

}  // namespace

int benchmark_inspections(const BenchmarkOptions& options, const Console& console) {
  return InspectionBenchmark(options, console).run();
}

}  // namespace skycap::missions::cli
