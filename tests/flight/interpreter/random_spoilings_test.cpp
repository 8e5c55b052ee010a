// Random spoilings of every kind of mission file: each is refused, or an independent flight of the
// same items keeps its distance from the building by CGAL's exact distances.
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/export/wpml_file.h"
#include "flight/interpreter/interpret.h"
#include "flight/interpreter/wpml_interpreter.h"
#include "tests/flight/interpreter/spoiled.h"
#include "tests/flight/space/cgal_oracle.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

constexpr int spoilings = 200;
constexpr double pad_height = 111.5, undulation = 46.7;

/// East, north and up of the sample's origin by the ellipsoid's radii there: good to a millimetre
/// within 100 m, and no code of the product.
Vector3d by_radii(double latitude_deg, double longitude_deg, double up) {
  constexpr double a = 6378137.0, e2 = 6.69437999014e-3, degree = M_PI / 180.0;
  const double sine = std::sin(51.753458 * degree), w = std::sqrt(1.0 - e2 * sine * sine);
  const double north = a * (1.0 - e2) / (w * w * w) + pad_height;
  const double east = (a / w + pad_height) * std::cos(51.753458 * degree);
  return {(longitude_deg + 1.254022) * degree * east, (latitude_deg - 51.753458) * degree * north,
          up};
}

/// Whether straight lines between the places keep 2 m, less the rounding of files.
bool keeps_clear(const std::vector<Vector3d>& places) {
  static const CgalOracle oracle(sample_site().mesh);
  for (std::size_t i = 1; i < places.size(); ++i) {
    const Verdict verdict = oracle.judge({places[i - 1], places[i]}, 2.0 - 3.0 * rounding_bound);
    if (verdict == Verdict::violated) return false;
  }
  return true;
}

/// The places that an autopilot flies to: the pad, those of the items in order, jumps followed, and
/// where it lands.
std::vector<Vector3d> flight_of(const std::vector<MissionItem>& items) {
  std::vector<Vector3d> places = {{-30, -25, 0}};
  std::vector<int> jumped(items.size(), 0);
  for (std::size_t i = 0; i < items.size() && places.size() < 10000; ++i) {
    const auto& p = items[i].params;
    const double up =
        items[i].frame == 0 || items[i].frame == 5 ? p[6] + undulation - pad_height : p[6];
    const Vector3d place = by_radii(p[4], p[5], up);
    if (items[i].command == 22) places.push_back({places[0].x(), places[0].y(), up});
    if (items[i].command == 16 || items[i].command == 19) places.push_back(place);
    if (items[i].command == 21) {
      places.push_back({place.x(), place.y(), places.back().z()});
      places.push_back({place.x(), place.y(), 0.0});
      break;
    }
    if (items[i].command == 177 && jumped[i]++ < p[1]) {
      for (std::size_t k = 0; k < items.size(); ++k) {
        if (static_cast<double>(items[k].number) == p[0]) i = k - 1;
      }
    }
  }
  return places;
}

/// One random change to one random item; numbers stay those of the places in the file.
void spoil(MissionFile& file, std::mt19937_64& random) {
  const std::size_t first = file.items.front().number;
  const auto pick = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  const auto within = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  MissionItem& item = file.items[pick(file.items.size())];
  switch (pick(9)) {
    case 0:
      item.command = static_cast<int>(pick(300));
      break;
    case 1:
      item.command = std::array{16, 17, 18, 19, 20, 21, 22, 30, 31, 82, 92, 93, 177, 178}[pick(14)];
      break;
    case 2:
      item.frame = std::array{0, 2, 3, 5, 6, 10, 11}[pick(7)];
      break;
    case 3:
      item.params[pick(7)] = std::array{0.0, 1.0, 2.0, -1.0, 15.0, 90.0, 400.0}[pick(7)];
      break;
    case 4:
      move(item, {within(-25, 25), within(-25, 25), within(1, 25)});
      break;
    case 5:
      std::swap(item, file.items[pick(file.items.size())]);
      break;
    case 6:
      file.items.erase(file.items.begin() + static_cast<std::ptrdiff_t>(pick(file.items.size())));
      break;
    case 7:
      item = {
          177, 2, {static_cast<double>(pick(30)), within(0, 3), 0, 0, 0, 0, 0}, true, item.number};
      item.params[1] = std::floor(item.params[1]);
      break;
    default:
      item.params[6] += within(-8, 8);
  }
  for (std::size_t i = 0; i < file.items.size(); ++i) file.items[i].number = first + i;
}

class RandomSpoilings : public testing::TestWithParam<Dialect> {};

TEST_P(RandomSpoilings, AreRefusedOrHarmless) {
  std::mt19937_64 random(GetParam() == Dialect::px4 ? 5 : 6);
  int harmless = 0, refused = 0;
  for (int i = 0; i < spoilings; ++i) {
    MissionFile file = sample_file(GetParam());
    spoil(file, random);
    if (!problems_of(file, GetParam()).empty()) {
      ++refused;
      continue;
    }
    ++harmless;
    EXPECT_TRUE(keeps_clear(flight_of(file.items))) << "spoiling " << i;
  }
  EXPECT_GT(refused, spoilings / 2);
  EXPECT_GT(harmless, 3);
}

INSTANTIATE_TEST_SUITE_P(Interpreter, RandomSpoilings,
                         testing::Values(Dialect::px4, Dialect::ardupilot),
                         [](const auto& parameter) {
                           return parameter.param == Dialect::px4 ? "px4" : "ardupilot";
                         });

/// The numbers in a WPML text, by place and length.
std::vector<std::pair<std::size_t, std::size_t>> numbers_of(const std::string& text) {
  std::vector<std::pair<std::size_t, std::size_t>> found;
  for (std::size_t i = text.find("<wpml:missionConfig>"); i < text.size(); ++i) {
    if (text[i] != '>') continue;
    const std::size_t end = text.find('<', i);
    if (end == std::string::npos) break;
    if (to_number(text.substr(i + 1, end - i - 1))) found.emplace_back(i + 1, end - i - 1);
  }
  return found;
}

/// The places of a WPML file's waypoints, read without an XML parser, between the pad's.
std::vector<Vector3d> flight_of(const std::string& wayline) {
  const auto after = [&](const std::string& tag, std::size_t from) {
    return wayline.find(tag, from) + tag.size();
  };
  std::vector<Vector3d> places = {{-30, -25, 0}};
  for (std::size_t i = wayline.find("<Placemark>"); i != std::string::npos;
       i = wayline.find("<Placemark>", i + 1)) {
    const std::size_t place = after("<coordinates>", i);
    const double longitude = std::stod(wayline.substr(place));
    const double latitude = std::stod(wayline.substr(wayline.find(',', place) + 1));
    const double up = std::stod(wayline.substr(after("<wpml:executeHeight>", i)));
    places.push_back(by_radii(latitude, longitude, up));
  }
  places.push_back({places.back().x(), places.back().y(), 0.0});
  return places;
}

TEST(RandomWpmlSpoilings, AreRefusedOrHarmless) {
  const FlightPlan plan = sample_plan(vehicle_profile("m350_rtk"));
  const KmzContent good = unpack_kmz(write_kmz(plan));
  const FlightFacts facts = facts_of(plan);
  std::mt19937_64 random(7);
  int harmless = 0, refused = 0;
  for (int i = 0; i < spoilings; ++i) {
    KmzContent kmz = good;
    std::string& text = i % 4 == 0 ? kmz.template_kml : kmz.waylines_wpml;
    const auto numbers = numbers_of(text);
    const auto [place, size] = numbers[random() % numbers.size()];
    const std::string other = std::array{"0", "1", "2", "5", "15", "-5", "60"}[random() % 7];
    text.replace(place, size, other);
    bool is_refused = !validate_kmz(pack_kmz(kmz)).empty();
    is_refused = is_refused || !problems_of(interpret(kmz, facts)).empty();
    ++(is_refused ? refused : harmless);
    if (!is_refused) {
      EXPECT_TRUE(keeps_clear(flight_of(kmz.waylines_wpml))) << "spoiling " << i;
    }
  }
  EXPECT_GT(refused, spoilings / 4);
  EXPECT_GT(harmless, 3);
}

}  // namespace
}  // namespace skycap::flight
