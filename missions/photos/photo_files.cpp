#include "missions/photos/photo_files.h"

namespace skycap::missions::photos {
void stage_photo_tables(const survey::photo::PhotoPlan& plan,
                        const std::optional<flight::Site>& site, const PoseSigmas& sigmas,
                        geometry::OutputFolder& folder) {
  folder.write(photo_table_name, photo_table(plan, site, sigmas));
  if (site) folder.write(odm_file_name, odm_geolocations(plan, *site, sigmas));
}

}  // namespace skycap::missions::photos
