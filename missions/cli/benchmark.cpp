#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/output_folder.h"
#include "geometry/parallel.h"
#include "missions/batch/benchmark/benchmark_report.h"
#include "missions/batch/benchmark/methods.h"
#include "missions/batch/benchmark/other_results.h"
#include "missions/batch/benchmark/uniform_comparison.h"
#include "missions/cli/benchmark_inspections.h"
#include "missions/cli/commands.h"
#include "missions/cli/survey_batch.h"
#include "missions/cli/write_page.h"
#include "missions/config/mission_document.h"
#include "missions/config/mission_reader.h"
#include "missions/config/resolve.h"
#include "missions/support/json_text.h"
#include "missions/version.h"
#include "sim/models/models.h"

namespace skycap::missions::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Mission with a contestant, and its trials so far, ordered by seed.
struct Entry {
  std::string title;
  const batch::Method* method;
  /// Setup of each trial; shared, or one per generated scene.
  std::vector<std::shared_ptr<batch::Setup>> setups;
  std::vector<std::optional<batch::Trial>> trials;
  std::optional<std::size_t> set_views = {};  ///< number of views of a fixed set

  std::string folder_name() const {
    return set_views ? fmt::format("{}_{}", method->name, *set_views) : method->name;
  }
  bool is_finished() const {
    return std::ranges::all_of(trials, [](const auto& trial) { return trial.has_value(); });
  }
  batch::BenchmarkCell cell() const {
    batch::BenchmarkCell result{title, method->name, {}, set_views};
    for (const auto& trial : trials) {
      if (trial) result.trials.push_back(*trial);
    }
    return result;
  }
  std::uint64_t seed(std::size_t trial) const { return setups[trial]->mission.run.seed + trial; }
};

std::vector<const batch::Method*> selected_methods(const std::vector<std::string>& names) {
  try {
    return batch::methods_by_name(names);
  } catch (const Error& error) {
    throw Error(error.kind(), std::string("--planners: ") + error.what());
  }
}

/// Returns the model families that replace the missions' scenes. An empty name keeps the mission's
/// scene.
std::vector<std::string> chosen_scenes(const std::vector<std::string>& names) {
  if (names.empty()) return {""};
  const auto families = sim::model_families();
  if (names == std::vector<std::string>{"all"}) return {families.begin(), families.end()};
  for (const std::string& name : names) {
    if (std::ranges::find(families, name) != families.end()) continue;
    throw Error(ErrorKind::bad_usage,
                fmt::format("--scenes: unknown family '{}'; expected all or {}", name,
                            fmt::join(families, ", ")));
  }
  return names;
}

/// Creates the entry of a planner on a mission. With a model family `scene`, each trial has its own
/// generated scene.
Entry make_entry(const fs::path& file, const batch::Method* method, const std::string& scene,
                 const BenchmarkOptions& options, const config::Report& report) {
  // By default no vehicle is used: as in the paper, the sensor moves freely.
  std::vector<config::KeyOverride> overrides{{"benchmark", "flight.vehicle", "none"}};
  overrides.insert(overrides.end(), options.overrides.begin(), options.overrides.end());
  Entry entry{"", method, {}, {}};
  entry.trials.resize(options.trials);
  if (scene.empty()) {
    const auto setup = std::make_shared<batch::Setup>(
        batch::read_setup(file, method, "--planners", overrides, report));
    entry.title = setup->title;
    entry.setups.assign(options.trials, setup);
    return entry;
  }
  overrides.push_back({"--scenes", "scene.model", "builtin:" + scene});
  for (std::size_t trial = 0; trial < options.trials; ++trial) {
    batch::Setup setup = batch::read_setup(file, method, "--planners", overrides, report);
    const std::string seed = std::to_string(setup.mission.run.seed + trial);
    setup.mission = config::with_keys(setup.mission, {{"--scenes", "scene.seed", seed}});
    entry.title = options.missions.size() == 1 ? scene : setup.title + " " + scene;
    setup.title = fmt::format("{} {}", entry.title, seed);
    setup.name_kind_and_fingerprint();
    entry.setups.push_back(std::make_shared<batch::Setup>(std::move(setup)));
  }
  return entry;
}

std::vector<Entry> make_entries(const BenchmarkOptions& options, const Console& console) {
  ProgressLine progress(console, options.is_quiet);
  std::vector<Entry> entries;
  std::map<std::string, fs::path> files_by_title;
  const std::vector<std::string> scenes = chosen_scenes(options.scenes);
  for (const fs::path& file : options.missions) {
    for (const std::string& scene : scenes) {
      for (const batch::Method* method : selected_methods(options.planners)) {
        Entry entry = make_entry(file, method, scene, options, progress.progress_callback());
        const auto [known, is_new] = files_by_title.emplace(entry.title, file);
        if (!is_new && known->second != file) {
          throw Error(ErrorKind::bad_usage,
                      file.string() + " and " + known->second.string() +
                          " have the same name; set the key 'name' in one of them");
        }
        entries.push_back(std::move(entry));
      }
    }
  }
  return entries;
}

fs::path item_file(const fs::path& folder, const Entry& entry, std::uint64_t seed) {
  return folder / "items" / entry.title / entry.folder_name() /
         ("seed_" + std::to_string(seed) + ".json");
}

bool has_view_limit(const batch::Setup& setup) {
  return setup.mission.text("volumetric.view_limit") != "-";
}

std::string manifest(const BenchmarkOptions& options, const std::vector<Entry>& entries,
                     bool is_whole) {
  Json json{{"version", version},
            {"trials", options.trials},
            {"threads", geometry::thread_count(options.threads)},
            {"complete", is_whole},
            {"entries", Json::array()}};
  for (const Entry& entry : entries) {
    const batch::Setup& first = *entry.setups.front();
    json["entries"].push_back({{"mission", entry.title},
                               {"file", first.file.string()},
                               {"planner", entry.folder_name()},
                               {"first_seed", first.mission.run.seed},
                               {"fingerprint", first.fingerprint}});
  }
  return support::json_text(json);
}

/// The results of other programs. Each is of a mission that is compared here, by a planner of
/// another name.
std::vector<batch::BenchmarkCell> results_of_others(const BenchmarkOptions& options,
                                                    const std::vector<Entry>& entries) {
  std::vector<batch::BenchmarkCell> all;
  for (const fs::path& file : options.also) {
    for (batch::BenchmarkCell& cell : batch::read_other_results(file)) {
      const auto fail = [&](const std::string& what) {
        throw Error(ErrorKind::bad_usage, file.string() + ": " + what);
      };
      if (std::ranges::find(entries, cell.mission, &Entry::title) == entries.end()) {
        fail("mission '" + cell.mission + "' is not part of this benchmark; expected " +
             entries.front().title + (entries.size() > 1 ? " or another of its missions" : ""));
      }
      const auto is_same = [&](const batch::BenchmarkCell& other) {
        return other.mission == cell.mission && other.planner == cell.planner;
      };
      if (batch::find_method(cell.planner) != nullptr || std::ranges::any_of(all, is_same)) {
        fail("planner '" + cell.planner + "' is listed twice; rename it in one of the files");
      }
      all.push_back(std::move(cell));
    }
  }
  return all;
}

class Benchmark {
 public:
  Benchmark(const BenchmarkOptions& options, const Console& console)
      : options_(options),
        console_(console),
        entries_(make_entries(options, console)),
        others_(results_of_others(options, entries_)),
        fixed_(take_fixed_views(entries_)),
        folder_(options.out.value_or("results/benchmark")),
        runner_("benchmark", console, options.is_quiet, options.threads) {}

  int run() {
    run_entries([](const Entry& entry) { return !entry.method->is_volumetric; });
    derive_view_limits_from_see();
    run_entries([](const Entry& entry) { return entry.method->is_volumetric; });
    run_fixed_views();
    report();
    return is_whole() ? 0 : 1;
  }

 private:
  template <typename Choice>
  void run_entries(Choice is_chosen) {
    std::vector<batch::BatchItem> items;
    std::vector<std::optional<batch::Trial>*> trials;
    // The outer loop is over seeds, so that an interrupted run has trials of every entry.
    for (std::size_t trial = 0; trial < options_.trials; ++trial) {
      for (Entry& entry : entries_) {
        if (!is_chosen(entry)) continue;
        const std::uint64_t seed = entry.seed(trial);
        items.push_back({entry.setups[trial], seed, item_file(folder_.path(), entry, seed)});
        trials.push_back(&entry.trials[trial]);
      }
    }
    batch::Records records = runner_.run(items);
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (records[i]) *trials[i] = std::move(records[i]->trial);
    }
  }

  /// Limits volumetric surveys to the maximum number of views used by SEE (paper §IV-B).
  void derive_view_limits_from_see() {
    for (Entry& entry : entries_) {
      if (!entry.method->is_volumetric || has_view_limit(*entry.setups.front())) continue;
      std::size_t max = 0;
      for (const Entry& other : entries_) {
        if (other.title != entry.title || other.method->name != "see") continue;
        for (const auto& trial : other.trials) max = std::max(max, trial ? trial->views : 0);
      }
      if (max == 0) continue;
      for (const auto& setup : entry.setups) {
        setup->mission = config::with_keys(
            setup->mission, {{"benchmark", "volumetric.view_limit", std::to_string(max)}});
        setup->name_kind_and_fingerprint();
      }
    }
  }

  bool is_whole() const { return std::ranges::all_of(entries_, &Entry::is_finished); }

  /// Removes the entries of fixed views, which are templates of their sets.
  static std::vector<Entry> take_fixed_views(std::vector<Entry>& entries) {
    std::vector<Entry> fixed;
    for (const Entry& entry : entries) {
      if (entry.method->has_fixed_views) fixed.push_back(entry);
    }
    std::erase_if(entries, [](const Entry& entry) { return entry.method->has_fixed_views; });
    return fixed;
  }

  /// Adds the entry of a fixed set with `views` views, unless it exists or the mission allows fewer
  /// views. Returns whether it was added.
  bool add_set(const Entry& fixed, std::size_t views) {
    const auto is_same = [&](const Entry& entry) {
      return entry.title == fixed.title && entry.method == fixed.method && entry.set_views == views;
    };
    if (std::ranges::any_of(entries_, is_same)) return false;
    if (views > fixed.setups.front()->mission.survey().limits.max_views) return false;
    Entry entry{fixed.title, fixed.method, {}, {}, views};
    entry.trials.resize(fixed.trials.size());
    std::map<const batch::Setup*, std::shared_ptr<batch::Setup>> changed;
    for (const auto& setup : fixed.setups) {
      std::shared_ptr<batch::Setup>& own = changed[setup.get()];
      if (!own) {
        own = std::make_shared<batch::Setup>(*setup);
        own->mission = config::with_keys(setup->mission,
                                         {{"benchmark", "uniform.views", std::to_string(views)}});
        own->name_kind_and_fingerprint();
      }
      entry.setups.push_back(own);
    }
    entries_.push_back(std::move(entry));
    return true;
  }

  /// Runs the fixed sets: the given numbers of views; for uniform also the mean number of views of
  /// each planner, and by bisection the least number that reaches its coverage.
  void run_fixed_views() {
    const auto run_sets = [&] {
      run_entries([](const Entry& entry) { return entry.set_views && !entry.is_finished(); });
    };
    const auto planners_on = [&](const std::string& title) {
      std::vector<batch::BenchmarkCell> planners;
      for (const batch::BenchmarkCell& cell : cells()) {
        if (cell.mission == title && !cell.set_views && !cell.trials.empty()) {
          planners.push_back(cell);
        }
      }
      return planners;
    };
    for (const Entry& fixed : fixed_) {
      for (const std::size_t views : options_.set_views) add_set(fixed, views);
      if (fixed.method->name != "uniform") continue;
      for (const auto& cell : planners_on(fixed.title)) {
        add_set(fixed, batch::compute_same_views(cell));
      }
    }
    run_sets();
    for (bool has_new = true; has_new && is_whole();) {
      has_new = false;
      const std::vector<batch::BenchmarkCell> known = cells();
      for (const Entry& fixed : fixed_) {
        if (fixed.method->name != "uniform") continue;
        for (const auto& cell : planners_on(fixed.title)) {
          const auto views = batch::next_set_views(cell, known);
          if (views && add_set(fixed, *views)) has_new = true;
        }
      }
      if (has_new) run_sets();
    }
  }

  /// Returns the cells of all entries, sets ordered by their number of views, and of others.
  std::vector<batch::BenchmarkCell> cells() const {
    std::vector<batch::BenchmarkCell> all;
    for (const Entry& entry : entries_) all.push_back(entry.cell());
    std::ranges::stable_sort(all, [](const auto& a, const auto& b) {
      return a.set_views.value_or(0) < b.set_views.value_or(0);
    });
    all.insert(all.end(), others_.begin(), others_.end());
    return all;
  }

  void report() {
    folder_.write("manifest.json", manifest(options_, entries_, is_whole()));
    const std::string markdown =
        batch::stage_tables(cells(), "Benchmark", batch::Times::shown, folder_);
    runner_.clear();
    write_page("results.json", options_.has_report, folder_, console_);
    folder_.commit();
    if (options_.is_quiet) return;
    console_.out << markdown << "\nresults: " << folder_.path().string() << "\n" << std::flush;
  }

  const BenchmarkOptions& options_;
  const Console& console_;
  std::vector<Entry> entries_;
  std::vector<batch::BenchmarkCell> others_;
  std::vector<Entry> fixed_;  ///< templates of the fixed sets
  geometry::OutputFolder folder_;
  SurveyRunner runner_;
};

}  // namespace

int benchmark(const BenchmarkOptions& options, const Console& console) {
  const PendingResultsGuard results(console);
  if (config::read_mission_document(options.missions.front(), options.overrides).is_inspection()) {
    return benchmark_inspections(options, console);
  }
  return Benchmark(options, console).run();
}

}  // namespace skycap::missions::cli
