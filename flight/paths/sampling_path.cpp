#include "flight/paths/sampling_path.h"

#include <cmath>
#include <memory>
#include <mutex>
#include <string>

#include <ompl/base/MotionValidator.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/informedtrees/AITstar.h>
#include <ompl/geometric/planners/informedtrees/BITstar.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include "geometry/error.h"

namespace skycap::flight {
namespace {

namespace ob = ompl::base;
namespace og = ompl::geometric;
using Eigen::Vector3d;

Vector3d place_of(const ob::State* state) {
  const double* values = state->as<ob::RealVectorStateSpace::StateType>()->values;
  return {values[0], values[1], values[2]};
}

/// Legs by the exact proof, not by samples along them, which is OMPL's default.
class ProvenMotion : public ob::MotionValidator {
 public:
  ProvenMotion(const ob::SpaceInformationPtr& information, const FreeSpace& space, double clearance,
               std::size_t& checks)
      : ob::MotionValidator(information), space_(space), clearance_(clearance), checks_(checks) {}

  // OMPL asks for motions between states that it has found valid, so the start is known to be free.
  bool checkMotion(const ob::State* from, const ob::State* to) const override {
    ++checks_;
    return space_.continues_free({place_of(from), place_of(to)}, clearance_);
  }
  bool checkMotion(const ob::State* from, const ob::State* to,
                   std::pair<ob::State*, double>& last_valid) const override {
    const bool is_free = checkMotion(from, to);
    if (!is_free) {
      last_valid.second = 0.0;
      if (last_valid.first != nullptr) si_->copyState(last_valid.first, from);
    }
    return is_free;
  }

 private:
  const FreeSpace& space_;
  double clearance_;
  std::size_t& checks_;
};

/// OMPL's generators take their seeds from one source for the whole process, when they are made. It
/// can be set anew before each search, though OMPL warns of that, thinking of generators made
/// before; a search makes its own.
void seed_generators(std::uint32_t seed) {
  ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
  ompl::RNG::setSeed(seed);
}

ob::RealVectorBounds bounds_around(const FreeSpace& space, const Vector3d& from, const Vector3d& to,
                                   double clearance) {
  Eigen::AlignedBox3d box = space.extent();
  box.extend(from), box.extend(to);
  ob::RealVectorBounds bounds(3);
  const double grown = 2.0 * clearance + 0.1 * (to - from).norm();
  for (unsigned axis = 0; axis < 3; ++axis) {
    bounds.setLow(axis, box.min()[axis] - grown);
    bounds.setHigh(axis, box.max()[axis] + grown);
  }
  return bounds;
}

}  // namespace

Path find_path_by_sampling(const FreeSpace& space, const Vector3d& from, const Vector3d& to,
                           double clearance, const SamplingOptions& options) {
  if (!(clearance >= 0.0) || !std::isfinite(clearance)) {
    throw Error(ErrorKind::bad_config, "the clearance is " + std::to_string(clearance) +
                                           " m; it must be a finite number, zero or more");
  }
  if (options.seed == 0) {
    throw Error(ErrorKind::bad_config, "the seed of a search by sampling is 0; it must be above");
  }
  Path path;
  path.status = PathStatus::start_not_free;
  if (!space.is_free({from, from}, clearance)) return path;
  path.status = PathStatus::goal_not_free;
  if (!space.is_free({to, to}, clearance)) return path;

  static std::mutex one_search_at_a_time;
  const std::lock_guard lock(one_search_at_a_time);
  seed_generators(options.seed);
  const auto states = std::make_shared<ob::RealVectorStateSpace>(3);
  states->setBounds(bounds_around(space, from, to, clearance));
  const auto information = std::make_shared<ob::SpaceInformation>(states);
  std::size_t checks = 0;
  information->setStateValidityChecker([&](const ob::State* state) {
    ++checks;
    const Vector3d place = place_of(state);
    return space.is_free({place, place}, clearance);
  });
  information->setMotionValidator(
      std::make_shared<ProvenMotion>(information, space, clearance, checks));
  information->setup();

  const auto problem = std::make_shared<ob::ProblemDefinition>(information);
  ob::ScopedState<> start(states), goal(states);
  for (unsigned axis = 0; axis < 3; ++axis) start[axis] = from[axis], goal[axis] = to[axis];
  problem->setStartAndGoalStates(start, goal);
  problem->setOptimizationObjective(
      std::make_shared<ob::PathLengthOptimizationObjective>(information));

  const auto planner = options.planner == SamplingPlanner::bit_star
                           ? ob::PlannerPtr(std::make_shared<og::BITstar>(information))
                           : ob::PlannerPtr(std::make_shared<og::AITstar>(information));
  planner->setProblemDefinition(problem);
  planner->setup();
  // One of the planners tells the problem of each path it finds, the other calls back.
  bool has_path = false;
  problem->setIntermediateSolutionCallback([&](const ob::Planner*,
                                               const std::vector<const ob::State*>&,
                                               const ob::Cost) { has_path = true; });
  planner->solve(ob::PlannerTerminationCondition([&] {
    has_path = has_path || problem->hasExactSolution();
    return checks >= (has_path ? options.max_checks : options.max_checks_for_first_path);
  }));

  path.expansions = checks;
  path.status = PathStatus::unreachable;
  if (!problem->hasExactSolution()) return path;
  for (const ob::State* state : problem->getSolutionPath()->as<og::PathGeometric>()->getStates()) {
    path.points.push_back(place_of(state));
  }
  path.points = pull_tight(space, clearance, std::move(path.points), options.worthwhile_saving);
  path.length = length(path.points);
  path.status = PathStatus::found;
  return path;
}

}  // namespace skycap::flight
