#include "missions/site_data/reference_system.h"

#include "missions/site_data/prior.h"
#include "missions/support/module.h"

namespace skycap::missions::site_data {
namespace {

constexpr const char* module = "libskycap_proj.so";

}  // namespace

GeodeticTransform geodetic_transform(const ReferenceRequest& request) {
  using Open = void(const ReferenceRequest&, GeodeticTransform&);
  GeodeticTransform transform;
  support::module_function<Open>(module, "skycap_geodetic_transform")(request, transform);
  return transform;
}

double egm96_undulation(double latitude_deg, double longitude_deg) {
  using Undulation = void(double, double, double&);
  double undulation = 0.0;
  support::module_function<Undulation>(module, "skycap_egm96_undulation")(
      latitude_deg, longitude_deg, undulation);
  return undulation;
}

}  // namespace skycap::missions::site_data
