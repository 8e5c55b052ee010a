#include "flight/route/route_profile.h"

#include <algorithm>
#include <cmath>

#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Collects the pieces of all sorties.
class ProfileBuilder {
 public:
  ProfileBuilder(const Route& route, const FreeSpace& space, double step,
                 const std::stop_token& stop)
      : route_(route), space_(space), step_(step), stop_(stop) {}

  std::vector<ProfilePiece> build() {
    const Vector3d& pad = route_.options.takeoff;
    const Vector3d home = pad + Vector3d(0.0, 0.0, route_.options.takeoff_climb);
    for (; sortie_ < route_.sorties.size() && !stop_.stop_requested(); ++sortie_) {
      add_line(ProfilePart::climb, pad, home);
      const std::vector<Vector3d> points = sortie_points(route_, route_.sorties[sortie_]);
      for (std::size_t i = 1; i < points.size(); ++i) {
        add_line(ProfilePart::leg, points[i - 1], points[i]);
      }
      add_line(ProfilePart::landing, home, pad);
    }
    return std::move(pieces_);
  }

 private:
  void add_line(ProfilePart part, const Vector3d& from, const Vector3d& to) {
    const double length = (to - from).norm();
    const double count = std::max(1.0, std::ceil(length / step_));
    const double begin = distance_;
    for (double i = 0.0; i < count && !stop_.stop_requested(); ++i) {
      ProfilePiece piece;
      piece.sortie = static_cast<std::uint32_t>(sortie_);
      piece.part = part;
      piece.begin = begin + length * i / count;
      piece.end = begin + length * (i + 1.0) / count;
      piece.from = from + (to - from) * (i / count);
      piece.to = i + 1.0 < count ? Vector3d(from + (to - from) * ((i + 1.0) / count)) : to;
      if (part == ProfilePart::leg) {
        const LegVerification verification = verify(
            space_, {piece.from, piece.to}, route_.clearance, route_.clearance + reported_surplus);
        piece.clearance = verification.clearance;
        piece.closest = verification.closest;
        if (piece.closest.kind != ObstacleKind::none) piece.obstacle = space_.name(piece.closest);
      }
      pieces_.push_back(std::move(piece));
    }
    distance_ = begin + length;
  }

  const Route& route_;
  const FreeSpace& space_;
  double step_;
  const std::stop_token& stop_;
  std::size_t sortie_ = 0;
  double distance_ = 0.0;
  std::vector<ProfilePiece> pieces_;
};

}  // namespace

std::vector<ProfilePiece> route_profile(const Route& route, const FreeSpace& space, double step,
                                        const std::stop_token& stop) {
  if (!(step > 0.0) || !std::isfinite(step)) {
    throw Error(ErrorKind::bad_config,
                "the step of the profile is " + std::to_string(step) + "; it must be positive");
  }
  return ProfileBuilder(route, space, step, stop).build();
}

}  // namespace skycap::flight
