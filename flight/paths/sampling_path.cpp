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

Vector3d to_position(const ob::State* state) {
  const double* values = state->as<ob::RealVectorStateSpace::StateType>()->values;
  return {values[0], values[1], values[2]};
}

/// Verifies legs exactly instead of sampling them, as OMPL does by default.
class VerifiedMotion : public ob::MotionValidator {
 public:
  VerifiedMotion(const ob::SpaceInformationPtr& information, const FreeSpace& space,
                 double clearance, std::size_t& checks)
      : ob::MotionValidator(information), space_(space), clearance_(clearance), checks_(checks) {}

  // OMPL requests motions only between valid states, so the start is known to be free.
  bool checkMotion(const ob::State* from, const ob::State* to) const override {
    ++checks_;
    return space_.continues_free({to_position(from), to_position(to)}, clearance_);
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

/// OMPL's generators receive their seeds from one source per process when they are constructed.
/// That source is reset before each search. OMPL's warning against this concerns existing
/// generators, whereas a search constructs its own.
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

ob::ScopedState<> state_at(const ob::StateSpacePtr& states, const Vector3d& position) {
  ob::ScopedState<> state(states);
  for (unsigned axis = 0; axis < 3; ++axis) state[axis] = position[axis];
  return state;
}

/// One search: OMPL's objects with Skycap's verification instead of sampling.
class OmplSearch {
 public:
  OmplSearch(const FreeSpace& space, const Vector3d& from, const Vector3d& to, double clearance,
             const SamplingOptions& options)
      : options_(options), states_(std::make_shared<ob::RealVectorStateSpace>(3)) {
    states_->setBounds(bounds_around(space, from, to, clearance));
    information_ = std::make_shared<ob::SpaceInformation>(states_);
    information_->setStateValidityChecker([this, &space, clearance](const ob::State* state) {
      ++checks_;
      const Vector3d position = to_position(state);
      return space.is_free({position, position}, clearance);
    });
    information_->setMotionValidator(
        std::make_shared<VerifiedMotion>(information_, space, clearance, checks_));
    information_->setup();
    problem_ = std::make_shared<ob::ProblemDefinition>(information_);
    problem_->setStartAndGoalStates(state_at(states_, from), state_at(states_, to));
    problem_->setOptimizationObjective(
        std::make_shared<ob::PathLengthOptimizationObjective>(information_));
  }

  /// Returns the best path found within the effort of the options, empty if none.
  std::vector<Vector3d> solve() {
    const auto planner = options_.planner == SamplingPlanner::bit_star
                             ? ob::PlannerPtr(std::make_shared<og::BITstar>(information_))
                             : ob::PlannerPtr(std::make_shared<og::AITstar>(information_));
    planner->setProblemDefinition(problem_);
    planner->setup();
    // One planner reports each path to the problem definition, the other uses the callback.
    bool has_path = false;
    problem_->setIntermediateSolutionCallback([&](const ob::Planner*,
                                                  const std::vector<const ob::State*>&,
                                                  const ob::Cost) { has_path = true; });
    planner->solve(ob::PlannerTerminationCondition([&] {
      has_path = has_path || problem_->hasExactSolution();
      return checks_ >= (has_path ? options_.max_checks : options_.max_checks_for_first_path);
    }));
    std::vector<Vector3d> points;
    if (!problem_->hasExactSolution()) return points;
    for (const ob::State* state :
         problem_->getSolutionPath()->as<og::PathGeometric>()->getStates()) {
      points.push_back(to_position(state));
    }
    return points;
  }

  std::size_t checks() const { return checks_; }

 private:
  const SamplingOptions& options_;
  std::shared_ptr<ob::RealVectorStateSpace> states_;
  ob::SpaceInformationPtr information_;
  ob::ProblemDefinitionPtr problem_;
  std::size_t checks_ = 0;
};

}  // namespace

Path find_path_by_sampling(const FreeSpace& space, const Vector3d& from, const Vector3d& to,
                           double clearance, const SamplingOptions& options) {
  if (!(clearance >= 0.0) || !std::isfinite(clearance)) {
    throw Error(ErrorKind::bad_config, "the clearance is " + std::to_string(clearance) +
                                           " m; it must be a finite number, zero or more");
  }
  if (options.seed == 0) {
    throw Error(ErrorKind::bad_config, "the seed of a sampling search is 0; it must be above 0");
  }
  Path path;
  path.status = PathStatus::start_not_free;
  if (!space.is_free({from, from}, clearance)) return path;
  path.status = PathStatus::goal_not_free;
  if (!space.is_free({to, to}, clearance)) return path;

  static std::mutex one_search_at_a_time;
  const std::lock_guard lock(one_search_at_a_time);
  seed_generators(options.seed);
  OmplSearch search(space, from, to, clearance, options);
  path.points = search.solve();
  path.expansions = search.checks();
  path.status = PathStatus::unreachable;
  if (path.points.empty()) return path;
  path.points = pull_tight(space, clearance, std::move(path.points), options.worthwhile_saving);
  path.length = length(path.points);
  path.status = PathStatus::found;
  return path;
}

}  // namespace skycap::flight
