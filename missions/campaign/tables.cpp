#include "missions/campaign/tables.h"

#include "missions/benchmark/benchmark_report.h"
#include "missions/file/number_text.h"

namespace skycap::missions::campaign {

std::string stage_tables(const std::vector<benchmark::BenchmarkCell>& cells,
                         const std::string& title, benchmark::Times times,
                         geometry::OutputFolder& folder) {
  folder.write("trials.csv", benchmark::all_trials_csv(cells, times));
  folder.write("table1.csv", benchmark::table_1_csv(cells, times));
  folder.write("results.json", benchmark::results_json(cells));
  std::string markdown = benchmark::report_markdown(cells, title, times);
  folder.write("report.md", markdown);
  return markdown;
}

std::string times_csv(const std::vector<ItemTimes>& items) {
  std::string csv = "item,host,wall_time_s,planning_time_s,peak_memory_bytes\n";
  for (const ItemTimes& item : items) {
    csv += std::to_string(item.number) + "," + item.run.host + "," +
           file::exact_text(item.run.wall_time) + "," + file::exact_text(item.planning_time) + "," +
           std::to_string(item.run.peak_memory) + "\n";
  }
  return csv;
}

}  // namespace skycap::missions::campaign
