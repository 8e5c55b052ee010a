#include "missions/online/live/live_status.h"

#include <chrono>
#include <condition_variable>
#include <fstream>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "missions/online/live/answer.h"
#include "missions/support/json_text.h"

namespace skycap::missions::online {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Replaces the file without waiting for the disk. After a power failure, no survey is running.
void replace_status(const fs::path& file, const std::string& text) {
  const fs::path written = fs::path(file).concat(".new");
  std::ofstream stream(written, std::ios::binary | std::ios::trunc);
  stream << text << "\n";
  stream.close();
  std::error_code ignored;
  if (stream) fs::rename(written, file, ignored);
}

}  // namespace

LiveStatus::LiveStatus(fs::path folder, const flight::FlightOptions& flight)
    : folder_(std::move(folder)), flight_(flight) {
  std::error_code ignored;
  is_held_ = fs::exists(folder_ / hold_name, ignored);
  thread_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
}

LiveStatus::~LiveStatus() {
  thread_.request_stop();
  thread_.join();
  std::error_code ignored;
  fs::remove(folder_ / status_name, ignored);
}

void LiveStatus::set_survey(const LiveSurvey& survey) {
  std::string text = answer_json(survey, flight_);
  const std::scoped_lock lock(mutex_);
  survey_ = std::move(text);
}

void LiveStatus::set_vehicle(const geometry::View& view, std::optional<double> battery) {
  const std::scoped_lock lock(mutex_);
  vehicle_ = view;
  battery_ = battery;
}

void LiveStatus::set_action(const std::string& text) {
  const std::scoped_lock lock(mutex_);
  action_ = text;
}

void LiveStatus::watch(const std::stop_token& stop) {
  constexpr std::chrono::milliseconds period(100);
  constexpr int periods_per_status = 10;
  std::condition_variable_any pause;
  std::mutex pausing;
  for (int i = 0; !stop.stop_requested(); ++i) {
    std::error_code failure;
    const bool exists = fs::exists(folder_ / hold_name, failure);
    const bool has_changed = !failure && is_held_.exchange(exists) != exists;
    if (has_changed || i % periods_per_status == 0) {
      replace_status(folder_ / status_name, status_text());
    }
    std::unique_lock lock(pausing);
    pause.wait_for(lock, stop, period, [] { return false; });
  }
}

std::string LiveStatus::status_text() const {
  const std::scoped_lock lock(mutex_);
  Json json{{"held", is_held_.load()}, {"action", action_}};
  json["vehicle"] = Json();
  if (vehicle_) {
    json["vehicle"] = {{"position", support::to_json(vehicle_->position)},
                       {"direction", support::to_json(vehicle_->direction)}};
  }
  json["battery"] = battery_ ? Json(*battery_) : Json();
  json["required_clearance_m"] = flight_.has_vehicle() ? Json(flight_.clearance) : Json();
  json["survey"] = survey_.empty() ? Json() : Json::parse(survey_);
  // Texts contain the names of files, which may have any bytes.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace skycap::missions::online
