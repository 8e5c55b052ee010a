#include "missions/cli/fly_test_report.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "missions/support/json_text.h"

namespace skycap::missions::cli {
namespace {

using flight::TestFlight;
using support::to_json;
using Json = nlohmann::ordered_json;

constexpr double joules_per_wh = 3600.0;

/// Sorted values of one quantity over many flights.
class Distribution {
 public:
  explicit Distribution(std::vector<double> values) : values_(std::move(values)) {
    std::ranges::sort(values_);
  }

  bool is_empty() const { return values_.empty(); }

  /// Returns the percentile by the nearest-rank method.
  double percentile(double percent) const {
    const auto rank = std::ceil(0.01 * percent * static_cast<double>(values_.size()));
    return values_[static_cast<std::size_t>(std::max(1.0, rank)) - 1];
  }

  Json json() const {
    if (values_.empty()) return nullptr;
    return {{"least", values_.front()},
            {"percentile_5", percentile(5)},
            {"median", percentile(50)},
            {"percentile_95", percentile(95)},
            {"greatest", values_.back()}};
  }

 private:
  std::vector<double> values_;
};

/// Returns the distribution of a figure over the flights that satisfy `counts`.
Distribution distribution(const TestedFile& file,
                          const std::function<double(const TestFlight&)>& figure,
                          const std::function<bool(const TestFlight&)>& counts) {
  std::vector<double> values;
  for (const TestFlight& flight : file.test.flights) {
    if (counts(flight)) values.push_back(figure(flight));
  }
  return Distribution(std::move(values));
}

bool any(const TestFlight&) { return true; }
bool is_whole(const TestFlight& flight) { return !flight.draw.return_time; }

Distribution clearance(const TestedFile& file, std::size_t criterion) {
  return distribution(
      file,
      [criterion](const TestFlight& f) { return f.simulated.nearest[criterion].closest.distance; },
      any);
}

std::size_t empty_batteries(const TestedFile& file) {
  return static_cast<std::size_t>(std::ranges::count_if(
      file.test.flights,
      [&](const TestFlight& flight) { return flight.simulated.energy > file.battery; }));
}

double simulated_flight_time(const TestFlight& flight) { return flight.simulated.time; }
double flight_energy_wh(const TestFlight& flight) {
  return flight.simulated.energy / joules_per_wh;
}
double max_cross_track(const TestFlight& flight) { return flight.simulated.off_line; }

Json flight_to_json(const TestFlight& flight) {
  Json json{{"flight", flight.draw.number},
            {"wind_m_s", {flight.draw.wind.x(), flight.draw.wind.y()}},
            {"called_home_s", nullptr},
            {"time_s", flight.simulated.time},
            {"energy_wh", flight_energy_wh(flight)},
            {"off_line_m", flight.simulated.off_line},
            {"clearance_m", Json::array()}};
  if (flight.draw.return_time) json["called_home_s"] = *flight.draw.return_time;
  for (const flight::NearestApproach& nearest : flight.simulated.nearest) {
    json["clearance_m"].push_back(nearest.closest.distance);
  }
  return json;
}

/// Returns the flight with the smallest distance.
const TestFlight& nearest_flight(const TestedFile& file, std::size_t criterion) {
  return *std::ranges::min_element(file.test.flights, {}, [criterion](const TestFlight& flight) {
    return flight.simulated.nearest[criterion].closest.distance;
  });
}

std::string criterion_text(const TestedFile& file, std::size_t j) {
  const flight::ClearanceCriterion& criterion = file.criteria[j];
  const Distribution distances = clearance(file, j);
  std::string text = fmt::format(
      "  clearance minimum {:.2f} m to {}, 5% below {:.2f}, median {:.2f}; required {:.2f}{}, {} "
      "flights below\n",
      distances.percentile(0), criterion.name, distances.percentile(5), distances.percentile(50),
      criterion.limit,
      criterion.overshoot > 0.0
          ? fmt::format(" ({:.2f} with a return)", criterion.limit - criterion.overshoot)
          : "",
      flights_nearer(file.test, file.criteria, j));
  const TestFlight& nearest = nearest_flight(file, j);
  const flight::NearestApproach& approach = nearest.simulated.nearest[j];
  if (approach.closest.kind != flight::ObstacleKind::none) {
    text += fmt::format(
        "            minimum reached in flight {} after {:.0f} s{}; nearest obstacle: {}\n",
        nearest.draw.number, approach.time, approach.is_returning ? ", on return" : "",
        file.obstacles[j]);
  }
  if (file.test.returns.empty() || file.test.returns[j].simulated == 0) return text;
  const flight::ReturnTest& returns = file.test.returns[j];
  return text + fmt::format(
                    "  returns   {} from random positions, minimum clearance {:.3f} m to {}; "
                    "required {:.3f}, {} below\n",
                    returns.simulated, returns.nearest.distance, criterion.name,
                    criterion.return_limit, returns.nearer);
}

}  // namespace

std::size_t failures(const TestedFile& file) {
  std::size_t sum = empty_batteries(file);
  for (std::size_t j = 0; j < file.criteria.size(); ++j) {
    sum += flights_nearer(file.test, file.criteria, j);
    if (!file.test.returns.empty()) sum += file.test.returns[j].nearer;
  }
  return sum;
}

std::string format_report(const TestedFile& file) {
  const flight::FlyTest& test = file.test;
  const auto return_count =
      test.flights.size() - static_cast<std::size_t>(std::ranges::count_if(test.flights, is_whole));
  std::string text = fmt::format("{}: {}, {} flights, {} of them with a return\n", file.name,
                                 file.autopilot, test.flights.size(), return_count);
  if (test.flights.empty()) return text;
  const Distribution times = distribution(file, simulated_flight_time, is_whole);
  const Distribution energies = distribution(file, flight_energy_wh, is_whole);
  if (!times.is_empty()) {
    text += fmt::format(
        "  time      estimated {:.0f} s; completed flights {:.0f} to {:.0f} s, median {:.0f}\n  "
        "energy    {:.1f} to {:.1f} Wh, median {:.1f}\n",
        test.planned_time, times.percentile(0), times.percentile(100), times.percentile(50),
        energies.percentile(0), energies.percentile(100), energies.percentile(50));
  }
  const Distribution all = distribution(file, flight_energy_wh, any);
  const Distribution off_line = distribution(file, max_cross_track, any);
  text += fmt::format(
      "  battery   minimum {:.0f}% left, {} flights with an empty battery\n"
      "  off track median {:.2f} m, 95% below {:.2f}, maximum {:.2f}\n",
      100.0 * (1.0 - all.percentile(100) * joules_per_wh / file.battery), empty_batteries(file),
      off_line.percentile(50), off_line.percentile(95), off_line.percentile(100));
  for (std::size_t j = 0; j < file.criteria.size(); ++j) text += criterion_text(file, j);
  return text;
}

Json to_json(const TestedFile& file) {
  Json json{{"file", file.name},
            {"autopilot", file.autopilot},
            {"failures", failures(file)},
            {"planned_time_s", file.test.planned_time},
            {"battery_wh", file.battery / joules_per_wh},
            {"time_s", distribution(file, simulated_flight_time, is_whole).json()},
            {"energy_wh", distribution(file, flight_energy_wh, is_whole).json()},
            {"off_line_m", distribution(file, max_cross_track, any).json()},
            {"clearance", Json::array()},
            {"flights", Json::array()}};
  for (std::size_t j = 0; j < file.criteria.size(); ++j) {
    Json clearances{{"from", file.criteria[j].name},
                    {"allowed_m", file.criteria[j].limit},
                    {"allowed_with_return_m", file.criteria[j].limit - file.criteria[j].overshoot},
                    {"flights_nearer", flights_nearer(file.test, file.criteria, j)},
                    {"distance_m", clearance(file, j).json()}};
    if (!file.test.returns.empty() && file.test.returns[j].simulated > 0) {
      const flight::ReturnTest& returns = file.test.returns[j];
      clearances["returns"] = {{"flown", returns.simulated},
                               {"allowed_m", file.criteria[j].return_limit},
                               {"nearer", returns.nearer},
                               {"least_m", returns.nearest.distance},
                               {"least_from", to_json(returns.from)}};
    }
    json["clearance"].push_back(std::move(clearances));
  }
  for (const TestFlight& flight : file.test.flights)
    json["flights"].push_back(flight_to_json(flight));
  return json;
}

std::string format_report(const flight::FleetFlightTest& test) {
  return fmt::format(
      "fleet: {} flights of all vehicles, minimum separation {:.2f} m (median of flights {:.2f} "
      "m), {} below {:.2f} m\n",
      test.simulated, test.min_separation, test.median_min_separation, test.nearer, test.limit);
}

Json to_json(const flight::FleetFlightTest& test) {
  return {{"flights", test.simulated},
          {"nearer", test.nearer},
          {"limit_m", test.limit},
          {"least_m", test.min_separation},
          {"least_median_m", test.median_min_separation}};
}

}  // namespace skycap::missions::cli
