#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "missions/batch/benchmark/benchmark_report.h"
#include "missions/cli/survey_batch.h"
#include "missions/cli/write_page.h"

namespace skycap::missions::cli {
namespace {

int run_campaign_command(const BatchOptions& options, const Console& console) {
  const SignalWatchdog watchdog(console);
  batch::CampaignFile file = batch::read_campaign(options.file);
  const std::filesystem::path out = options.folder(file.name);
  BatchRun run(options, "campaign", std::move(file), out, console);
  return run.run([&](const Collected& all, geometry::OutputFolder& folder) {
    std::vector<batch::BenchmarkCell> cells;
    for (const CollectedItem& item : all.items) {
      const std::string& planner = item.method->name;
      if (cells.empty() || cells.back().mission != item.title || cells.back().planner != planner) {
        cells.push_back({item.title, planner, {}});
      }
      if (item.record) cells.back().trials.push_back(item.record->trial);
    }
    const std::string markdown =
        batch::stage_tables(cells, run.manifest().file().name, batch::Times::left_out, folder);
    write_page("results.json", options.has_report, folder, console);
    folder.commit();
    if (!options.is_quiet) {
      console.out << markdown
                  << fmt::format("\n{} of {} runs{}\nresults: {}\n", all.done(),
                                 run.manifest().size(), all.missing_text(), out.string())
                  << std::flush;
    }
    return all.done() == run.manifest().size() ? 0 : 1;
  });
}

}  // namespace

void add_campaign(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command =
      app.add_subcommand("campaign", "Run a batch of surveys locally or on a cluster");
  const auto options = std::make_shared<BatchOptions>();
  add_batch_options(*command, *options, "Campaign file (docs/reference/batch-files.md)");
  run(*command, options, run_campaign_command, console, action);
}

}  // namespace skycap::missions::cli
