#include "missions/batch/campaign/survey_batch.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <map>
#include <mutex>
#include <string_view>
#include <utility>

#include "geometry/io/file.h"
#include "geometry/parallel.h"
#include "missions/config/mission_keys.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/package/package.h"
#include "missions/simulation/feasibility.h"
#include "missions/support/number_text.h"
#include "survey/planners/planner_names.h"

namespace skycap::missions::batch {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::size_t max_setups = 64;  // per batch
constexpr const char* record_name = "item.json";

/// Reads ground truth stored by an earlier task. The first line is the attainable coverage or "-";
/// the second contains one digit per sample. Returns nullopt if the file is incomplete.
std::optional<SceneTruth> kept_truth(const fs::path& file, std::size_t samples) {
  std::error_code ignored;
  if (file.empty() || !fs::is_regular_file(file, ignored)) return std::nullopt;
  const std::string text = geometry::read_file(file);
  const std::size_t line = std::min(text.size(), text.find('\n'));
  SceneTruth truth;
  if (text.substr(0, line) != "-") {
    double attainable_coverage = -1.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + line, attainable_coverage);
    if (error != std::errc() || end != text.data() + line ||
        !(attainable_coverage >= 0.0 && attainable_coverage <= 1.0)) {
      return std::nullopt;
    }
    truth.attainable_coverage = attainable_coverage;
  }
  if (text.size() != line + 1 + samples) return std::nullopt;
  for (const char digit : text.substr(line + 1)) {
    if (digit != '0' && digit != '1') return std::nullopt;
    truth.is_visible.push_back(digit == '1' ? 1 : 0);
  }
  return truth;
}

void keep_truth(const fs::path& file, const SceneTruth& truth) {
  if (file.empty()) return;
  std::string text =
      (truth.attainable_coverage ? support::exact_text(*truth.attainable_coverage) : "-") + "\n";
  for (const std::uint8_t mark : truth.is_visible) text += mark != 0 ? '1' : '0';
  geometry::write_file(file, text);
}

/// Returns the stored or computed ground truth. With stored ground truth, the feasibility check is
/// skipped, because an earlier task has performed it.
SceneTruth make_truth(const Setup& setup, const evaluation::SurveyScene& scene, unsigned threads,
                      const std::stop_token& stop) {
  if (auto kept = kept_truth(setup.truth_file, scene.samples().points.size())) return *kept;
  simulation::require_feasible(setup.mission.simulation, scene, {setup.mission.run.seed, threads});
  SceneTruth truth = scene_truth(scene, threads, stop);
  if (!stop.stop_requested()) keep_truth(setup.truth_file, truth);
  return truth;
}

struct LoadedScene {
  evaluation::SurveyScene scene;
  SceneTruth truth;
};

/// Scene that is loaded on first use and released after its last use.
struct SceneSlot {
  std::mutex mutex;
  std::size_t uses = 0;
  std::shared_ptr<const LoadedScene> scene;
  std::optional<Error> failure;
};

class Runner {
 public:
  Runner(const std::vector<BatchItem>& items, unsigned threads, const std::stop_token& stop,
         const RunEvents& events)
      : items_(items),
        threads_(threads),
        stop_(stop),
        events_(events),
        records_(finished_items(items)) {}

  Records run() {
    std::vector<std::size_t> unfinished;
    for (std::size_t i = 0; i < items_.size(); ++i) {
      if (records_[i]) continue;
      unfinished.push_back(i);
      ++slots_[items_[i].setup->title].uses;
      if (events_.unfinished) events_.unfinished(items_[i]);
    }
    geometry::parallel_for(unfinished.size(), threads_, [&](std::size_t i) {
      if (stop_.stop_requested()) return;
      try {
        run(items_[unfinished[i]], records_[unfinished[i]]);
      } catch (const Error& error) {
        if (!events_.failed) throw;
        notify(events_.failed, error);
      }
    });
    return std::move(records_);
  }

 private:
  template <typename Event, typename... What>
  void notify(const Event& event, What&... what) {
    if (!event) return;
    const std::lock_guard lock(events_mutex_);
    event(what...);
  }

  void run(const BatchItem& item, std::optional<TrialRecord>& record) {
    std::optional<geometry::OutputFolder> folder;
    if (item.form != ItemOutput::file) {
      folder.emplace(item.record.parent_path());
      // Another program may have run the item before the lock was acquired.
      record = finished_trial(item.record, item.setup->fingerprint);
      if (record) return;
    }
    const auto loaded = load_scene(*item.setup);
    if (!loaded) return;
    std::optional<TrialRecord> finished;
    try {
      finished = survey(item, *loaded, folder);
    } catch (const Error& error) {
      throw Error(error.kind(), item.setup->file.string() + ", " + item.setup->method->name + ": " +
                                    error.what());
    }
    if (!finished) return;
    notify(events_.done, item, *finished);
    record = std::move(finished);
  }

  /// Returns the scene of a setup for one use, or null after a stop request. A loading error is
  /// thrown again on every call. All scenes together are loaded with `threads_` threads.
  std::shared_ptr<const LoadedScene> load_scene(const Setup& setup) {
    SceneSlot& slot = slots_.at(setup.title);
    const std::lock_guard lock(slot.mutex);
    if (slot.failure) throw Error(*slot.failure);
    if (stop_.stop_requested()) return nullptr;
    if (!slot.scene) {
      notify(events_.preparing, setup);
      const auto scenes = static_cast<unsigned>(slots_.size());
      const unsigned threads = std::max(1U, geometry::thread_count(threads_) / scenes);
      try {
        fs::path reached = setup.truth_file;
        if (!reached.empty()) reached += "_reached";
        evaluation::SurveyScene scene(setup.mission.simulation, setup.folder(), threads, reached);
        SceneTruth truth = make_truth(setup, scene, threads, stop_);
        if (stop_.stop_requested()) return nullptr;  // the ground truth is incomplete
        slot.scene.reset(new LoadedScene{std::move(scene), std::move(truth)});
      } catch (const Error& error) {
        slot.failure.emplace(error.kind(), setup.file.string() + ": " + error.what());
        throw Error(*slot.failure);
      }
    }
    return --slot.uses > 0 ? slot.scene : std::exchange(slot.scene, nullptr);
  }

  /// Runs an item and writes its result. Returns nullopt after a stop request.
  std::optional<TrialRecord> survey(const BatchItem& item, const LoadedScene& loaded,
                                    std::optional<geometry::OutputFolder>& folder) {
    const auto start = Clock::now();
    const Setup& setup = *item.setup;
    const session::SurveyRecord survey =
        setup.method->survey(setup.mission.simulation, loaded.scene, item.seed, stop_);
    if (survey.stop_reason == survey::StopReason::interrupted) return std::nullopt;
    if (item.form == ItemOutput::package) {
      stage_package(item, loaded, survey, *folder);
      if (stop_.stop_requested()) return std::nullopt;  // the route may be incomplete after a stop
      notify(events_.packaged, *folder);
    }
    const std::chrono::duration<double> time = Clock::now() - start;
    TrialRecord record{make_trial(survey, loaded.scene, loaded.truth), run_here(time.count())};
    const std::string text = trial_record_json(setup.fingerprint, record);
    if (folder) {
      // Other files in the folder belong to an earlier record.
      folder->replace([](std::string_view name) { return !name.starts_with("."); });
      folder->write(item.record.filename().string(), text);
      folder->commit();
    } else {
      geometry::write_file(item.record, text);
    }
    return record;
  }

  void stage_package(const BatchItem& item, const LoadedScene& loaded,
                     const session::SurveyRecord& survey, geometry::OutputFolder& folder) const {
    config::MissionSetup mission = item.setup->mission;
    mission.run.seed = item.seed;
    const package::CoverageFigures coverage =
        package::coverage_figures(mission.simulation, survey, loaded.scene, 1, stop_);
    package::stage_package(mission, survey, coverage, 1, folder, stop_);
  }

  const std::vector<BatchItem>& items_;
  unsigned threads_;
  const std::stop_token& stop_;
  const RunEvents& events_;
  Records records_;
  std::map<std::string, SceneSlot> slots_;  ///< by setup title
  std::mutex events_mutex_;
};

std::shared_ptr<const Setup> make_setup(const Manifest& manifest, const ManifestEntry& entry,
                                        const fs::path& out, const config::Report& report) {
  const Method* method = entry.planner.empty() ? nullptr : find_method(entry.planner);
  const fs::path file = manifest.file().folder / entry.mission;
  geometry::require_regular_file(file);  // rejects pipes, which would block the other items
  Setup setup = read_setup(file, method, "planners", entry.variant->changes, report);
  setup.title = entry.title;
  setup.kind = entry.kind();
  setup.truth_file = out / "scenes" / setup.fingerprint;
  if (manifest.file().results == ItemResults::package) setup.fingerprint += " package";
  return std::make_shared<const Setup>(std::move(setup));
}

}  // namespace

void Setup::name_kind_and_fingerprint() {
  kind = title + " " + method->title;
  fingerprint = trial_fingerprint(mission, method->name, folder());
}

Setup own_setup(const fs::path& file, const config::MissionSetup& mission) {
  Setup setup{file, mission.name, nullptr, mission, "", ""};
  setup.method = find_method(survey::find_title(mission.survey().planner.name).word);
  setup.name_kind_and_fingerprint();
  return setup;
}

Setup read_setup(const fs::path& file, const Method* method, const std::string& origin,
                 std::vector<config::KeyOverride> overrides, const config::Report& report) {
  if (!method) return own_setup(file, config::read_mission(file, overrides, report));
  if (!method->file.empty()) {
    overrides.push_back({origin, "planner.name", "external"});
    overrides.push_back({origin, "planner.file", method->file.string(), true});
  }
  const auto& names = config::find_key("planner.name")->choices;
  if (std::ranges::find(names, method->name) != names.end()) {
    overrides.push_back({origin, "planner.name", method->name});
  }
  Setup setup{file, "", method, config::read_mission(file, overrides, report), "", ""};
  setup.title = setup.mission.name;
  setup.name_kind_and_fingerprint();
  return setup;
}

Records finished_items(const std::vector<BatchItem>& items) {
  Records records;
  for (const BatchItem& item : items) {
    records.push_back(finished_trial(item.record, item.setup->fingerprint));
  }
  return records;
}

Records run_items(const std::vector<BatchItem>& items, unsigned threads,
                  const std::stop_token& stop, const RunEvents& events) {
  return Runner(items, threads, stop, events).run();
}

void for_each_batch(const Manifest& manifest, const fs::path& out, const ItemRange& range,
                    const BatchEvents& events) {
  const ItemOutput form =
      manifest.file().results == ItemResults::package ? ItemOutput::package : ItemOutput::folder;
  std::vector<BatchItem> batch;
  std::size_t setups = 0;
  std::string title;
  for (std::size_t index = 0; index < manifest.entries(); ++index) {
    const std::vector<std::size_t> numbers = manifest.entry_run_numbers(index, range);
    if (numbers.empty()) continue;
    const ManifestEntry entry = manifest.entry(index);
    // Setups of one scene remain in the same batch.
    if (setups >= max_setups && entry.title != title) {
      events.work(std::exchange(batch, {}));
      setups = 0;
    }
    title = entry.title;
    try {
      const auto setup = make_setup(manifest, entry, out, events.reading);
      ++setups;
      for (const std::size_t number : numbers) {
        const ManifestLine line = manifest.line(number);
        batch.push_back({setup, line.seed, out / line.folder() / record_name, form, number});
      }
    } catch (const Error& error) {
      events.failed(error, numbers.size());
    }
  }
  if (!batch.empty()) events.work(batch);
}

}  // namespace skycap::missions::batch
