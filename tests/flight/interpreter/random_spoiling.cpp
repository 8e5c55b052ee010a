#include "tests/flight/interpreter/random_spoiling.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

constexpr double degree = std::numbers::pi / 180.0;

/// Returns the offset and length of each number in a WPML text.
std::vector<std::pair<std::size_t, std::size_t>> find_numbers(const std::string& text) {
  std::vector<std::pair<std::size_t, std::size_t>> found;
  for (std::size_t i = text.find("<wpml:missionConfig>"); i < text.size(); ++i) {
    if (text[i] != '>') continue;
    const std::size_t end = text.find('<', i);
    if (end == std::string::npos) break;
    if (to_number(text.substr(i + 1, end - i - 1))) found.emplace_back(i + 1, end - i - 1);
  }
  return found;
}

}  // namespace

Vector3d Ground::position(double latitude, double longitude, double up) const {
  constexpr double a = 6378137.0, e2 = 6.69437999014e-3;
  const double sine = std::sin(latitude_deg * degree), w = std::sqrt(1.0 - e2 * sine * sine);
  const double north = a * (1.0 - e2) / (w * w * w) + height;
  const double east = (a / w + height) * std::cos(latitude_deg * degree);
  return {(longitude - longitude_deg) * degree * east, (latitude - latitude_deg) * degree * north,
          pad.z() + up};
}

Eigen::AlignedBox3d Ground::around(double half_width, double max_height) const {
  constexpr double metres_per_degree = 111e3;
  const double north = half_width / metres_per_degree;
  const double east = north / std::cos(latitude_deg * degree);
  return {Vector3d(latitude_deg - north, longitude_deg - east, 1.0),
          Vector3d(latitude_deg + north, longitude_deg + east, max_height)};
}

void corrupt(MavlinkMission& file, std::mt19937_64& random, const Eigen::AlignedBox3d& site) {
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
      item.params[4] = within(site.min().x(), site.max().x());
      item.params[5] = within(site.min().y(), site.max().y());
      item.params[6] = within(site.min().z(), site.max().z());
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

std::string corrupted(std::string wpml, std::mt19937_64& random) {
  const auto numbers = find_numbers(wpml);
  const auto [position, size] = numbers[random() % numbers.size()];
  wpml.replace(position, size, std::array{"0", "1", "2", "5", "15", "-5", "60"}[random() % 7]);
  return wpml;
}

std::vector<Vector3d> make_flight(const std::vector<MissionItem>& items, const Ground& ground) {
  const double pad_height = ground.height + ground.pad.z();
  std::vector<Vector3d> positions = {ground.pad};
  std::vector<int> jumped(items.size(), 0);
  for (std::size_t i = 0; i < items.size() && positions.size() < 10000; ++i) {
    const auto& p = items[i].params;
    const double up =
        items[i].frame == 0 || items[i].frame == 5 ? p[6] + ground.undulation - pad_height : p[6];
    const Vector3d position = ground.position(p[4], p[5], up);
    if (items[i].command == 22) {
      positions.push_back({ground.pad.x(), ground.pad.y(), ground.pad.z() + up});
    }
    if (items[i].command == 16 || items[i].command == 19) positions.push_back(position);
    if (items[i].command == 21) {
      positions.push_back({position.x(), position.y(), positions.back().z()});
      positions.push_back({position.x(), position.y(), ground.pad.z()});
      break;
    }
    if (items[i].command == 177 && jumped[i]++ < p[1]) {
      for (std::size_t k = 0; k < items.size(); ++k) {
        if (static_cast<double>(items[k].number) == p[0]) i = k - 1;
      }
    }
  }
  return positions;
}

std::vector<Vector3d> make_flight(const std::string& wayline, const Ground& ground) {
  const auto after = [&](const std::string& tag, std::size_t from) {
    return wayline.find(tag, from) + tag.size();
  };
  std::vector<Vector3d> positions = {ground.pad};
  for (std::size_t i = wayline.find("<Placemark>"); i != std::string::npos;
       i = wayline.find("<Placemark>", i + 1)) {
    const std::size_t position = after("<coordinates>", i);
    const double longitude = std::stod(wayline.substr(position));
    const double latitude = std::stod(wayline.substr(wayline.find(',', position) + 1));
    const double up = std::stod(wayline.substr(after("<wpml:executeHeight>", i)));
    positions.push_back(ground.position(latitude, longitude, up));
  }
  positions.push_back({positions.back().x(), positions.back().y(), ground.pad.z()});
  return positions;
}

bool keeps_clear(const CgalOracle& oracle, const std::vector<Vector3d>& positions,
                 double clearance) {
  for (std::size_t i = 1; i < positions.size(); ++i) {
    if (oracle.classify({positions[i - 1], positions[i]}, clearance) == Verdict::violated)
      return false;
  }
  return true;
}

}  // namespace skycap::flight
