// Keys of the section `photo`: photos for photogrammetry.
#include "missions/config/key_builders.h"
#include "missions/config/key_sections.h"

namespace skycap::missions::config {
namespace {

/// Returns access to the field of the section that `member` points to.
auto photo(auto member) {
  return [member](auto& m) -> auto& { return m.photo.*member; };
}
auto rule(auto member) {
  return [member](auto& m) -> auto& { return m.photo.rule.*member; };
}

/// Returns the key `photo.patterns`. An empty list means no patterns.
Key patterns_key() {
  return otherwise(
      "facade, dome, oblique",
      key_for("photo.patterns", KeyType::texts, photo(&PhotoSection::patterns),
              "Flight patterns that are compared with the plan and provide candidate "
              "photos for it: nadir, oblique, dome, facade, rings, corridor. []: none."));
}

/// Returns the key `photo.pattern`, which replaces the selection of photos.
Key pattern_key() {
  Key key = text_key("photo.pattern", photo(&PhotoSection::pattern),
                     "Flight pattern that replaces the choice of photos: nadir, oblique, dome, "
                     "facade, rings or corridor.");
  return otherwise("none", key);
}

}  // namespace

std::vector<Key> photo_keys() {
  return {
      otherwise("required with sensor.photo_camera",
                number_key("photo.gsd", "m", above(0, 10), photo(&PhotoSection::gsd),
                           "Ground sampling distance on a surface that faces the camera. Defines "
                           "the view distance: gsd times focal length over pixel pitch.")),
      otherwise(
          "3; 4 with photo.pass: coarse",
          integer_key(
              "photo.min_partners", "", between(2, 6), photo(&PhotoSection::min_partners),
              "K: number of stereo partners that at least one photo of each surface point must "
              "have. K + 1 suitable photos of a point meet this requirement. Use 4 for plain "
              "walls.")),
      angle_key("photo.max_incidence_deg", between(45, 85),
                rule(&survey::photo::StereoRule::max_incidence),
                "Maximum angle of incidence of a photo's ray at the surface."),
      angle_key("photo.min_parallax_deg", between(1, 60),
                rule(&survey::photo::StereoRule::min_parallax),
                "Minimum parallax of stereo partners, at the surface."),
      angle_key("photo.max_parallax_deg", between(1, 60),
                rule(&survey::photo::StereoRule::max_parallax),
                "Maximum parallax of stereo partners, at the surface."),
      choice_key("photo.poses", {"known", "unknown"}, photo(&PhotoSection::poses),
                 "Poses of the photos in the photogrammetry program. known: the program imports "
                 "the RTK or PPK poses. unknown: the program estimates the poses; photos are added "
                 "until all photos can be registered to one another."),
      patterns_key(),
      pattern_key(),
      number_key("photo.forward_overlap", "fraction", between(0, 0.95),
                 photo(&PhotoSection::forward_overlap),
                 "Forward overlap of the patterns' photos, as a fraction."),
      number_key("photo.side_overlap", "fraction", between(0, 0.95),
                 photo(&PhotoSection::side_overlap),
                 "Side overlap of the patterns' rows, as a fraction."),
      number_key("photo.target_share", "fraction", above(0, 1), photo(&PhotoSection::target_share),
                 "Fraction of the attainable surface at which the choice of photos stops."),
      integer_key("photo.max_photos", "", between(1, 100'000), photo(&PhotoSection::max_photos),
                  "Maximum number of photos."),
      choice_key("photo.pass", {"coarse", "final"}, photo(&PhotoSection::pass),
                 "First or second of two flights, for targets of which only an outline is known. "
                 "coarse: three times "
                 "photo.gsd, "
                 "for a first model of the target. final: photo.gsd."),
  };
}

}  // namespace skycap::missions::config
