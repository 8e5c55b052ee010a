#include "missions/evaluation/tally_file.h"

#include <bit>
#include <fstream>
#include <system_error>

#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/json.h"

namespace skycap::missions::evaluation {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* shard_file_name = "piece.json";
constexpr const char* distances_name = "distances.bin";

static_assert(std::endian::native == std::endian::little);

Json parsed(const fs::path& folder) {
  return geometry::parse_json<Json>(geometry::read_file(folder / shard_file_name));
}

}  // namespace

void stage_tally(const std::string& identity, const CloudTally& tally,
                 geometry::OutputFolder& folder) {
  std::string covered;
  for (const std::uint8_t mark : tally.is_covered) covered += mark != 0 ? '1' : '0';
  const Json json{{"of", identity},
                  {"points", tally.distances.distances.size()},
                  {"beside", tally.distances.surroundings},
                  {"sum", tally.distances.sum.all_digits()},
                  {"squares", tally.distances.squares.all_digits()},
                  {"covered", covered}};
  const std::vector<float>& distances = tally.distances.distances;
  folder.write(distances_name,
               {reinterpret_cast<const char*>(distances.data()), distances.size() * sizeof(float)});
  folder.write(shard_file_name, json.dump() + "\n");
}

bool has_tally(const fs::path& folder, const std::string& identity) {
  std::error_code missing;
  if (!fs::is_regular_file(folder / shard_file_name, missing)) return false;
  try {
    return parsed(folder).at("of") == Json(identity);
  } catch (const Json::exception&) {
    return false;
  } catch (const Error&) {  // the tally is created again
    return false;
  }
}

CloudTally read_tally(const fs::path& folder, std::size_t samples) {
  try {
    const Json json = parsed(folder);
    CloudTally tally;
    tally.distances.sum = ExactSum(json.at("sum").get<ExactSum::Digits>());
    tally.distances.surroundings = json.at("beside").get<std::uint64_t>();
    tally.distances.squares = ExactSum(json.at("squares").get<ExactSum::Digits>());
    for (const char mark : json.at("covered").get<std::string>()) {
      tally.is_covered.push_back(mark == '1' ? 1 : 0);
    }
    if (tally.is_covered.size() != samples) {
      throw Error(ErrorKind::bad_file, (folder / shard_file_name).string() +
                                           ": is damaged (number of samples); remove this file");
    }
    const fs::path file_name = folder / distances_name;
    const auto points = json.at("points").get<std::size_t>();
    std::error_code failure;
    // The number in the file may be any: memory is allocated only for distances that exist.
    const std::uintmax_t present = fs::file_size(file_name, failure) / sizeof(float);
    std::ifstream file(file_name, std::ios::binary);
    std::vector<float>& distances = tally.distances.distances;
    if (!failure && points <= present) distances.resize(points);
    if (distances.size() != points ||
        !file.read(reinterpret_cast<char*>(distances.data()),
                   static_cast<std::streamsize>(points * sizeof(float)))) {
      throw Error(ErrorKind::bad_file, file_name.string() + ": is truncated");
    }
    return tally;
  } catch (const Json::exception& failure) {
    throw Error(ErrorKind::bad_file, (folder / shard_file_name).string() + ": " + failure.what());
  }
}

}  // namespace skycap::missions::evaluation
