#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "missions/batch/district/district_results.h"
#include "missions/cli/items/item_run.h"
#include "missions/cli/write_page.h"

namespace skycap::missions::cli {
namespace {

namespace fs = std::filesystem;
using batch::SurveyedTarget;

constexpr const char* not_complete = "the survey is not complete; see the warnings of its run";

/// A district while it is surveyed.
class DistrictVerb {
 public:
  DistrictVerb(const ItemOptions& options, const Console& console)
      : options_(options),
        console_(console),
        district_(batch::read_district(options.file)),
        out_(options.folder(district_.name)) {}

  int run() {
    {
      ProgressLine progress(console_, options_.is_quiet);
      prepared_ = batch::prepare(district_, out_, progress.teller());
    }
    const auto keep = [this](const batch::Batch& batch, const Records& records) {
      for (std::size_t i = 0; i < records.size(); ++i) {
        if (!records[i]) continue;
        const batch::Item& item = batch.items[i];
        figures_.insert_or_assign(item.setup->title,
                                  batch::figures_of(item.record.parent_path(), *records[i]));
      }
    };
    const auto collect = [this](geometry::OutputFolder& folder) { return this->collect(folder); };
    run_ = std::make_unique<ItemRun>(options_, batch::campaign_of(district_, prepared_, out_), out_,
                                     ItemVerb{"district", keep, collect}, console_);
    return run_->run();
  }

 private:
  std::vector<SurveyedTarget> surveyed() const {
    std::vector<SurveyedTarget> targets;
    for (const batch::PreparedTarget& target : prepared_.targets) {
      const auto found = figures_.find(target.title);
      SurveyedTarget& one = targets.emplace_back(SurveyedTarget{target, {}, target.refusal});
      if (found != figures_.end()) {
        one.figures = found->second;
      } else if (one.why_none.empty()) {
        one.why_none = not_complete;
      }
    }
    return targets;
  }

  /// The flight of what is there, the figures and the page.
  int collect(geometry::OutputFolder& folder) {
    const std::vector<SurveyedTarget> targets = surveyed();
    const batch::DistrictFlight flight = batch::plan_district(
        district_, prepared_, targets, out_,
        [this](const std::string& what) { run_->progress().say(what); }, console_.stop);
    run_->progress().clear();
    if (console_.stop.stop_requested()) return interrupted_exit_code(console_);
    folder.write(batch::table_name, batch::targets_csv(targets, flight));
    folder.write(batch::results_name,
                 batch::results_json(district_, prepared_, targets, flight, out_));
    write_page(batch::results_name, options_.has_report, folder, console_);
    folder.commit();
    const bool is_complete =
        std::ranges::all_of(targets, [](const auto& target) { return target.figures.has_value(); });
    if (!options_.is_quiet) {
      console_.out << fmt::format("{}: {}\n", district_.name,
                                  is_complete ? "complete" : "not complete")
                   << batch::results_text(targets, flight) << "  results   " << out_.string()
                   << "\n"
                   << std::flush;
    }
    return is_complete ? 0 : 1;
  }

  const ItemOptions& options_;
  const Console& console_;
  batch::DistrictFile district_;
  fs::path out_;
  batch::Prepared prepared_;
  std::unique_ptr<ItemRun> run_;
  std::map<std::string, batch::SurveyFigures> figures_;  ///< by title
};

int district_verb(const ItemOptions& options, const Console& console) {
  const HoldsResults results(console);
  const LastResort last_resort(console);
  return DistrictVerb(options, console).run();
}

}  // namespace

void add_district(CLI::App& app, const Console& console, Action& action) {
  CLI::App* verb = app.add_subcommand(
      "district", "Survey several buildings of a map and plan one flight for all");
  const auto options = std::make_shared<ItemOptions>();
  add_item_options(*verb, *options, "District file (docs/reference/batch-files.md)");
  run(*verb, options, district_verb, console, action);
}

}  // namespace skycap::missions::cli
