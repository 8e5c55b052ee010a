/// String representations of a document's keys, used to identify surveys and cached results.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "missions/config/key.h"
#include "missions/config/mission_document.h"
#include "missions/support/identity.h"

namespace skycap::missions::config {

/// Returns all keys in table order, except name, seed, threads and the published reference results.
/// The prior data's checksums follow. `vehicle_checksum` is the CRC-32 of the vehicle description
/// if that is a file; it replaces the path.
std::vector<support::Setting> survey_settings(const MissionDocument& document,
                                              const std::optional<std::uint32_t>& vehicle_checksum);

/// Returns the keys and prior-data checksums that determine visible surface and attainable
/// coverage. Each entry begins with a line feed.
std::string attainable_inputs(const MissionDocument& document);

/// Whether a key can mean anything in a document: those of photos need a photo camera, which
/// excludes those of depth sensors that resolve() refuses beside it.
bool applies(const Key& key, const MissionDocument& document);

}  // namespace skycap::missions::config
