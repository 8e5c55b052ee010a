#include "survey/surfel/surfel_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "geometry/parallel.h"
#include "geometry/pose/pose.h"

namespace skycap::survey::surfel {
namespace {

using Eigen::Vector3f;

// Lengths are in units of the spacing h, areas in units of its square.
constexpr float min_distance = 0.9F;       // minimum distance between surfels
constexpr float packed_area = 1.16F;       // area per surfel for random packing at that distance
constexpr float largest_area = 3.5F;       // maximum initial area of an oblique block
constexpr float neighbour_reach = 2.5F;    // maximum distance of a surfel that continues another
constexpr float neighbour_cosine = 0.75F;  // maximum angle to the direction: 41 degrees
constexpr float off_plane_tolerance = 0.6F;
constexpr float sharing_reach = 1.6F;  // range in which noise displaces measurements
constexpr float enlarged_reach =
    1.6F;  // range in which new surfels take area from enlarged surfels
constexpr float territory_reach =
    2.0F;                            // range in which an old surfel makes a new one known territory
constexpr float face_depth = 0.55F;  // distance behind a surfel at which another face is searched
constexpr float face_reach = 2.2F;   // search radius of another face
constexpr float other_face = 0.3F;   // maximum cosine between different faces
constexpr int max_merges = 8;
constexpr float opposite_sides = -0.3F;  // maximum cosine between both sides of a thin object

constexpr int direction_count = 6;

/// Cosines and sines of multiples of a sixth of a turn.
struct DirectionAngles {
  std::array<float, direction_count> cosines, sines;
};

const DirectionAngles& direction_angles() {
  static const DirectionAngles angles = [] {
    DirectionAngles all{};
    for (std::size_t k = 0; k < direction_count; ++k) {
      const float angle = static_cast<float>(k) * std::numbers::pi_v<float> / 3.0F;
      all.cosines[k] = std::cos(angle);
      all.sines[k] = std::sin(angle);
    }
    return all;
  }();
  return angles;
}

std::array<Vector3f, direction_count> open_directions(const Surfels& surfels, std::size_t i) {
  const Vector3f& normal = surfels.normals[i];
  const Vector3f& first = surfels.first_tangents[i];
  // Orthogonalises the tangent again, because the normal may have changed.
  const Vector3f u = (first - normal * normal.dot(first)).normalized(), v = normal.cross(u);
  const auto& [cosines, sines] = direction_angles();
  std::array<Vector3f, direction_count> directions;
  for (std::size_t k = 0; k < direction_count; ++k) directions[k] = cosines[k] * u + sines[k] * v;
  return directions;
}

}  // namespace

float Surfels::covered_share(std::size_t i) const { return 1.0F - std::exp(-blurred_hazards[i]); }

float Surfels::deficit(std::size_t i) const { return areas[i] * std::exp(-blurred_hazards[i]); }

Vector3f open_direction(const Surfels& surfels, std::size_t i, int k) {
  return open_directions(surfels, i)[static_cast<std::size_t>(k)];
}

SurfelMap::SurfelMap(float spacing, unsigned threads)
    : spacing_(spacing), threads_(threads), grid_(neighbour_reach * spacing) {}

void SurfelMap::add(const BlockImage& image, const CoverageModel& coverage_model, float jump,
                    const std::optional<Eigen::AlignedBox3f>& region,
                    const IsMeasured& was_measured) {
  add_observations(image, coverage_model, jump);
  add_surfels(image, coverage_model, region, was_measured);
  // Rays come from all directions, so each axis gets a third of the variance along the ray.
  blur_hazards(std::hypot(coverage_model.noise().isotropic,
                          coverage_model.noise().along_ray / std::sqrt(3.0)));
}

void SurfelMap::blur_hazards(double sigma) {
  surfels_.blurred_hazards = surfels_.hazards;
  if (!(sigma > 0.0)) return;
  const float scale = static_cast<float>(-0.5 / (sigma * sigma));
  std::vector<float> weights(surfels_.size(), 1.0F);
  for (const Pair& pair : pairs_) {
    const float weight = std::exp(scale * pair.squared_distance);
    surfels_.blurred_hazards[pair.first] += weight * surfels_.hazards[pair.second];
    surfels_.blurred_hazards[pair.second] += weight * surfels_.hazards[pair.first];
    weights[pair.first] += weight;
    weights[pair.second] += weight;
  }
  for (std::size_t i = 0; i < surfels_.size(); ++i) surfels_.blurred_hazards[i] /= weights[i];
}

void SurfelMap::add_observations(const BlockImage& image, const CoverageModel& coverage_model,
                                 float jump) {
  const BlockProjection& projection = image.projection;
  const float across = std::max(off_plane_tolerance * spacing_,
                                2.0F * static_cast<float>(coverage_model.noise().across(1.0)));
  const auto add_observation = [&](std::size_t i) {
    const auto hit = projection.project(surfels_.positions[i]);
    if (!hit) return;
    const Block& block = image.blocks[hit->block];
    if (block.returns == 0 || std::abs(hit->depth - block.depth) > jump) return;
    const Vector3f offset = block.mean - surfels_.positions[i];
    const float off_plane = offset.dot(block.normal);
    if (std::abs(off_plane) > across) return;
    const float agreement = block.normal.dot(surfels_.normals[i]);
    const bool is_better = block.quality > 2.0F * surfels_.qualities[i];
    // Skips the other side of a thin object.
    if (agreement < opposite_sides && !is_better) return;
    const Vector3f towards_sensor =
        (projection.sensor_position - surfels_.positions[i]).normalized();
    const float cos_incidence = std::max(0.05F, towards_sensor.dot(block.normal));
    surfels_.hazards[i] += coverage_model.hazard(
        image.ray_density(block, surfels_.positions[i], cos_incidence), cos_incidence);
    if (is_better) {
      surfels_.positions[i] += off_plane * block.normal;
      surfels_.normals[i] = block.normal;
      surfels_.merges[i] = 1;
    } else if (surfels_.merges[i] < max_merges) {
      const float share = 1.0F / static_cast<float>(++surfels_.merges[i]);
      surfels_.positions[i] += share * off_plane * block.normal;
      if (agreement > 0.5F) {
        surfels_.normals[i] =
            (surfels_.normals[i] * (1.0F - share) + block.normal * share).normalized();
      }
    }
    surfels_.qualities[i] = std::max(surfels_.qualities[i], block.quality);
  };
  constexpr std::size_t some = 1024;  // surfels per part
  geometry::parallel_for((surfels_.size() + some - 1) / some, threads_, [&](std::size_t part) {
    const std::size_t end = std::min(surfels_.size(), (part + 1) * some);
    for (std::size_t i = part * some; i < end; ++i) add_observation(i);
  });
}

void SurfelMap::add_surfels(const BlockImage& image, const CoverageModel& coverage_model,
                            const std::optional<Eigen::AlignedBox3f>& region,
                            const IsMeasured& was_measured) {
  std::uint32_t full = 0;
  for (const Block& block : image.blocks) full = std::max(full, block.returns);
  for (const Block& block : image.blocks) {
    if (block.returns == 0 || 6 * block.returns < full) continue;
    if (region && !region->contains(block.mean)) continue;
    if (is_occupied(block)) continue;

    const Vector3f towards_sensor = (image.projection.sensor_position - block.mean).normalized();
    const float cos_incidence = std::max(0.05F, towards_sensor.dot(block.normal));
    const float density = image.ray_density(block, block.mean, cos_incidence);
    const float square = spacing_ * spacing_;
    const float footprint = static_cast<float>(block.returns) / density;
    surfels_.positions.push_back(block.mean);
    surfels_.normals.push_back(block.normal);
    const float area = std::clamp(footprint, packed_area * square, largest_area * square);
    surfels_.areas.push_back(was_measured && was_measured(block.mean) ? 0.0F : area);
    surfels_.hazards.push_back(coverage_model.hazard(density, cos_incidence));
    surfels_.trusts.push_back(1.0F);
    surfels_.qualities.push_back(block.quality);
    surfels_.merges.push_back(1);
    surfels_.open_directions.push_back(0b111111);
    surfels_.first_tangents.push_back(
        geometry::any_orthogonal(block.normal.cast<double>()).cast<float>());
    close_directions(surfels_.size() - 1);
    grid_.insert(block.mean);
  }
}

bool SurfelMap::is_occupied(const Block& block) {
  found_.clear();
  grid_.find_within(block.mean, min_distance * spacing_, found_);
  return std::any_of(found_.begin(), found_.end(), [&](const geometry::Neighbour& neighbour) {
    return surfels_.normals[neighbour.index].dot(block.normal) > opposite_sides;
  });
}

void SurfelMap::close_directions(std::size_t added) {
  const Vector3f position = surfels_.positions[added];
  const auto close = [&](std::size_t i, const Vector3f& towards) {
    const std::array<Vector3f, direction_count> directions = open_directions(surfels_, i);
    for (std::size_t k = 0; k < direction_count; ++k) {
      if (directions[k].dot(towards) > neighbour_cosine) {
        surfels_.open_directions[i] &= static_cast<std::uint8_t>(~(1U << k));
      }
    }
  };
  const float reach = neighbour_reach * spacing_;
  const float packed = packed_area * spacing_ * spacing_;
  found_.clear();
  grid_.find_within(position, reach, found_);
  for (const geometry::Neighbour& neighbour : found_) {
    const std::uint32_t i = neighbour.index;
    const Vector3f offset = surfels_.positions[i] - position;
    const float distance = offset.norm();
    if (distance <= 0.0F) continue;
    if (surfels_.open_directions[i] != 0) close(i, -offset / distance);
    if (surfels_.open_directions[added] != 0) close(added, offset / distance);
    if (distance < sharing_reach * spacing_) {
      pairs_.push_back({i, static_cast<std::uint32_t>(added), distance * distance});
    }
    if (distance < enlarged_reach * spacing_) {
      surfels_.areas[i] = std::min(surfels_.areas[i], std::max(packed, 0.75F * surfels_.areas[i]));
    }
  }
}

bool SurfelMap::has_surfel_near(const Vector3f& point, float radius) const {
  std::vector<geometry::Neighbour> found;
  grid_.find_within(point, radius, found);
  return !found.empty();
}

bool SurfelMap::has_other_face_near(std::size_t i) const {
  const Vector3f& normal = surfels_.normals[i];
  std::vector<geometry::Neighbour> found;
  grid_.find_within(surfels_.positions[i] - face_depth * spacing_ * normal, face_reach * spacing_,
                    found);
  return std::ranges::any_of(found, [&](const geometry::Neighbour& neighbour) {
    return surfels_.normals[neighbour.index].dot(normal) < other_face;
  });
}

double SurfelMap::area_near(const Vector3f& point, float radius, std::size_t first) const {
  std::vector<geometry::Neighbour> found;
  grid_.find_within(point, radius, found);
  double sum = 0.0;
  for (const geometry::Neighbour& neighbour : found) {
    if (neighbour.index >= first) sum += surfels_.areas[neighbour.index];
  }
  return sum;
}

double SurfelMap::new_territory(std::size_t first) const {
  double sum = 0.0;
  std::vector<geometry::Neighbour> found;
  for (std::size_t i = first; i < surfels_.size(); ++i) {
    if (surfels_.areas[i] == 0.0F) continue;
    found.clear();
    grid_.find_within(surfels_.positions[i], territory_reach * spacing_, found);
    const bool is_new = std::ranges::none_of(
        found, [&](const geometry::Neighbour& neighbour) { return neighbour.index < first; });
    if (is_new) sum += surfels_.areas[i] * surfels_.covered_share(i);
  }
  return sum;
}

double SurfelMap::area() const {
  double sum = 0.0;
  for (const float area : surfels_.areas) sum += area;
  return sum;
}

double SurfelMap::covered_area() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < surfels_.size(); ++i) {
    sum += surfels_.areas[i] * surfels_.covered_share(i);
  }
  return sum;
}

}  // namespace skycap::survey::surfel
