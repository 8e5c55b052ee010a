/// A space whose questions stop being answered when the work shall stop: every search for paths
/// asks for little else, so this ends any of them, at once and wherever it is.
#pragma once

#include <stop_token>
#include <string>
#include <utility>

#include "flight/space/clearance.h"

namespace skycap::flight {

/// Answers as `space` does, which must outlive it, until a stop is requested; from then on every
/// question throws Interrupted.
class InterruptibleSpace : public FreeSpace {
 public:
  explicit InterruptibleSpace(const FreeSpace& space, std::stop_token stop = {})
      : space_(space), stop_(std::move(stop)) {}

  void stop_on(std::stop_token stop) { stop_ = std::move(stop); }

  Closest closest(const Segment& leg, double up_to) const override;
  bool continues_free(const Segment& leg, double clearance) const override;
  double surface_distance(const Eigen::Vector3d& point, double up_to) const override;
  Eigen::AlignedBox3d extent() const override { return space_.extent(); }
  std::string name(const Closest& closest) const override { return space_.name(closest); }

 private:
  const FreeSpace& space_;
  std::stop_token stop_;
};

}  // namespace skycap::flight
