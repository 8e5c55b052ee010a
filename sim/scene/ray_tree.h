/// Bounding volume hierarchy for ray casting. Embree builds it. The memory layout is Skycap's own,
/// because the hit test is, too (ray_kernels.h).
///
/// The assignment of triangles to leaves depends on the processor and Embree's version, but results
/// do not. The tree affects neither the set of hits nor their order, only the number of triangles
/// to test.
#pragma once

#include <memory>
#include <span>

#include "geometry/surfaces/mesh.h"
#include "sim/scene/tree_layout.h"

struct RTCDeviceTy;  // Embree type.
struct RTCBVHTy;

namespace skycap::sim {

/// Throws Error{bad_geometry} if an Embree call has failed. A null `device` reports the failure to
/// create one.
void throw_on_device_error(RTCDeviceTy* device);

/// Owner of a tree's memory.
class RayTree {
 public:
  /// Builds a tree over the triangles of a mesh, translated by -`centre` in double precision and
  /// then rounded to single precision. `device` sets the number of threads. Throws
  /// Error{bad_geometry} if a coordinate exceeds single precision or memory is insufficient.
  RayTree(RTCDeviceTy* device, const geometry::Mesh& mesh, const Eigen::Vector3d& centre,
          unsigned threads);
  /// Builds a tree over boxes of any content. Leaf entries are their indices as std::uint32_t.
  RayTree(RTCDeviceTy* device, std::span<const Eigen::AlignedBox3f> boxes);

  const TreeRoot& root() const { return root_; }

 private:
  // Deleter that also keeps the device, because Embree notifies it when a tree is released but does
  // not keep it alive.
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
