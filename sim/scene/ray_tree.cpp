#include "sim/scene/ray_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <embree3/rtcore.h>

#include "geometry/error.h"
#include "geometry/parallel.h"

namespace skycap::sim {
namespace {

using Eigen::AlignedBox3f;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr unsigned leaf_size = 4;
static_assert(leaf_size <= tree_ref_entries);

// Triangles in single precision.
struct RoundedMesh {
  const geometry::Mesh& mesh;
  Vector3d centre;

  Vector3f corner(std::size_t triangle, int corner) const {
    return (mesh.vertices[mesh.triangles[triangle][corner]] - centre).cast<float>();
  }
  AlignedBox3f box(std::size_t triangle) const {
    AlignedBox3f all;
    for (int i = 0; i < 3; ++i) all.extend(corner(triangle, i));
    return all;
  }
};

RTCBuildPrimitive build_primitive(const AlignedBox3f& box, std::size_t number) {
  const Vector3f &lower = box.min(), &upper = box.max();
  return {.lower_x = lower.x(),
          .lower_y = lower.y(),
          .lower_z = lower.z(),
          .geomID = 0,
          .upper_x = upper.x(),
          .upper_y = upper.y(),
          .upper_z = upper.z(),
          .primID = static_cast<unsigned>(number)};
}

void* create_node(RTCThreadLocalAllocator allocator, unsigned, void*) {
  auto* const node =
      static_cast<TreeNode*>(rtcThreadLocalAlloc(allocator, sizeof(TreeNode), alignof(TreeNode)));
  for (auto& planes : node->planes) {
    std::fill(std::begin(planes), std::end(planes), std::numeric_limits<float>::infinity());
  }
  std::fill(std::begin(node->children), std::end(node->children), TreeRef{0});
  return node;
}

void set_children(void* to, void** children, unsigned count, void*) {
  for (unsigned i = 0; i < count; ++i) {
    static_cast<TreeNode*>(to)->children[i] = reinterpret_cast<TreeRef>(children[i]);
  }
}

void set_bounds(void* to, const RTCBounds** bounds, unsigned count, void*) {
  auto& planes = static_cast<TreeNode*>(to)->planes;
  for (unsigned i = 0; i < count; ++i) {
    const RTCBounds& box = *bounds[i];
    const float lower[] = {box.lower_x, box.lower_y, box.lower_z};
    const float upper[] = {box.upper_x, box.upper_y, box.upper_z};
    for (int axis = 0; axis < 3; ++axis) {
      planes[axis][i] = lower[axis];
      planes[axis][TreeNode::arity + i] = -upper[axis];
    }
  }
}

template <typename Entry>
Entry* allocate_leaf(RTCThreadLocalAllocator allocator, std::size_t entries) {
  return static_cast<Entry*>(
      rtcThreadLocalAlloc(allocator, entries * sizeof(Entry), tree_ref_entries + 1));
}

void* leaf_ref(void* leaf, std::size_t entries) {
  return reinterpret_cast<void*>(reinterpret_cast<TreeRef>(leaf) | entries);
}

void* create_triangles(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives,
                       std::size_t count, void* rounded_mesh) {
  const auto& mesh = *static_cast<const RoundedMesh*>(rounded_mesh);
  auto* const leaf = allocate_leaf<LeafTriangle>(allocator, count);
  for (std::size_t i = 0; i < count; ++i) {
    leaf[i].number = primitives[i].primID;
    for (int corner = 0; corner < 3; ++corner) {
      Eigen::Map<Vector3f>(leaf[i].corners[corner]) = mesh.corner(primitives[i].primID, corner);
    }
  }
  return leaf_ref(leaf, count);
}

void* create_numbers(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives,
                     std::size_t count, void*) {
  auto* const leaf = allocate_leaf<std::uint32_t>(allocator, count);
  for (std::size_t i = 0; i < count; ++i) leaf[i] = primitives[i].primID;
  return leaf_ref(leaf, count);
}

TreeRef build(RTCDevice device, RTCBVH tree, std::span<RTCBuildPrimitive> primitives,
              RTCCreateLeafFunction create_leaf, void* user) {
  throw_on_device_error(device);
  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.maxBranchingFactor = TreeNode::arity;
  arguments.maxDepth = max_tree_depth;
  arguments.sahBlockSize = leaf_size;
  arguments.maxLeafSize = leaf_size;
  arguments.bvh = tree;
  arguments.primitives = primitives.data();
  arguments.primitiveCount = primitives.size();
  arguments.primitiveArrayCapacity = primitives.size();
  arguments.createNode = create_node;
  arguments.setNodeChildren = set_children;
  arguments.setNodeBounds = set_bounds;
  arguments.createLeaf = create_leaf;
  arguments.userPtr = user;
  const auto root = reinterpret_cast<TreeRef>(rtcBuildBVH(&arguments));
  throw_on_device_error(device);
  return root;
}

float compute_extent(const AlignedBox3f& box) {
  return std::max(-box.min().minCoeff(), box.max().maxCoeff());
}

// Writes the boxes of one block of triangles. Returns their extent.
float fill_boxes(const RoundedMesh& mesh, std::size_t first, std::span<RTCBuildPrimitive> boxes) {
  float extent = 0.0F;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const AlignedBox3f box = mesh.box(first + i);
    const float reach = compute_extent(box);
    if (!std::isfinite(reach)) {
      throw Error(ErrorKind::bad_geometry,
                  "triangle " + std::to_string(first + i) +
                      " has a coordinate outside the single-precision range");
    }
    extent = std::max(extent, reach);
    boxes[i] = build_primitive(box, first + i);
  }
  return extent;
}

}  // namespace

void throw_on_device_error(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  if (error == RTC_ERROR_OUT_OF_MEMORY) {
    throw Error(ErrorKind::bad_geometry,
                "out of memory while building the scene for ray casting; use a mesh with fewer "
                "triangles");
  }
  throw Error(ErrorKind::bad_geometry,
              "Embree cannot build the scene: error " + std::to_string(error));
}

void RayTree::Release::operator()(RTCBVHTy* tree) const {
  rtcReleaseBVH(tree);
  rtcReleaseDevice(device);
}

RayTree::Memory RayTree::new_memory(RTCDevice device) {
  Memory memory(rtcNewBVH(device), {device});
  if (memory) rtcRetainDevice(device);
  return memory;
}

RayTree::RayTree(RTCDevice device, const geometry::Mesh& mesh, const Vector3d& centre,
                 unsigned threads)
    : memory_(new_memory(device)) {
  RoundedMesh rounded{mesh, centre};
  const std::size_t triangles = mesh.triangles.size();
  const auto boxes = std::make_unique_for_overwrite<RTCBuildPrimitive[]>(triangles);
  constexpr std::size_t block = 1 << 16;
  std::vector<float> extents((triangles + block - 1) / block);
  geometry::parallel_for(extents.size(), threads, [&](std::size_t i) {
    const std::size_t first = i * block;
    extents[i] = fill_boxes(rounded, first, {&boxes[first], std::min(block, triangles - first)});
  });
  root_.extent = *std::ranges::max_element(extents);
  root_.ref = build(device, memory_.get(), {boxes.get(), triangles}, create_triangles, &rounded);
}

RayTree::RayTree(RTCDevice device, std::span<const AlignedBox3f> boxes)
    : memory_(new_memory(device)) {
  std::vector<RTCBuildPrimitive> primitives;
  for (const AlignedBox3f& box : boxes) {
    root_.extent = std::max(root_.extent, compute_extent(box));
    primitives.push_back(build_primitive(box, primitives.size()));
  }
  root_.ref = build(device, memory_.get(), primitives, create_numbers, nullptr);
}

}  // namespace skycap::sim
