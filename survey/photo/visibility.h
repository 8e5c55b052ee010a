/// Visibility of samples in photos.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/pose/photo_camera.h"
#include "geometry/pose/pose.h"
#include "geometry/surfaces/sight_lines.h"
#include "survey/photo/stereo_quality.h"
#include "survey/photo/target_samples.h"

namespace skycap::survey::photo {

/// Lists of different lengths, stored consecutively.
struct IndexLists {
  std::vector<std::uint32_t> begin{0};  ///< Start of each list, and the end of the last one.
  std::vector<std::uint32_t> items;

  std::size_t size() const { return begin.size() - 1; }
  std::span<const std::uint32_t> operator[](std::size_t list) const {
    return std::span(items).subspan(begin[list], begin[list + 1] - begin[list]);
  }
  /// Appends the lists of `other`.
  void append(const IndexLists& other) {
    const auto size = static_cast<std::uint32_t>(items.size());
    for (std::size_t i = 0; i < other.size(); ++i) begin.push_back(size + other.begin[i + 1]);
    items.insert(items.end(), other.items.begin(), other.items.end());
  }
};

/// Returns the transposed lists: list i of the result contains the indices of the lists that
/// contain i, in ascending order. `count` is the number of lists in the result.
IndexLists transposed(const IndexLists& lists, std::size_t count);

/// Returns the observation of a sample from a photo at `position`, without testing whether the
/// photo observes it.
inline Observation make_observation(const Eigen::Vector3d& position, std::uint32_t photo,
                                    const TargetSamples& samples, std::size_t sample) {
  const Eigen::Vector3f line = position.cast<float>() - samples.points[sample];
  const float distance = line.norm();
  const Eigen::Vector3f ray = line / distance;
  return {ray, distance, samples.normals[sample].dot(ray), photo};
}

/// Tests whether photos observe samples. An observed sample projects into the image without a
/// border of 1.5% on each side. The angle of incidence is within its limit, and the distance is at
/// least the nearest focus and less than twice the view distance. The line of sight is clear over
/// 99.9% of its length. Keeps references to the constructor's arguments.
class Observer {
 public:
  Observer(const geometry::PhotoCamera& camera, const StereoRule& rule,
           const geometry::SightLines& obstructions, const TargetSamples& samples);

  /// Photo prepared for tests against many samples.
  struct Photo {
    explicit Photo(const geometry::View& view);
    geometry::View view;
    Eigen::Matrix3f camera_from_world;
  };
  /// Returns true if a photo observes a sample.
  bool observes(const Photo& photo, std::size_t sample) const;

  /// Returns all samples that the photo observes, in ascending order.
  std::vector<std::uint32_t> observed(const geometry::View& view) const;

  const TargetSamples& samples() const { return samples_; }
  const StereoRule& rule() const { return rule_; }
  const geometry::SightLines& obstructions() const { return obstructions_; }

 private:
  bool is_in_image(const Photo& photo, std::size_t sample) const;
  bool has_line_of_sight(const Photo& photo, std::size_t sample) const;

  const geometry::PhotoCamera& camera_;
  const StereoRule& rule_;
  const geometry::SightLines& obstructions_;
  const TargetSamples& samples_;
  float min_cosine_, half_width_, half_height_;
};

/// Returns the samples that each photo observes. The result does not depend on `threads`.
IndexLists observed_samples(const Observer& observer, std::span<const geometry::View> photos,
                            unsigned threads);

}  // namespace skycap::survey::photo
