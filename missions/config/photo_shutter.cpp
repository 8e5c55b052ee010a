#include "missions/config/photo_shutter.h"

#include <array>

namespace skycap::missions::config {
namespace {

struct Payload {
  std::string_view prefix;  ///< Prefix of the preset's name.
  int code;
};

constexpr std::array payloads{
    Payload{"zenmuse_h20", 42}, Payload{"zenmuse_h20t", 43}, Payload{"zenmuse_h20n", 61},
    Payload{"zenmuse_h30", 82}, Payload{"zenmuse_h30t", 83}, Payload{"zenmuse_p1", 50},
    Payload{"m30", 52},         Payload{"m30t", 53},         Payload{"mavic_3e", 66},
    Payload{"mavic_3t", 67},    Payload{"mavic_3m", 68},     Payload{"matrice_3d", 80},
    Payload{"matrice_3td", 81}, Payload{"matrice_4e", 88},   Payload{"matrice_4t", 89},
    Payload{"matrice_4d", 98},  Payload{"matrice_4td", 99}};

}  // namespace

std::optional<int> wpml_payload(std::string_view camera) {
  if (camera.starts_with("dji_")) camera.remove_prefix(4);
  // Whole words are compared: "m30" does not match "m30t_wide".
  for (const Payload& payload : payloads) {
    if (!camera.starts_with(payload.prefix)) continue;
    const std::string_view rest = camera.substr(payload.prefix.size());
    if (rest.empty() || rest.front() == '_') return payload.code;
  }
  return std::nullopt;
}

flight::PhotoShutter make_photo_shutter(const geometry::PhotoCameraConfig& camera, double gsd) {
  flight::PhotoShutter shutter{.gsd = gsd,
                               .exposure = camera.exposure,
                               .readout = camera.readout,
                               .min_interval = camera.min_interval};
  // The plan uses the first image type.
  if (!camera.formats.empty()) shutter.image_format = camera.formats.front();
  shutter.payload = wpml_payload(camera.name).value_or(0);
  return shutter;
}

}  // namespace skycap::missions::config
