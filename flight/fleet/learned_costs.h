/// What the parts of a fleet's flights take, better known with every route that is certified.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "flight/fleet/fleet_costs.h"

namespace skycap::flight {

/// Estimates of straight_costs(), and in their place what certified routes take. A part that turned
/// out dearer than its estimate lets the estimates of its like rise, too, until they are known: of
/// the same way flown back, and of the same vehicle's from a pad nearby. Other parts whose straight
/// line is not free are thought to take longer by the mean share of all such that are known.
class LearnedCosts {
 public:
  LearnedCosts(std::span<const Station> stations, std::vector<FleetMember> members);

  const FleetProblem& problem() const { return problem_; }

  /// Takes in a certified route of a vehicle; stations[i] is the number of its station i.
  void learn(std::size_t vehicle, const Route& route, std::span<const std::uint32_t> stations);
  /// No battery of this vehicle is enough for the station.
  void refuse(std::size_t vehicle, std::uint32_t station);

 private:
  enum class Way { out, back };
  enum class State : std::uint8_t { free, blocked, raised, known };

  bool is_alike(std::size_t vehicle, std::size_t other) const;
  void learn_leg(std::size_t vehicle, std::uint32_t from, std::uint32_t to, const PartCost& cost);
  void learn_end(std::size_t vehicle, Way way, std::uint32_t station, const PartCost& cost);
  PartCost& end(std::size_t vehicle, Way way, std::uint32_t station);
  bool is_near(std::size_t vehicle, std::size_t other, std::uint32_t station) const;
  void note_detour(State state, const PartCost& cost, const PartCost& estimate);
  void guess_blocked();

  std::vector<FleetMember> members_;
  std::vector<Eigen::Vector3d> places_;  ///< of stations
  FleetProblem straight_, problem_;
  std::vector<std::vector<State>> states_;  ///< by vehicle: legs, then ways out, then ways back
  double detours_, noted_;                  ///< sum of time shares of those noted, and their number
};

}  // namespace skycap::flight
