/// Building types of city_block(). Each fills a lot of `width` x `depth` around the origin, with
/// its front towards -y.
#pragma once

#include "geometry/random_numbers.h"
#include "sim/models/masonry/solids.h"

namespace skycap::sim::models::city {

struct Lot {
  double width, depth;
};

/// Returns a house below a hipped or gabled roof with chimneys and dormers.
Parts town_house(const Lot& lot, geometry::RandomNumbers& draw, const Fineness& fineness);
/// Returns a flat-roofed block behind a parapet, stepped back towards the top, with equipment on
/// the roof.
Parts office(const Lot& lot, geometry::RandomNumbers& draw, const Fineness& fineness);
/// Returns four wings around a court.
Parts courtyard_house(const Lot& lot, geometry::RandomNumbers& draw, const Fineness& fineness);
/// Returns a house whose front stands on arches above the pavement.
Parts arcade_house(const Lot& lot, geometry::RandomNumbers& draw, const Fineness& fineness);
/// Returns a hall with a tall tower below a spire.
Parts tower_hall(const Lot& lot, geometry::RandomNumbers& draw, const Fineness& fineness);

}  // namespace skycap::sim::models::city
