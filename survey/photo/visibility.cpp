#include "survey/photo/visibility.h"

#include <cmath>

#include "geometry/parallel.h"

namespace skycap::survey::photo {

using Eigen::Matrix3f;
using Eigen::Vector3d;
using Eigen::Vector3f;

IndexLists transposed(const IndexLists& lists, std::size_t count) {
  IndexLists result;
  result.begin.assign(count + 1, 0);
  for (const std::uint32_t item : lists.items) ++result.begin[item + 1];
  for (std::size_t i = 0; i < count; ++i) result.begin[i + 1] += result.begin[i];
  result.items.resize(lists.items.size());
  std::vector<std::uint32_t> next(result.begin.begin(), result.begin.end() - 1);
  for (std::uint32_t list = 0; list < lists.size(); ++list) {
    for (const std::uint32_t item : lists[list]) result.items[next[item]++] = list;
  }
  return result;
}

Observer::Observer(const geometry::PhotoCamera& camera, const StereoRule& rule,
                   const geometry::SightLines& obstructions, const TargetSamples& samples)
    : camera_(camera),
      rule_(rule),
      obstructions_(obstructions),
      samples_(samples),
      min_cosine_(static_cast<float>(std::cos(rule.max_incidence))) {
  constexpr double border = 0.015;
  const double slope = (0.5 - border) / camera.focal_length_px();
  half_width_ = static_cast<float>(slope * camera_.width());
  half_height_ = static_cast<float>(slope * camera_.height());
}

Observer::Photo::Photo(const geometry::View& given)
    : view(given),
      camera_from_world(geometry::camera_pose(given).linear().transpose().cast<float>()) {}

bool Observer::is_in_image(const Photo& photo, std::size_t sample) const {
  const Vector3f line = samples_.points[sample] - photo.view.position.cast<float>();
  const Vector3f in_camera = photo.camera_from_world * line;
  return in_camera.z() > 0.0F && std::abs(in_camera.x()) <= half_width_ * in_camera.z() &&
         std::abs(in_camera.y()) <= half_height_ * in_camera.z();
}

bool Observer::has_line_of_sight(const Photo& photo, std::size_t sample) const {
  const Observation seen = make_observation(photo.view.position, 0, samples_, sample);
  // At a distance of 0, the cosine is not a number.
  if (!(seen.cosine >= min_cosine_) || seen.distance < static_cast<float>(rule_.nearest_focus) ||
      seen.distance >= static_cast<float>(rule_.max_distance())) {
    return false;
  }
  constexpr double fraction = 0.999;
  return obstructions_.is_clear(photo.view.position, samples_.points[sample].cast<double>(),
                                fraction);
}

bool Observer::observes(const Photo& photo, std::size_t sample) const {
  return is_in_image(photo, sample) && has_line_of_sight(photo, sample);
}

std::vector<std::uint32_t> Observer::observed(const geometry::View& view) const {
  const Photo photo(view);
  std::vector<std::uint32_t> result;
  for (std::uint32_t sample = 0; sample < samples_.size(); ++sample) {
    if (observes(photo, sample)) result.push_back(sample);
  }
  return result;
}

IndexLists observed_samples(const Observer& observer, std::span<const geometry::View> photos,
                            unsigned threads) {
  std::vector<std::vector<std::uint32_t>> each(photos.size());
  geometry::parallel_for(photos.size(), threads,
                         [&](std::size_t i) { each[i] = observer.observed(photos[i]); });
  IndexLists lists;
  for (const std::vector<std::uint32_t>& observed : each) {
    lists.items.insert(lists.items.end(), observed.begin(), observed.end());
    lists.begin.push_back(static_cast<std::uint32_t>(lists.items.size()));
  }
  return lists;
}

}  // namespace skycap::survey::photo
