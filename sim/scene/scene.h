/// A scene made ready for ray casting: the truth, which only `sim/` and the evaluation may ask.
///
/// Rays are cast in single precision, so the mesh is moved to around the origin of its own frame in
/// double precision first; every query takes and gives world coordinates. No ray slips between
/// triangles that share an edge or a vertex, and what a ray meets depends on nothing but the ray
/// and the triangles (scene/ray_kernels.h says how).
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

/// Where a ray first meets the scene.
struct Hit {
  double distance;         ///< along the ray, in units of its direction's length
  std::uint32_t triangle;  ///< index into the mesh's triangles
  Eigen::Vector3d normal;  ///< unit normal of that triangle, by its orientation
};

/// A mesh of a scene, once or several times; all of it is the caller's.
struct ScenePart {
  const geometry::Mesh& mesh;
  /// Diffuse reflectance of each triangle, in [0, 1], at the laser's wavelength; none: the default.
  std::span<const float> reflectances;
  /// world_from_mesh of each copy, turned and shifted but not scaled; none: once, as it is.
  std::span<const Eigen::Isometry3d> places;
  /// Of each triangle; none: all matt.
  std::span<const Surface> surfaces = {};
};

/// Immutable; safe to query from any number of threads.
class Scene {
 public:
  /// Of surfaces about which nothing is known: between asphalt and bright stone.
  static constexpr float default_reflectance = 0.4F;

  /// Builds the ray-casting structure on `threads` threads (zero: all processors). Keeps no
  /// reference to `mesh`. Throws what geometry::validate() throws.
  explicit Scene(const geometry::Mesh& mesh, unsigned threads = 0);
  /// The same with the diffuse reflectance of each triangle, in [0, 1], at the laser's wavelength.
  /// Throws Error{bad_geometry} if their number is not that of the triangles.
  Scene(const geometry::Mesh& mesh, std::span<const float> reflectances, unsigned threads = 0);
  /// Several meshes, each any number of times: copies take no memory to speak of. Triangles are
  /// numbered as if every copy of every part had been appended to one mesh, in that order, and rays
  /// meet what they would meet of that mesh, but for rounding. Throws the same, also when there
  /// is no part.
  explicit Scene(std::span<const ScenePart> parts, unsigned threads = 0);
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;
  ~Scene();

  /// The first surface, of whatever kind, that the ray from `origin` along `direction` (of any
  /// length) meets at a distance in [0, max_distance]. Exact to single precision of the scene's
  /// extent.
  std::optional<Hit> first_hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                               double max_distance = std::numeric_limits<double>::infinity()) const;

  /// Whether a surface cuts the segment between two points, its ends included. To ask whether a
  /// point of the surface is visible, end the segment a little before it.
  bool is_blocked(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const;

  /// A straight line from one place to another.
  struct Sight {
    Eigen::Vector3d from, to;
  };
  /// The most that blocked() takes.
  static constexpr std::size_t most_sights = 16;
  /// A bit for each of the sights, the lowest for the first: what is_blocked() says of it. Quick
  /// where they are about as long and run side by side.
  std::uint32_t blocked(std::span<const Sight> sights) const;

  /// Diffuse reflectance of a triangle, in [0, 1].
  float reflectance(std::uint32_t triangle) const {
    return reflectances_.empty() ? default_reflectance : own_reflectance(triangle);
  }

  /// What a triangle does to light.
  Surface surface(std::uint32_t triangle) const;

  /// Whether triangles have reflectances of their own.
  bool has_reflectances() const { return !reflectances_.empty(); }

  /// What the sensors in this folder cast their rays at; defined in scene/scene_trees.h, for
  /// sources only.
  struct Trees;
  const Trees& trees() const { return *trees_; }

 private:
  friend class SceneBuilder;
  Scene(std::unique_ptr<Trees> trees, std::vector<float> reflectances);
  float own_reflectance(std::uint32_t triangle) const;

  std::unique_ptr<Trees> trees_;
  std::vector<float> reflectances_;  // of each part's triangles; empty: all the default
};

/// Makes a scene of parts that come one after the other, so that of many tiles but one mesh need be
/// in memory at a time. Each part is met in a frame of its own, whose place follows from its mesh
/// and from the centre alone: what a ray meets first is the same, to the bit, whichever further
/// parts there are, as long as those that it meets are among them, in the same order.
class SceneBuilder {
 public:
  /// Rays will be cast relative to `centre`, which should be about the middle of the scene. Trees
  /// are built on `threads` threads (zero: all processors).
  explicit SceneBuilder(const Eigen::Vector3d& centre, unsigned threads = 0);
  SceneBuilder(const SceneBuilder&) = delete;
  SceneBuilder& operator=(const SceneBuilder&) = delete;
  ~SceneBuilder();

  /// Triangles are numbered on from those of the parts before. Keeps no reference. Throws what
  /// Scene's constructors throw.
  void add(const ScenePart& part);

  /// The scene of all parts, perhaps of none; the builder is of no use any more.
  Scene finish();

 private:
  struct Growth;
  std::unique_ptr<Growth> growth_;
};

}  // namespace skycap::sim
