#include "sim/models/families/families.h"

#include <array>

namespace skycap::sim::models {
namespace {

constexpr std::array<Family, 12> all{{{"bridge", bridge},
                                      {"church", church},
                                      {"factory", factory},
                                      {"fences", fences},
                                      {"garage", garage},
                                      {"glass-house", glass_house},
                                      {"grove", grove},
                                      {"hillside", hillside},
                                      {"hollow-house", hollow_house},
                                      {"lattice-tower", lattice_tower},
                                      {"old-town", old_town},
                                      {"statue", statue}}};

}  // namespace

std::span<const Family> families() { return all; }

}  // namespace skycap::sim::models
