/// A tree of boxes that rays walk down to the triangles they may hit. Embree builds it; how it lies
/// in memory is our own, because what is a hit is decided by our own arithmetic (ray_kernels.h).
///
/// Which triangle lies in which leaf depends on the processor, on Embree's version and on nothing
/// that a result may depend on: of a ray's hits the tree decides neither which there are nor which
/// is nearest, only how few triangles are looked at.
#pragma once

#include <memory>
#include <span>

#include "geometry/surfaces/mesh.h"
#include "sim/scene/tree_layout.h"

struct RTCDeviceTy;  // Embree's
struct RTCBVHTy;

namespace skycap::sim {

/// Throws Error{bad_geometry} if a call of Embree's has failed; without a device, to make one.
void throw_on_device_error(RTCDeviceTy* device);

/// Owns a tree's memory.
class RayTree {
 public:
  /// Over the triangles of a mesh, moved by -`centre` in double precision and then rounded to
  /// single. `device` sets the number of threads. Throws Error{bad_geometry} if a coordinate is
  /// beyond single precision or memory runs out.
  RayTree(RTCDeviceTy* device, const geometry::Mesh& mesh, const Eigen::Vector3d& centre,
          unsigned threads);
  /// Over boxes of any content: a leaf's entries are their numbers, as std::uint32_t.
  RayTree(RTCDeviceTy* device, std::span<const Eigen::AlignedBox3f> boxes);

  const TreeRoot& root() const { return root_; }

 private:
  // A tree tells its device when it goes, and does not keep it alive by itself.
  struct Release {
    RTCDeviceTy* device;
    void operator()(RTCBVHTy* tree) const;
  };
  using Memory = std::unique_ptr<RTCBVHTy, Release>;
  static Memory new_memory(RTCDeviceTy* device);

  Memory memory_;
  TreeRoot root_;
};

}  // namespace skycap::sim
