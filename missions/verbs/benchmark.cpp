#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/output_folder.h"
#include "geometry/parallel.h"
#include "missions/benchmark/benchmark_report.h"
#include "missions/benchmark/benchmark_results.h"
#include "missions/benchmark/contestants.h"
#include "missions/benchmark/trial_files.h"
#include "missions/derived/resolved_mission.h"
#include "missions/file/json_text.h"
#include "missions/file/mission_keys.h"
#include "missions/run/feasibility.h"
#include "missions/scene/survey_scene.h"
#include "missions/verbs/verbs.h"
#include "missions/verbs/write_page.h"
#include "missions/version.h"

namespace skycap::missions::verbs {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

/// A mission as one of the contestants surveys it, and its trials so far, by seed.
struct Entry {
  fs::path file;
  const benchmark::Contestant* contestant;
  file::Mission mission;
  std::vector<std::optional<benchmark::Trial>> trials;
};

/// One survey to be run.
struct WorkItem {
  Entry* entry;
  std::size_t trial;
};

std::vector<const benchmark::Contestant*> chosen_contestants(
    const std::vector<std::string>& names) {
  std::vector<const benchmark::Contestant*> chosen;
  std::string known;
  for (const benchmark::Contestant& contestant : benchmark::contestants()) {
    known += (known.empty() ? "" : ", ") + contestant.name;
    const bool is_named = std::ranges::find(names, contestant.name) != names.end();
    const bool is_in_all = contestant.is_in_all && std::ranges::find(names, "all") != names.end();
    if (is_named || is_in_all) chosen.push_back(&contestant);
  }
  for (const std::string& name : names) {
    if (name == "all" || benchmark::find_contestant(name)) continue;
    throw Error(ErrorKind::bad_usage,
                "--planners: there is no planner '" + name + "'; give all or some of " + known);
  }
  return chosen;
}

/// The mission as that contestant surveys it. Nothing is flown: as in the paper, the sensor moves
/// freely.
file::Mission mission_for(const fs::path& file, const benchmark::Contestant& contestant,
                          const std::vector<file::KeyOverride>& given) {
  std::vector<file::KeyOverride> overrides{{"benchmark", "flight.vehicle", "none"}};
  overrides.insert(overrides.end(), given.begin(), given.end());
  const auto& names = file::find_key("planner.name")->choices;
  if (std::ranges::find(names, contestant.name) != names.end()) {
    overrides.push_back({"--planners", "planner.name", contestant.name});
  }
  return derived::read_mission(file, overrides);
}

std::vector<Entry> entries_of(const BenchmarkOptions& options) {
  std::vector<Entry> entries;
  std::map<std::string, fs::path> file_of_name;
  for (const fs::path& file : options.missions) {
    for (const benchmark::Contestant* contestant : chosen_contestants(options.planners)) {
      Entry entry{file, contestant, mission_for(file, *contestant, options.overrides), {}};
      entry.trials.resize(options.trials);
      const auto [known, is_new] = file_of_name.emplace(entry.mission.name, file);
      if (!is_new && known->second != file) {
        throw Error(ErrorKind::bad_usage, file.string() + " and " + known->second.string() +
                                              " have the same name; give one of them a name key");
      }
      entries.push_back(std::move(entry));
    }
  }
  return entries;
}

std::string fingerprint(const Entry& entry) {
  return benchmark::trial_fingerprint(entry.mission, entry.contestant->name);
}

fs::path item_file(const fs::path& folder, const Entry& entry, std::size_t trial) {
  return folder / "items" / entry.mission.name / entry.contestant->name /
         ("seed_" + std::to_string(entry.mission.seed + trial) + ".json");
}

std::string manifest(const BenchmarkOptions& options, const std::vector<Entry>& entries,
                     bool is_whole) {
  Json json{{"version", version},
            {"trials", options.trials},
            {"threads", geometry::thread_count(options.threads)},
            {"complete", is_whole},
            {"entries", Json::array()}};
  for (const Entry& entry : entries) {
    json["entries"].push_back({{"mission", entry.mission.name},
                               {"file", entry.file.string()},
                               {"planner", entry.contestant->name},
                               {"first_seed", entry.mission.seed},
                               {"fingerprint", fingerprint(entry)}});
  }
  return file::json_text(json);
}

/// How far the work is and how long it will take, from the mean duration of surveys of the same
/// entry, or of any where none is over yet.
class Progress {
 public:
  Progress(const BenchmarkOptions& options, const Console& console, unsigned threads)
      : line_(console, options.is_quiet), threads_(threads) {}

  void say(const std::string& text) { line_.show(text); }

  void start(const std::vector<WorkItem>& items) {
    total_ = items.size();
    done_ = 0;
    for (const WorkItem& item : items) ++left_[item.entry];
  }

  void item_done(const WorkItem& item, double seconds) {
    const std::lock_guard lock(mutex_);
    ++done_;
    --left_[item.entry];
    for (Duration* known : {&durations_[item.entry], &of_any_}) {
      known->seconds += seconds;
      ++known->count;
    }
    double work = 0.0;
    for (const auto& [entry, left] : left_) {
      const Duration& own = durations_[entry];
      const Duration& known = own.count > 0 ? own : of_any_;
      work += static_cast<double>(left) * known.seconds / known.count;
    }
    const auto minutes = static_cast<int>(std::ceil(work / threads_ / 60.0));
    line_.show(fmt::format("benchmark: {} of {} surveys, about {} min left; {} {}", done_, total_,
                           minutes, item.entry->mission.name, item.entry->contestant->title));
  }

 private:
  struct Duration {
    double seconds = 0.0;
    int count = 0;
  };
  ProgressLine line_;
  double threads_;
  std::mutex mutex_;
  std::size_t total_ = 0, done_ = 0;
  std::map<const Entry*, std::size_t> left_;
  std::map<const Entry*, Duration> durations_;
  Duration of_any_;
};

/// A mission's scene, made ready if a survey of it is still to be run.
struct PreparedScene {
  scene::SurveyScene scene;
  benchmark::SceneTruth truth;
};

class Benchmark {
 public:
  Benchmark(const BenchmarkOptions& options, const Console& console)
      : options_(options),
        console_(console),
        entries_(entries_of(options)),
        folder_(options.out.value_or("results/benchmark")),
        progress_(options, console, geometry::thread_count(options.threads)) {}

  int run() {
    run_entries([](const Entry& entry) { return !entry.contestant->is_volumetric; });
    take_view_limits_from_see();
    run_entries([](const Entry& entry) { return entry.contestant->is_volumetric; });
    report();
    return is_whole() ? 0 : 1;
  }

 private:
  template <typename Choice>
  void run_entries(Choice is_chosen) {
    std::vector<WorkItem> items;
    // Seeds outermost: whoever stops early has some trials of everything.
    for (std::size_t trial = 0; trial < options_.trials; ++trial) {
      for (Entry& entry : entries_) {
        if (!is_chosen(entry)) continue;
        entry.trials[trial] =
            benchmark::finished_trial(item_file(folder_.path(), entry, trial), fingerprint(entry));
        if (!entry.trials[trial]) items.push_back({&entry, trial});
      }
    }
    prepare_scenes(items);
    progress_.start(items);
    geometry::parallel_for(items.size(), options_.threads,
                           [&](std::size_t i) { run_item(items[i]); });
  }

  void prepare_scenes(const std::vector<WorkItem>& items) {
    for (const WorkItem& item : items) {
      if (console_.stop.stop_requested()) return;
      auto& prepared = scenes_[item.entry->mission.name];
      if (prepared) continue;
      progress_.say(item.entry->mission.name + ": measuring what could be covered at all");
      scene::SurveyScene scene(item.entry->mission, item.entry->file.parent_path());
      run::require_feasible(item.entry->mission, scene, options_.threads);
      benchmark::SceneTruth truth = benchmark::scene_truth(scene, options_.threads, console_.stop);
      prepared.reset(new PreparedScene{std::move(scene), std::move(truth)});
    }
  }

  void run_item(const WorkItem& item) {
    if (console_.stop.stop_requested()) return;
    Entry& entry = *item.entry;
    const auto start = Clock::now();
    const PreparedScene& prepared = *scenes_.at(entry.mission.name);
    try {
      auto trial = entry.contestant->run(entry.mission, prepared.scene, prepared.truth,
                                         entry.mission.seed + item.trial, console_.stop);
      if (!trial) return;
      benchmark::write_trial(item_file(folder_.path(), entry, item.trial), fingerprint(entry),
                             *trial);
      entry.trials[item.trial] = std::move(trial);
    } catch (const Error& error) {
      throw Error(error.kind(),
                  entry.file.string() + ", " + entry.contestant->name + ": " + error.what());
    }
    progress_.item_done(item, std::chrono::duration<double>(Clock::now() - start).count());
  }

  /// Paper §IV-B: a volumetric survey has as many views as SEE needed at most.
  void take_view_limits_from_see() {
    for (Entry& entry : entries_) {
      if (!entry.contestant->is_volumetric || entry.mission.volumetric.view_limit) continue;
      std::size_t most = 0;
      for (const Entry& other : entries_) {
        if (other.mission.name != entry.mission.name || other.contestant->name != "see") continue;
        for (const auto& trial : other.trials) most = std::max(most, trial ? trial->views : 0);
      }
      if (most > 0) entry.mission.volumetric.view_limit = most;
    }
  }

  bool is_whole() const {
    return std::ranges::all_of(entries_, [](const Entry& entry) {
      return std::ranges::all_of(entry.trials, [](const auto& trial) { return trial.has_value(); });
    });
  }

  void report() {
    std::vector<benchmark::BenchmarkCell> cells;
    for (const Entry& entry : entries_) {
      benchmark::BenchmarkCell cell{entry.mission.name, entry.contestant->name, {}};
      for (const auto& trial : entry.trials) {
        if (trial) cell.trials.push_back(*trial);
      }
      cells.push_back(std::move(cell));
    }
    folder_.write("manifest.json", manifest(options_, entries_, is_whole()));
    folder_.write("trials.csv", benchmark::all_trials_csv(cells));
    folder_.write("table1.csv", benchmark::table_1_csv(cells));
    folder_.write("results.json", benchmark::results_json(cells));
    const std::string markdown = benchmark::report_markdown(cells);
    folder_.write("report.md", markdown);
    progress_.say("");
    write_page("results.json", options_.has_report, folder_, console_);
    folder_.commit();
    if (options_.is_quiet) return;
    console_.out << markdown << "\nresults: " << folder_.path().string() << "\n" << std::flush;
  }

  const BenchmarkOptions& options_;
  const Console& console_;
  std::vector<Entry> entries_;
  geometry::OutputFolder folder_;
  Progress progress_;
  std::map<std::string, std::unique_ptr<PreparedScene>> scenes_;
};

}  // namespace

int benchmark(const BenchmarkOptions& options, const Console& console) {
  const HoldsResults results(console);
  return Benchmark(options, console).run();
}

}  // namespace skycap::missions::verbs
