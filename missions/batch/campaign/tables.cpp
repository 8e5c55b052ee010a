#include "missions/batch/campaign/tables.h"

#include "missions/batch/benchmark/benchmark_report.h"
#include "missions/support/number_text.h"

namespace skycap::missions::batch {

std::string stage_tables(const std::vector<batch::BenchmarkCell>& cells, const std::string& title,
                         batch::Times times, geometry::OutputFolder& folder) {
  folder.write("trials.csv", batch::all_trials_csv(cells, times));
  folder.write("table1.csv", batch::table_1_csv(cells, times));
  folder.write("results.json", batch::results_json(cells));
  std::string markdown = batch::report_markdown(cells, title, times);
  folder.write("report.md", markdown);
  return markdown;
}

std::string times_csv(const std::vector<ItemTimes>& items) {
  std::string csv = "item,host,wall_time_s,planning_time_s,peak_memory_bytes\n";
  for (const ItemTimes& item : items) {
    csv += std::to_string(item.number) + "," + item.run.host + "," +
           support::exact_text(item.run.wall_time) + "," + support::exact_text(item.planning_time) +
           "," + std::to_string(item.run.peak_memory) + "\n";
  }
  return csv;
}

}  // namespace skycap::missions::batch
