#include "missions/prior/reference_system.h"

#include "missions/plugins/module.h"
#include "missions/prior/prior.h"

namespace skycap::missions::prior {
namespace {

constexpr const char* module = "libskycap_proj.so";

}  // namespace

GeodeticTransform geodetic_transform(const ReferenceRequest& request) {
  using Open = void(const ReferenceRequest&, GeodeticTransform&);
  GeodeticTransform transform;
  plugins::module_function<Open>(module, "skycap_geodetic_transform")(request, transform);
  return transform;
}

double egm96_undulation(double latitude_deg, double longitude_deg) {
  using Undulation = void(double, double, double&);
  double undulation = 0.0;
  plugins::module_function<Undulation>(module, "skycap_egm96_undulation")(
      latitude_deg, longitude_deg, undulation);
  return undulation;
}

}  // namespace skycap::missions::prior
