/// The kinds of buildings that city_block() draws from. Each fills a lot of `width` x `depth` round
/// the origin, its front to -y.
#pragma once

#include <cstdint>
#include <random>

#include "sim/models/masonry/solids.h"

namespace skycap::sim::models::city {

/// Random numbers that are the same with every standard library.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1.0p-53;
  }
  int integer(int low, int high) {  // both included
    return low + static_cast<int>(random_() % static_cast<std::uint64_t>(high - low + 1));
  }

 private:
  std::mt19937_64 random_;
};

struct Lot {
  double width, depth;
};

/// A house under a hipped or gabled roof with chimneys and dormers.
Parts town_house(const Lot& lot, Draw& draw, const Fineness& fineness);
/// A flat-roofed block behind a parapet, stepped back towards the top, with plant on the roof.
Parts office(const Lot& lot, Draw& draw, const Fineness& fineness);
/// Four wings round a court.
Parts courtyard_house(const Lot& lot, Draw& draw, const Fineness& fineness);
/// A house whose front stands on arches over the pavement.
Parts arcade_house(const Lot& lot, Draw& draw, const Fineness& fineness);
/// A hall with a tall tower under a spire.
Parts tower_hall(const Lot& lot, Draw& draw, const Fineness& fineness);

/// A tree of that height: a trunk and a lumpy crown.
Parts tree(double height, Draw& draw, const Fineness& fineness);

}  // namespace skycap::sim::models::city
