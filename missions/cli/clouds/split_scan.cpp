#include "missions/cli/clouds/split_scan.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "geometry/parallel.h"
#include "missions/cli/clouds/laser_scan.h"
#include "missions/cli/clouds/scan_results.h"
#include "missions/cli/clouds/split_work.h"

namespace skycap::missions::cli {
namespace {

namespace fs = std::filesystem;

class PiecesOfFlight final : public PieceWork {
 public:
  PiecesOfFlight(const ScanVerbOptions& options, const config::MissionSetup& setup,
                 const config::SensorDescription& sensor, const fs::path& out,
                 const Console& console)
      : scan_(options, setup, sensor, console, folder_of_pieces(out) / "tiles.json"),
        pieces_(options.pieces),
        out_(out) {}

  bool do_piece(std::size_t number) override { return scan_.run_piece({number, pieces_}, out_); }

  bool take_piece(std::size_t number) override {
    auto piece = scan_.complete({number, pieces_}, out_);
    if (!piece) return false;
    complete_.push_back(std::move(*piece));
    return true;
  }

  int join(geometry::OutputFolder& folder) override { return scan_.join(complete_, folder); }

 private:
  LaserScan scan_;
  std::size_t pieces_;
  fs::path out_;
  std::vector<scan::CompletePiece> complete_;
};

/// What decides the results, for another program.
batch::Words command_of(const ScanVerbOptions& options, const fs::path& out) {
  batch::Words words{"scan",     fs::absolute(options.mission), "--out", fs::absolute(out),
                     "--pieces", std::to_string(options.pieces)};
  const auto add = [&](const std::string& option, const std::string& value) {
    words.insert(words.end(), {option, value});
  };
  if (options.route) add("--route", fs::absolute(*options.route));
  if (options.sensor) {
    const bool is_file = options.sensor->ends_with(".yaml");
    add("--sensor", is_file ? fs::absolute(*options.sensor).string() : *options.sensor);
  }
  add("--format", fmt::format("{}", fmt::join(options.formats, ",")));
  if (options.with_truth) words.emplace_back("--with-truth");
  if (!options.has_report) words.emplace_back("--no-report");
  for (const config::KeyOverride& key : options.overrides) {
    if (key.path != "threads") add("--set", key.path + "=" + key.value);  // a task has its own
  }
  return words;
}

}  // namespace

int split_scan(const ScanVerbOptions& options, const config::MissionSetup& setup,
               const config::SensorDescription& sensor, const fs::path& out,
               const Console& console) {
  const SplitWork work{.pieces = options.pieces,
                       .out = out,
                       .summary = scan_name,
                       .title = "Scan " + setup.name,
                       .name = setup.name,
                       .command = command_of(options, out),
                       .jobs = geometry::thread_count(setup.run.threads),
                       .is_quiet = options.is_quiet,
                       .begin = [&]() -> std::unique_ptr<PieceWork> {
                         return std::make_unique<PiecesOfFlight>(options, setup, sensor, out,
                                                                 console);
                       }};
  return run_split(work, options.task, console);
}

}  // namespace skycap::missions::cli
