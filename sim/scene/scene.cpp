#include "sim/scene/scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "sim/scene/scene_embree.h"

namespace skycap::sim {
namespace {

using Eigen::Vector3d;

int native_packet_width(RTCDevice device) {
  if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0) return 16;
  if (rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) != 0) return 8;
  return 4;
}

void throw_on_device_error(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  throw Error(ErrorKind::bad_geometry,
              error == RTC_ERROR_OUT_OF_MEMORY
                  ? "there is not enough memory to make the scene ready for ray casting; use a "
                    "mesh with fewer triangles"
                  : "Embree cannot build the scene: error " + std::to_string(error));
}

/// The mesh as Embree's buffers, in single precision around `centre`.
RTCGeometry make_geometry(RTCDevice device, const geometry::Mesh& mesh, const Vector3d& centre) {
  const RTCGeometry triangles = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(triangles, RTC_BUFFER_TYPE_VERTEX, 0,
                                                               RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                               mesh.vertices.size()));
  auto* indices = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(triangles, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                              3 * sizeof(std::uint32_t), mesh.triangles.size()));
  if (vertices != nullptr && indices != nullptr) {
    for (const Vector3d& vertex : mesh.vertices) {
      for (int axis = 0; axis < 3; ++axis) {
        *vertices++ = static_cast<float>(vertex[axis] - centre[axis]);
      }
    }
    for (const auto& triangle : mesh.triangles) {
      for (const std::uint32_t vertex : triangle) *indices++ = vertex;
    }
    rtcCommitGeometry(triangles);
  }
  return triangles;
}

RTCScene make_scene(RTCDevice device) {
  const RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
  return scene;
}

/// Hands `geometry` over to `scene`, whose only reference it then is.
void attach(RTCScene scene, RTCGeometry geometry) {
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
}

void commit(RTCDevice device, RTCScene scene) {
  throw_on_device_error(device);
  rtcCommitScene(scene);
  throw_on_device_error(device);
}

RTCGeometry make_instance(RTCDevice device, RTCScene model, const Eigen::Isometry3d& place) {
  const RTCGeometry instance = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(instance, model);
  const Eigen::Matrix<float, 3, 4> transform = place.matrix().topRows<3>().cast<float>();
  rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, transform.data());
  rtcCommitGeometry(instance);
  return instance;
}

std::vector<Eigen::Isometry3d> places_of(const ScenePart& part) {
  if (part.places.empty()) return {Eigen::Isometry3d::Identity()};
  return {part.places.begin(), part.places.end()};
}

/// A box around all copies of all parts.
Eigen::AlignedBox3d box_around(std::span<const ScenePart> parts) {
  Eigen::AlignedBox3d all;
  for (const ScenePart& part : parts) {
    const Eigen::AlignedBox3d box = geometry::bounding_box(part.mesh);
    for (const Eigen::Isometry3d& place : places_of(part)) {
      for (int corner = 0; corner < 8; ++corner) {
        all.extend(place * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
      }
    }
  }
  return all;
}

/// A ray in Embree's frame; `direction` is a unit vector.
RTCRay make_ray(const Vector3d& origin, const Vector3d& direction, double max_distance) {
  RTCRay ray = {};
  ray.org_x = static_cast<float>(origin.x());
  ray.org_y = static_cast<float>(origin.y());
  ray.org_z = static_cast<float>(origin.z());
  ray.dir_x = static_cast<float>(direction.x());
  ray.dir_y = static_cast<float>(direction.y());
  ray.dir_z = static_cast<float>(direction.z());
  ray.tfar = static_cast<float>(max_distance);
  ray.mask = ~0U;
  return ray;
}

bool is_hit(const RTCRayHit& query) { return query.hit.geomID != RTC_INVALID_GEOMETRY_ID; }

/// Every copy as an instance of its part, which Embree holds once.
std::vector<SceneCopy> attach_copies(RTCDevice device, RTCScene scene, const Vector3d& centre,
                                     std::span<const ScenePart> parts) {
  std::vector<SceneCopy> copies;
  std::size_t first_triangle = 0, own_triangle = 0;
  for (const ScenePart& part : parts) {
    const Vector3d middle = geometry::bounding_box(part.mesh).center();
    const std::unique_ptr<RTCSceneTy, decltype(&rtcReleaseScene)> model(make_scene(device),
                                                                        rtcReleaseScene);
    attach(model.get(), make_geometry(device, part.mesh, middle));
    commit(device, model.get());
    for (const Eigen::Isometry3d& place : places_of(part)) {
      const Eigen::Isometry3d centre_from_middle =
          Eigen::Translation3d(-centre) * place * Eigen::Translation3d(middle);
      attach(scene, make_instance(device, model.get(), centre_from_middle));
      copies.push_back({place.linear().cast<float>(), static_cast<std::uint32_t>(first_triangle),
                        static_cast<std::uint32_t>(own_triangle)});
      first_triangle += part.mesh.triangles.size();
    }
    own_triangle += part.mesh.triangles.size();
  }
  if (first_triangle > RTC_INVALID_GEOMETRY_ID) {
    throw Error(ErrorKind::bad_geometry, "the scene's copies have " +
                                             std::to_string(first_triangle) +
                                             " triangles in all; 4294967295 can be numbered");
  }
  return copies;
}

void require_one_each(std::span<const float> reflectances, const geometry::Mesh& mesh) {
  if (reflectances.size() == mesh.triangles.size()) return;
  throw Error(ErrorKind::bad_geometry, "there are " + std::to_string(reflectances.size()) +
                                           " reflectances for " +
                                           std::to_string(mesh.triangles.size()) + " triangles");
}

// Whether the ray has met a surface from the side that its normal points to.
bool is_front(const RTCRayHit& query) {
  const auto& [ray, hit] = query;
  return is_hit(query) && ray.dir_x * hit.Ng_x + ray.dir_y * hit.Ng_y + ray.dir_z * hit.Ng_z < 0.0F;
}

}  // namespace

Scene::Scene(const geometry::Mesh& mesh, unsigned threads)
    : Scene(std::array{ScenePart{mesh, {}, {}}}, threads) {}

Scene::Scene(const geometry::Mesh& mesh, std::span<const float> reflectances, unsigned threads)
    : Scene(std::array{ScenePart{mesh, reflectances, {}}}, threads) {
  require_one_each(reflectances, mesh);
}

Scene::Scene(std::span<const ScenePart> parts, unsigned threads)
    : embree_(std::make_unique<Embree>()) {
  if (parts.empty()) throw Error(ErrorKind::bad_geometry, "the scene has no meshes");
  for (const ScenePart& part : parts) {
    geometry::validate(part.mesh);
    if (!part.reflectances.empty()) require_one_each(part.reflectances, part.mesh);
  }
  const std::string config = "threads=" + std::to_string(geometry::thread_count(threads));
  embree_->device = rtcNewDevice(config.c_str());
  if (embree_->device == nullptr) throw_on_device_error(nullptr);
  const RTCDevice device = embree_->device;
  embree_->packet_width = native_packet_width(device);
  embree_->centre = box_around(parts).center();
  embree_->scene = make_scene(device);
  if (parts.size() == 1 && parts[0].places.empty()) {
    attach(embree_->scene, make_geometry(device, parts[0].mesh, embree_->centre));
  } else {
    embree_->copies = attach_copies(device, embree_->scene, embree_->centre, parts);
  }
  commit(device, embree_->scene);

  if (std::ranges::all_of(parts, [](const auto& part) { return part.reflectances.empty(); })) {
    return;
  }
  for (const ScenePart& part : parts) {
    reflectances_.insert(reflectances_.end(), part.reflectances.begin(), part.reflectances.end());
    const std::size_t defaults = part.mesh.triangles.size() - part.reflectances.size();
    reflectances_.insert(reflectances_.end(), defaults, default_reflectance);
  }
}

Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

std::size_t Scene::own_triangle(std::uint32_t triangle) const {
  const std::vector<SceneCopy>& copies = embree_->copies;
  if (copies.empty()) return triangle;
  const auto next =
      std::ranges::upper_bound(copies, triangle, std::less<>(), &SceneCopy::first_triangle);
  const SceneCopy& copy = *std::prev(next);
  return copy.own_triangle + (triangle - copy.first_triangle);
}

std::optional<Hit> Scene::first_hit(const Vector3d& origin, const Vector3d& direction,
                                    double max_distance) const {
  const double length = direction.norm();
  RTCRayHit query = {};
  query.ray = make_ray(origin - embree_->centre, direction / length, max_distance * length);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  const auto intersect = [&](RTCRayHit& ray) {
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(embree_->scene, &context, &ray);
    if (embree_->copies.empty() || !is_hit(ray)) return;
    auto& [hit_ray, hit] = ray;
    take_to_world(embree_->copies[hit.instID[0]], hit.Ng_x, hit.Ng_y, hit.Ng_z, hit.primID);
  };
  intersect(query);
  if (!is_front(query)) {  // perhaps it passed through a vertex: see scene_embree.h
    RTCRayHit turned = query;
    turn(turned.ray.dir_x, turned.ray.dir_y, turned.ray.dir_z);
    intersect(turned);
    if (is_hit(turned)) query = turned;
  }
  if (!is_hit(query)) return std::nullopt;
  return Hit{query.ray.tfar / length, query.hit.primID,
             Vector3d(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z).normalized()};
}

bool Scene::is_blocked(const Vector3d& from, const Vector3d& to) const {
  const double length = (to - from).norm();
  if (length == 0.0) return false;
  RTCRay ray = make_ray(from - embree_->centre, (to - from) / length, length);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(embree_->scene, &context, &ray);
  return ray.tfar < 0.0F;  // Embree's mark for a hit
}

}  // namespace skycap::sim
