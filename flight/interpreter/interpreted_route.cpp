#include "flight/interpreter/interpreted_route.h"

#include <algorithm>
#include <cmath>

namespace skycap::flight {
namespace {

/// Minimum length to subdivide [m]. A leg that is verified in the plan has half of this as margin
/// in its file, where the required clearance is lower (rounding_bound).
constexpr double finest_fan = 0.01;

/// Verifies the legs from every point of `start` to `to`. The distance to obstacles is 1-Lipschitz,
/// and legs from points e apart are at most e apart everywhere. A leg verified at the clearance
/// plus e therefore verifies all legs within e.
LegVerification verify_fan(const FreeSpace& space, const Segment& start, const Eigen::Vector3d& to,
                           double clearance, double up_to) {
  const double reach = 0.5 * start.length();
  LegVerification verification = verify(space, {start.at(0.5), to}, clearance, up_to + reach);
  verification.clearance -= reach;
  if (!verification.is_verified || verification.clearance >= clearance) return verification;
  if (start.length() < finest_fan) {
    verification.is_verified = false;
    return verification;
  }
  const LegVerification first =
      verify_fan(space, {start.from, start.at(0.5)}, to, clearance, up_to);
  if (!first.is_verified) return first;
  const LegVerification second = verify_fan(space, {start.at(0.5), start.to}, to, clearance, up_to);
  return second.is_verified && first.clearance < second.clearance ? first : second;
}

std::string distance_text(const LegVerification& verification, const FreeSpace& space) {
  const Eigen::Vector3d& position = verification.closest.on_leg;
  return fixed(verification.closest.distance, 2) + " m from " + space.name(verification.closest) +
         " at (" + fixed(position.x(), 2) + ", " + fixed(position.y(), 2) + ", " +
         fixed(position.z(), 2) + ")";
}

std::string describe(const InterpretedSegment& segment, const LegVerification& verification,
                     const FreeSpace& space) {
  return "leg from " + segment.from_item + " to " + segment.to_item + ": " +
         distance_text(verification, space);
}

/// Verifies the paths on which an interrupted vehicle brakes from the corner between two pieces.
LegVerification verify_braking(const FreeSpace& space, const InterpretedSegment& piece,
                               const InterpretedSegment& next, double clearance, double up_to) {
  const Eigen::Vector3d& corner = piece.to;
  const Eigen::Vector3d in = (piece.to - piece.start.to).stableNormalized();
  const Eigen::Vector3d out = (next.to - piece.to).stableNormalized();
  const Segment tips{corner + piece.braking * in, corner + piece.braking * out};
  LegVerification straight = verify(space, {corner, tips.from}, clearance + piece.margin, up_to);
  if (!straight.is_verified) return straight;
  // Paths of equal length end on an arc, whose height above its chord is the distance of the
  // chord from the circle.
  const double chord = 0.5 * tips.length();
  const double arc =
      piece.braking - std::sqrt(std::max(0.0, piece.braking * piece.braking - chord * chord));
  const double beside = arc + std::max(piece.margin, next.margin);
  LegVerification verification =
      verify_fan(space, tips, corner, clearance + beside, up_to + beside);
  verification.clearance -= beside;
  return verification;
}

}  // namespace

RouteVerification verify(const InterpretedRoute& route, const FreeSpace& space,
                         const FreeSpace& pad_space, double clearance, double up_to) {
  RouteVerification result{{}, up_to};
  for (const InterpretedSegment& segment : route.segments) {
    const FreeSpace& where = segment.is_over_pad ? pad_space : space;
    const double required = clearance + segment.margin, most = up_to + segment.margin;
    LegVerification verification =
        segment.start.length() > 0.0
            ? verify_fan(where, segment.start, segment.to, required, most)
            : verify(where, {segment.start.to, segment.to}, required, most);
    verification.clearance -= segment.margin;
    if (!verification.is_verified)
      result.problems.push_back(describe(segment, verification, where));
    const double known =
        verification.is_verified ? verification.clearance : verification.closest.distance;
    result.clearance = std::min(result.clearance, known);
  }
  for (std::size_t i = 0; i + 1 < route.segments.size(); ++i) {
    const InterpretedSegment& segment = route.segments[i];
    if (segment.braking <= 0.0) continue;
    const LegVerification verification =
        verify_braking(space, segment, route.segments[i + 1], clearance, up_to);
    if (verification.is_verified) continue;
    result.problems.push_back(
        "braking beyond " + segment.to_item +
        " if the flight is interrupted: " + distance_text(verification, space));
  }
  return result;
}

Departure departure_after(const InterpretedSegment& leg, double distance) {
  const Eigen::Vector3d along = leg.to - leg.start.to;
  const double length = along.norm();
  if (length == 0.0) return {{leg.to, leg.to}};
  const double share = std::min(1.0, distance / length);
  const double beside = leg.margin + (leg.start.from - leg.start.to).cross(along).norm() / length;
  return {{leg.to - share * along, leg.to}, share * beside};
}

void append_passes(InterpretedRoute& route, double spacing, double yaw_deg, double pitch_deg) {
  const InterpretedSegment& leg = route.segments.back();
  const Eigen::Vector3d distance = leg.to - leg.start.to;
  const double length = distance.norm();
  for (int i = 1; i * spacing < length - 0.5 * spacing; ++i) {
    route.is_fly_through.push_back({leg.start.to + i * spacing / length * distance, leg.to_item,
                                    yaw_deg, pitch_deg, leg.speed, spacing, route.stops.size()});
  }
}

double length(const InterpretedRoute& route) {
  double sum = 0.0;
  for (const InterpretedSegment& segment : route.segments) {
    if (!segment.is_over_pad) sum += (segment.to - segment.start.to).norm();
  }
  return sum;
}

}  // namespace skycap::flight
