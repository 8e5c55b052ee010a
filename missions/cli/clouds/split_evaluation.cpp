#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/record_log.h"
#include "geometry/parallel.h"
#include "missions/cli/clouds/evaluation.h"
#include "missions/cli/clouds/split_work.h"
#include "missions/evaluation/tally_file.h"
#include "missions/support/json_text.h"
#include "missions/version.h"

namespace skycap::missions::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* evaluation_name = "evaluation.json";

std::string checksum(const geometry::Mesh& mesh) {
  const auto sum_of = [](const auto& items) {
    return geometry::crc32_of(
        {reinterpret_cast<const char*>(items.data()), items.size() * sizeof(items[0])});
  };
  return fmt::format("{:08x} {:08x}", sum_of(mesh.vertices), sum_of(mesh.triangles));
}

/// A cloud whose points are shared out as they follow each other in its file.
class PiecesOfCloud final : public PieceWork {
 public:
  PiecesOfCloud(const EvaluateOptions& options, const Console& console)
      : options_(options),
        console_(console),
        progress_(console, options.is_quiet),
        truth_(read_truth()),
        digest_(checksum(truth_.model) + " beside " + checksum(truth_.beside)) {}

  bool do_piece(std::size_t number) override {
    geometry::OutputFolder folder(piece_folder(number));
    if (evaluation::has_tally(folder.path(), identity(number))) return true;
    evaluation::CloudJudge judge(truth_.model, truth_.samples, truth_.registration_distance,
                                 options_.threads, truth_.beside);
    double begin = 0.0;  // of what is read next, as a share of the file
    geometry::read_positions(
        options_.cloud, [&](std::span<const Eigen::Vector3f> points, double end) {
          const auto place = static_cast<std::size_t>(begin * static_cast<double>(options_.pieces));
          begin = end;
          const bool is_own = std::min(place, options_.pieces - 1) == number;
          if (!is_own || console_.stop.stop_requested()) return;
          progress_.show(
              fmt::format("{}: piece {}, {:.0f}%", options_.cloud.string(), number, 100.0 * end));
          judge.add(points);
        });
    if (console_.stop.stop_requested()) return false;
    evaluation::stage_tally(identity(number), judge.take_tally(), folder);
    folder.commit();
    return true;
  }

  bool take_piece(std::size_t number) override {
    if (!evaluation::has_tally(piece_folder(number), identity(number))) return false;
    all_.add(evaluation::read_tally(piece_folder(number)));
    return true;
  }

  int join(geometry::OutputFolder& folder) override {
    const evaluation::CloudJudgement judged =
        judgement_of(all_, geometry::surface_area(truth_.model));
    nlohmann::ordered_json json = evaluation_json(options_, truth_, judged);
    json["complete"] = true;
    folder.write(evaluation_name, support::json_text(json));
    folder.commit();
    progress_.clear();
    if (!options_.is_quiet) print_evaluation(options_, truth_, judged, console_.out);
    return 0;
  }

 private:
  Truth read_truth() {
    progress_.show("loading " + options_.model);
    const bool wants_visible = !options_.task.index;  // which only the whole cloud is asked for
    return truth_of(options_, wants_visible, progress_.teller(), console_.stop);
  }

  fs::path piece_folder(std::size_t number) const {
    return folder_of_piece(*options_.out, number, options_.pieces);
  }

  /// What decides a piece.
  std::string identity(std::size_t number) const {
    const auto changed = fs::last_write_time(options_.cloud).time_since_epoch().count();
    return fmt::format("{} {} {} {} model {} distance {} samples {} piece {} of {}", version,
                       fs::absolute(options_.cloud).string(), fs::file_size(options_.cloud),
                       changed, digest_, truth_.registration_distance, truth_.samples, number,
                       options_.pieces);
  }

  const EvaluateOptions& options_;
  const Console& console_;
  ProgressLine progress_;
  Truth truth_;
  std::string digest_;
  evaluation::CloudTally all_;
};

batch::Words command_of(const EvaluateOptions& options) {
  std::error_code missing;
  const bool is_file = fs::exists(options.model, missing);
  batch::Words words{"evaluate",
                     "--cloud",
                     fs::absolute(options.cloud),
                     "--model",
                     is_file ? fs::absolute(options.model).string() : options.model,
                     "--out",
                     fs::absolute(*options.out),
                     "--pieces",
                     std::to_string(options.pieces),
                     "--samples",
                     std::to_string(options.samples)};
  if (options.distance) {
    words.insert(words.end(), {"--distance", fmt::format("{}", *options.distance)});
  }
  return words;
}

}  // namespace

int split_evaluation(const EvaluateOptions& options, const Console& console) {
  if (!options.mesh.empty() || !options.out) {
    throw Error(ErrorKind::bad_usage, "--pieces requires --cloud and --out");
  }
  if (!fs::is_regular_file(options.cloud)) {
    throw Error(ErrorKind::bad_file, options.cloud.string() + ": does not exist");
  }
  const SplitWork work{.pieces = options.pieces,
                       .out = *options.out,
                       .summary = evaluation_name,
                       .title = "Evaluation of " + options.cloud.filename().string(),
                       .name = "evaluate",
                       .command = command_of(options),
                       .jobs = geometry::thread_count(options.threads),
                       .is_quiet = options.is_quiet,
                       .begin = [&]() -> std::unique_ptr<PieceWork> {
                         return std::make_unique<PiecesOfCloud>(options, console);
                       }};
  return run_split(work, options.task, console);
}

}  // namespace skycap::missions::cli
