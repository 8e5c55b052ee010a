#include "missions/batch/benchmark/trial_files.h"

#include <array>
#include <span>

#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <unistd.h>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/json.h"
#include "missions/scene/scene_source.h"
#include "missions/support/json_text.h"
#include "missions/support/sha256.h"
#include "missions/version.h"

namespace skycap::missions::batch {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string trial_fingerprint(const config::MissionSetup& mission, const std::string& contestant,
                              const fs::path& folder) {
  std::string inputs = std::string(version) + "\n" + contestant;
  for (const auto& [key, value] : mission.settings) {
    inputs.append("\n").append(key).append(" ").append(value);
  }
  for (const fs::path& file : scene::files_of(mission.scene(), mission.lidar, folder)) {
    std::error_code ignored;  // what is missing is refused when the scene is made ready
    const bool is_there = fs::is_regular_file(file, ignored);
    inputs.append("\n").append(is_there ? support::sha256_of_file(file) : "-");
  }
  return support::sha256(std::as_bytes(std::span(inputs)));
}

TrialRun run_here(double wall_time) {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  constexpr std::size_t unit = 1024;  // of ru_maxrss on Linux [byte]
  return {host.data(), wall_time, unit * static_cast<std::size_t>(usage.ru_maxrss)};
}

std::optional<TrialRecord> finished_trial(const fs::path& file, const std::string& fingerprint) {
  if (!fs::exists(file)) return std::nullopt;
  try {
    const Json json = geometry::parse_json<Json>(geometry::read_file(file, geometry::largest_json));
    if (json.at("fingerprint") != fingerprint) return std::nullopt;
    const Json& run = json.at("run");
    return TrialRecord{parse_trial(json.at("trial").dump()),
                       {run.at("host").get<std::string>(), run.at("wall_time_s").get<double>(),
                        run.at("peak_memory_bytes").get<std::size_t>()}};
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;  // not ours: it is overwritten
  } catch (const Error&) {
    return std::nullopt;
  }
}

std::string trial_record_json(const std::string& fingerprint, const TrialRecord& record) {
  return support::json_text({{"fingerprint", fingerprint},
                             {"run",
                              {{"host", record.run.host},
                               {"wall_time_s", record.run.wall_time},
                               {"peak_memory_bytes", record.run.peak_memory}}},
                             {"trial", Json::parse(trial_json(record.trial))}});
}

}  // namespace skycap::missions::batch
