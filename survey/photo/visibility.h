/// Which photos observe which samples.
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

/// Lists of unequal lengths, one behind the other.
struct IndexLists {
  std::vector<std::uint32_t> begin{0};  ///< of each list, and the end of the last
  std::vector<std::uint32_t> items;

  std::size_t size() const { return begin.size() - 1; }
  std::span<const std::uint32_t> operator[](std::size_t list) const {
    return std::span(items).subspan(begin[list], begin[list + 1] - begin[list]);
  }
};

/// The lists of what is in them: list i of the result names the lists that hold i, in their order.
IndexLists transposed(const IndexLists& lists, std::size_t count);

/// A sample as a photo at `position` sees it, whether or not it observes it.
Observation make_observation(const Eigen::Vector3d& position, std::uint32_t photo,
                             const TargetSamples& samples, std::size_t sample);

/// Decides observations. A photo observes a sample that projects into the image less a border of
/// 1.5% on each side. The angle of incidence must be within its limit, and the distance at least
/// the nearest focus and less than twice the view distance. The line of sight must be clear
/// for 99.9% of its length. Keeps references.
class Observer {
 public:
  Observer(const geometry::PhotoCamera& camera, const StereoRule& rule,
           const geometry::SightLines& obstructions, const TargetSamples& samples);

  /// A photo that many samples are tested against.
  struct Photo {
    explicit Photo(const geometry::View& view);
    geometry::View view;
    Eigen::Matrix3f camera_from_world;
  };
  /// Whether a photo observes a sample.
  bool observes(const Photo& photo, std::size_t sample) const;

  /// All samples that the photo observes, ascending.
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

/// The samples that each photo observes. The result does not depend on `threads`.
IndexLists observed_samples(const Observer& observer, std::span<const geometry::View> photos,
                            unsigned threads);

}  // namespace skycap::survey::photo
