/// The kinds of buildings that city_block() draws from. Each fills a lot of `width` x `depth` round
/// the origin, its front to -y.
#pragma once

#include "geometry/random_numbers.h"
#include "sim/models/masonry/solids.h"

namespace skycap::sim::models::city {

struct Lot {
  double width, depth;
};

/// A house under a hipped or gabled roof with chimneys and dormers.
Parts town_house(const Lot& lot, geometry::RandomNumbers& draw, const Fineness& fineness);
/// A flat-roofed block behind a parapet, stepped back towards the top, with plant on the roof.
Parts office(const Lot& lot, geometry::RandomNumbers& draw, const Fineness& fineness);
/// Four wings round a court.
Parts courtyard_house(const Lot& lot, geometry::RandomNumbers& draw, const Fineness& fineness);
/// A house whose front stands on arches over the pavement.
Parts arcade_house(const Lot& lot, geometry::RandomNumbers& draw, const Fineness& fineness);
/// A hall with a tall tower under a spire.
Parts tower_hall(const Lot& lot, geometry::RandomNumbers& draw, const Fineness& fineness);

}  // namespace skycap::sim::models::city
