/// How much surface a view would newly cover, by what is known and guessed so far.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/place/camera.h"
#include "geometry/place/pose.h"
#include "survey/skycap/dose_map.h"
#include "survey/skycap/dose_model.h"
#include "survey/skycap/raster/sight_kernels.h"
#include "survey/skycap/survey_belief.h"
#include "survey/skycap/unseen_surface.h"

namespace skycap::survey::skycap {

/// A target in sight of a view.
struct Sight {
  std::uint32_t target;
  float covered_share;     ///< of what is still uncovered of it, expected
  float clearness = 1.0F;  ///< the probability that it is in sight, counted above
};

/// A target in sight of a view, and the hazard of the look (dose_model.h).
struct Look {
  std::uint32_t target;
  float hazard;
};

struct Gain {
  double area = 0.0;    ///< expected newly covered area [m^2]
  double unseen = 0.0;  ///< the part of it that is only guessed to be there
  Eigen::Vector3f centroid = Eigen::Vector3f::Zero();  ///< of it
};

struct GainSettings {
  double view_distance = 2.0;     ///< d: sets the resolution at which visibility is decided
  float max_incidence = 1.3614F;  ///< beyond it no return is counted on [rad]; 78 degrees: there a
                                  ///< head-on look's rays per area are down to a fifth
};

/// A snapshot of all surfaces, seen and guessed, that answers for any view. Immutable; safe to ask
/// from any number of threads.
///
/// Targets are the surfels with a deficit worth a look and the unseen patches. Occlusion is decided
/// in a depth image of all surfels, splatted as squares of 2 h. Unseen patches hide nothing; but
/// those of prior_kind are hidden by `prior_occluders`, too. `clearness`, if given, says with what
/// probability unknown space hides them; it must outlive the field.
class GainField {
 public:
  GainField(const DoseMap& map, std::span<const UnseenPatch> patches,
            const geometry::Camera& camera, const DoseModel& dose, const GainSettings& settings,
            std::span<const Eigen::Vector3f> prior_occluders = {},
            const Clearness* clearness = nullptr);

  /// The known surface as if nothing had been measured of it yet: for views that are to cover it
  /// from an empty cloud. One target stands for each so many surfels in turn that there are
  /// `most_targets` at most, and weighs their area times the trust in them.
  static GainField of_known_surface(const DoseMap& map, const geometry::Camera& camera,
                                    const DoseModel& dose, const GainSettings& settings,
                                    std::size_t most_targets);

  struct Target {
    Eigen::Vector3f position;
    Eigen::Vector3f normal;
    float weight;  ///< uncovered area, expected
  };
  std::span<const Target> targets() const { return targets_; }
  /// The surfel that target `i` is, or the unseen patch: see is_patch().
  std::uint32_t source(std::size_t target) const { return sources_[target]; }
  bool is_patch(std::size_t target) const { return target >= surfel_targets_; }

  Gain gain(const geometry::View& view) const;
  /// The targets in sight of the view, ascending.
  std::vector<Sight> sights(const geometry::View& view) const;
  /// The same, with what the looks add to the dose.
  std::vector<Look> looks(const geometry::View& view) const;

 private:
  /// Without targets.
  GainField(const DoseMap& map, const geometry::Camera& camera, const DoseModel& dose,
            const GainSettings& settings);
  void index_targets();
  RasterView raster_view(const geometry::View& view) const;
  template <typename Visit>
  void for_each_sight(const geometry::View& view, Visit visit) const;
  bool is_prior(std::size_t target) const { return target >= first_prior_ && target < end_prior_; }

  DoseModel dose_;
  float spacing_;
  float least_cosine_;
  Eigen::Vector2f focal_length_px_;  ///< of the sensor
  float least_range_, most_range_;
  Eigen::Vector2f half_slope_;  ///< tangents of half the angles of view
  float raster_focal_length_px_;
  int raster_width_, raster_height_;
  std::array<std::vector<float>, 3> occluders_;  ///< all surfels: their x, y and z
  std::array<std::vector<float>, 3> prior_occluders_;
  std::size_t surfel_targets_ = 0;
  std::size_t first_prior_ = 0, end_prior_ = 0;  ///< the targets that those are
  std::vector<Target> targets_;
  std::array<std::vector<float>, 3> positions_, normals_;  ///< of the targets
  std::vector<std::uint32_t> sources_;
  const Clearness* clearness_ = nullptr;
};

/// What was promised of the surface that a field tells of, and what was known of it then.
struct Promise {
  std::vector<Sight> sights;
  std::vector<float> hazards;        ///< of the surfels
  double seen = 0.0, guessed = 0.0;  ///< to be covered, of known surface and of guesses [m^2]

  std::size_t surfels() const { return hazards.size(); }
};
Promise promise_of(const GainField& field, const DoseMap& map, std::vector<Sight> sights);

/// Compares it with what became of it: surfels that keep withholding what they promise are trusted
/// less, guesses are graded.
void grade(const Promise& promise, const GainField& field, DoseMap& map, UnseenSurface& unseen,
           const SpaceMemory& space);

/// All surface, seen and guessed, as far as it can be covered: the surfels of `map`, and of the
/// unseen `patches` those in sight, their areas as expected, times `guess_yield`. `chances` says of
/// each target with what probability some good view sees it, if it is there.
std::vector<BelievedPatch> believed_patches(const DoseMap& map, const GainField& field,
                                            std::span<const UnseenPatch> patches,
                                            std::span<const float> chances, float guess_yield);

}  // namespace skycap::survey::skycap
