/// Free space with cancellable queries. Since path searches consist mostly of queries, this cancels
/// any search promptly.
#pragma once

#include <stop_token>
#include <string>
#include <utility>

#include "flight/clearance/clearance.h"

namespace skycap::flight {

/// Forwards queries to `space`, which must outlive this object. Once a stop is requested, every
/// query throws Interrupted.
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
