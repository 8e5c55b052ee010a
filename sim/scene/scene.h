/// Scene prepared for ray casting. It is the ground truth, which only `sim/` and the evaluation may
/// access.
///
/// Rays are cast in single precision. Therefore the mesh is first translated to the origin of its
/// own frame in double precision. All queries use world coordinates. No ray passes between
/// triangles that share an edge or a vertex, and a hit depends only on the ray and the triangles
/// (see scene/ray_kernels.h).
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/surfaces/mesh.h"
#include "sim/scene/surface.h"

namespace skycap::sim {

/// First intersection of a ray with the scene.
struct Hit {
  double distance;         ///< Distance along the ray, in multiples of the direction's length.
  std::uint32_t triangle;  ///< Index of the mesh triangle.
  Eigen::Vector3d normal;  ///< Unit normal of the triangle according to its orientation.
};

/// Mesh of a scene with one or more copies. Refers to data of the caller.
struct ScenePart {
  const geometry::Mesh& mesh;
  /// Diffuse reflectance of each triangle at the laser wavelength, in [0, 1]. Empty: the default.
  std::span<const float> reflectances;
  /// world_from_mesh of each copy: rotation and translation without scale. Empty: one copy at the
  /// identity.
  std::span<const Eigen::Isometry3d> poses;
  /// Surface of each triangle. Empty: all matt.
  std::span<const Surface> surfaces = {};
};

/// Immutable and thread-safe.
class Scene {
 public:
  /// Reflectance of unspecified surfaces: between asphalt and bright stone.
  static constexpr float default_reflectance = 0.4F;

  /// Builds the ray-casting structure on `threads` threads (0: all processors). Keeps no reference
  /// to `mesh`. Throws the same errors as geometry::validate().
  explicit Scene(const geometry::Mesh& mesh, unsigned threads = 0);
  /// Builds a scene with the diffuse reflectance of each triangle at the laser wavelength, in [0,
  /// 1]. Throws Error{bad_geometry} if the number of reflectances differs from that of triangles.
  Scene(const geometry::Mesh& mesh, std::span<const float> reflectances, unsigned threads = 0);
  /// Builds a scene of several meshes with any number of copies, which take almost no memory.
  /// Triangle numbers are those of one mesh with all copies of all parts appended in order. Hits
  /// are those of that mesh, apart from rounding. Throws the errors above, also if there are no
  /// parts.
  explicit Scene(std::span<const ScenePart> parts, unsigned threads = 0);
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;
  ~Scene();

  /// Returns the first surface of any kind at a distance in [0, max_distance] from `origin` along
  /// `direction`. The distance is in multiples of the direction's length. The accuracy is that of
  /// single precision for the extent of the scene.
  std::optional<Hit> first_hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                               double max_distance = std::numeric_limits<double>::infinity()) const;

  /// Returns true if a surface intersects the segment between two points, ends included. To test
  /// the visibility of a surface point, end the segment slightly before it.
  bool is_blocked(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const;

  /// Line of sight between two points.
  struct SightLine {
    Eigen::Vector3d from, to;
  };
  /// Maximum number of sights for blocked().
  static constexpr std::size_t max_sight_lines = 16;
  /// Returns the results of is_blocked() as a bit mask; the lowest bit is the first sight. Fast for
  /// near-parallel sights of similar length.
  std::uint32_t blocked(std::span<const SightLine> sight_lines) const;

  /// Returns the diffuse reflectance of a triangle, in [0, 1].
  float reflectance(std::uint32_t triangle) const {
    return reflectances_.empty() ? default_reflectance : own_reflectance(triangle);
  }

  /// Returns the surface type of a triangle.
  Surface surface(std::uint32_t triangle) const;

  /// Returns true if triangles have individual reflectances.
  bool has_reflectances() const { return !reflectances_.empty(); }

  /// Geometry that the sensors of this library cast rays at. Defined in scene/scene_trees.h, which
  /// only sources include.
  struct Trees;
  const Trees& trees() const { return *trees_; }

 private:
  friend class SceneBuilder;
  Scene(std::unique_ptr<Trees> trees, std::vector<float> reflectances);
  float own_reflectance(std::uint32_t triangle) const;

  std::unique_ptr<Trees> trees_;
  // Reflectances of the triangles of each part. Empty: the default.
  std::vector<float> reflectances_;
};

/// Builds a scene part by part, so that only one of many tile meshes must be in memory. The frame
/// of each part depends only on its mesh and the centre. A first hit is therefore bit-identical for
/// any set of further parts, as long as the hit parts are present in the same order.
class SceneBuilder {
 public:
  /// Rays are cast relative to `centre`, which should be near the middle of the scene. Trees are
  /// built on `threads` threads (0: all processors).
  explicit SceneBuilder(const Eigen::Vector3d& centre, unsigned threads = 0);
  SceneBuilder(const SceneBuilder&) = delete;
  SceneBuilder& operator=(const SceneBuilder&) = delete;
  ~SceneBuilder();

  /// Adds a part. Triangle numbers continue from the previous part. Keeps no reference. Throws the
  /// errors of Scene's constructors.
  void add(const ScenePart& part);

  /// Returns the scene of all parts, possibly without any. The builder must not be used afterwards.
  Scene finish();

 private:
  struct Growth;
  std::unique_ptr<Growth> growth_;
};

}  // namespace skycap::sim
