#include "missions/batch/campaign/item_runner.h"

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include "geometry/io/file.h"
#include "geometry/io/output_folder.h"
#include "geometry/parallel.h"
#include "missions/batch/campaign/prepared_scenes.h"
#include "missions/package/package.h"

namespace skycap::missions::batch {
namespace {

using batch::TrialRecord;
using Clock = std::chrono::steady_clock;
using Records = std::vector<std::optional<TrialRecord>>;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

class Runner {
 public:
  Runner(const std::vector<Item>& items, unsigned threads, std::stop_token stop,
         const RunEvents& events)
      : items_(items),
        threads_(threads),
        stop_(std::move(stop)),
        events_(events),
        records_(finished_items(items)) {}

  Records run() {
    std::vector<std::size_t> unfinished;
    std::map<std::string, std::size_t> uses;
    for (std::size_t i = 0; i < items_.size(); ++i) {
      if (records_[i]) continue;
      unfinished.push_back(i);
      ++uses[items_[i].setup->title];
      if (events_.unfinished) events_.unfinished(items_[i]);
    }
    PreparedScenes scenes(std::move(uses), threads_);
    geometry::parallel_for(unfinished.size(), threads_, [&](std::size_t i) {
      run_or_tell(items_[unfinished[i]], scenes, records_[unfinished[i]]);
    });
    return std::move(records_);
  }

 private:
  void run_or_tell(const Item& item, PreparedScenes& scenes, std::optional<TrialRecord>& record) {
    if (stop_.stop_requested()) return;
    try {
      run(item, scenes, record);
    } catch (const Error& error) {
      if (!events_.failed) throw;
      const std::lock_guard lock(telling_);
      events_.failed(item, error);
    }
  }

  void run(const Item& item, PreparedScenes& scenes, std::optional<TrialRecord>& record) {
    std::optional<geometry::OutputFolder> folder;
    if (item.form != ItemForm::file) {
      folder.emplace(item.record.parent_path());
      // Another program may have run it since; from here on none can.
      record = batch::finished_trial(item.record, item.setup->fingerprint);
      if (record) return;
    }
    const auto prepared = scenes.take(*item.setup, stop_, [&] { tell_preparing(*item.setup); });
    if (!prepared) return;
    std::optional<TrialRecord> finished;
    try {
      finished = survey(item, *prepared, folder);
    } catch (const Error& error) {
      throw Error(error.kind(), item.setup->file.string() + ", " + item.setup->contestant->name +
                                    ": " + error.what());
    }
    if (!finished) return;
    if (events_.done) {
      const std::lock_guard lock(telling_);
      events_.done(item, *finished);
    }
    record = std::move(finished);
  }

  /// Runs an item and keeps its result; nothing if it was stopped.
  std::optional<TrialRecord> survey(const Item& item, const PreparedScene& prepared,
                                    std::optional<geometry::OutputFolder>& folder) {
    const auto start = Clock::now();
    const Setup& setup = *item.setup;
    const session::SurveyRecord survey =
        setup.contestant->survey(setup.mission.simulation, prepared.scene, item.seed, stop_);
    if (survey.stop_reason == survey::StopReason::interrupted) return std::nullopt;
    if (item.form == ItemForm::package) {
      stage_package(item, prepared, survey, *folder);
      if (stop_.stop_requested()) return std::nullopt;  // a route may be missing for it
      if (events_.packaged) {
        const std::lock_guard lock(telling_);
        events_.packaged(item, *folder);
      }
    }
    const TrialRecord record{batch::trial_of(survey, prepared.truth),
                             batch::run_here(seconds_since(start))};
    const std::string text = batch::trial_record_json(item.setup->fingerprint, record);
    if (folder) {
      // Whatever else is there was made of an earlier record.
      folder->replace([](std::string_view name) { return !name.starts_with("."); });
      folder->write(item.record.filename().string(), text);
      folder->commit();
    } else {
      geometry::write_file(item.record, text);
    }
    return record;
  }

  void stage_package(const Item& item, const PreparedScene& prepared,
                     const session::SurveyRecord& survey, geometry::OutputFolder& folder) const {
    config::MissionSetup mission = item.setup->mission;
    mission.run.seed = item.seed;
    const package::CoverageFigures coverage =
        package::coverage_figures(mission.simulation, survey, prepared.scene, 1, stop_);
    package::stage_package(mission, survey, coverage, 1, folder, stop_);
  }

  void tell_preparing(const Setup& setup) {
    if (!events_.preparing) return;
    const std::lock_guard lock(telling_);
    events_.preparing(setup);
  }

  const std::vector<Item>& items_;
  unsigned threads_;
  std::stop_token stop_;
  const RunEvents& events_;
  Records records_;
  std::mutex telling_;
};

}  // namespace

Records finished_items(const std::vector<Item>& items) {
  Records records;
  for (const Item& item : items) {
    records.push_back(batch::finished_trial(item.record, item.setup->fingerprint));
  }
  return records;
}

Records run_items(const std::vector<Item>& items, unsigned threads, const std::stop_token& stop,
                  const RunEvents& events) {
  return Runner(items, threads, stop, events).run();
}

}  // namespace skycap::missions::batch
