#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "missions/batch/campaign/tables.h"
#include "missions/cli/items/item_run.h"
#include "missions/cli/write_page.h"

namespace skycap::missions::cli {
namespace {

/// The tables of a campaign.
class CampaignTables {
 public:
  /// Takes the records of a batch in.
  void keep(const batch::Batch& batch, const Records& records) {
    const batch::Setup* before = nullptr;
    for (std::size_t i = 0; i < records.size(); ++i) {
      const batch::Setup* setup = batch.items[i].setup.get();
      if (setup != before) cells_.push_back({setup->title, setup->contestant->name, {}});
      before = setup;
      if (records[i]) cells_.back().trials.push_back(records[i]->trial);
    }
  }

  /// Returns the one for the terminal.
  std::string stage(const std::string& title, geometry::OutputFolder& folder) const {
    return batch::stage_tables(cells_, title, batch::Times::left_out, folder);
  }

 private:
  std::vector<batch::BenchmarkCell> cells_;
};

int campaign_verb(const ItemOptions& options, const Console& console) {
  const HoldsResults results(console);
  const LastResort last_resort(console);
  batch::CampaignFile file = batch::read_campaign(options.file);
  const std::filesystem::path out = options.folder(file.name);
  CampaignTables tables;
  std::unique_ptr<ItemRun> run;
  const auto collect = [&](geometry::OutputFolder& folder) {
    const std::string markdown = tables.stage(run->manifest().file().name, folder);
    write_page("results.json", options.has_report, folder, console);
    folder.commit();
    if (!options.is_quiet) {
      console.out << markdown << fmt::format("\n{} of {} runs", run->done(), run->manifest().size())
                  << run->missing() << "\nresults: " << out.string() << "\n"
                  << std::flush;
    }
    return run->done() == run->manifest().size() ? 0 : 1;
  };
  const auto keep = [&](const batch::Batch& batch, const Records& records) {
    tables.keep(batch, records);
  };
  run = std::make_unique<ItemRun>(options, std::move(file), out,
                                  ItemVerb{"campaign", keep, collect}, console);
  return run->run();
}

}  // namespace

void add_campaign(CLI::App& app, const Console& console, Action& action) {
  CLI::App* verb = app.add_subcommand("campaign", "Run a batch of surveys locally or on a cluster");
  const auto options = std::make_shared<ItemOptions>();
  add_item_options(*verb, *options, "Campaign file (docs/reference/batch-files.md)");
  run(*verb, options, campaign_verb, console, action);
}

}  // namespace skycap::missions::cli
