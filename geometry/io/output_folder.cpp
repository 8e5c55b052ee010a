#include "geometry/io/output_folder.h"

#include <algorithm>
#include <fstream>

#include <unistd.h>

#include "geometry/error.h"

namespace skycap::geometry {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw Error(ErrorKind::bad_file, path.string() + ": " + what);
}

}  // namespace

OutputFolder::OutputFolder(fs::path folder) : folder_(std::move(folder)) {
  std::error_code failure;
  if (fs::exists(folder_, failure) && !fs::is_directory(folder_, failure)) {
    fail(folder_, "is a file; name a folder for the results");
  }
  is_new_ = fs::create_directories(folder_, failure);
  if (failure) {
    fail(folder_, "cannot be made (" + failure.message() + "); name a folder you may write to");
  }
  // Better to find out now than after the survey.
  const fs::path probe = temporary("probe");
  const bool is_writable = std::ofstream(probe).put('\n').flush().good();
  fs::remove(probe, failure);
  if (!is_writable) fail(folder_, "cannot be written to; name a folder you may write to");
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  for (const std::string& name : staged_) fs::remove(temporary(name), ignored);
  if (is_new_) fs::remove(folder_, ignored);  // does nothing if there are files in it
}

fs::path OutputFolder::temporary(const std::string& name) const {
  return folder_ / (".part-" + std::to_string(::getpid()) + "-" + name);
}

fs::path OutputFolder::stage(const std::string& name) {
  staged_.push_back(name);
  return temporary(name);
}

void OutputFolder::drop(const std::string& name) {
  std::error_code ignored;
  fs::remove(temporary(name), ignored);
  std::erase(staged_, name);
}

void OutputFolder::write(const std::string& name, std::string_view content) {
  const fs::path part = stage(name);
  std::ofstream stream(part, std::ios::binary);
  stream.write(content.data(), static_cast<std::streamsize>(content.size()));
  stream.close();
  if (!stream) fail(folder_ / name, "cannot be written whole; is the disk full?");
}

void OutputFolder::replace(const std::function<bool(std::string_view)>& is_old) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, ignored)) {
    const std::string name = entry.path().filename().string();
    if (is_old(name)) old_.push_back(name);
  }
}

void OutputFolder::commit() {
  for (const std::string& name : old_) {
    std::error_code ignored;
    if (std::ranges::find(staged_, name) == staged_.end()) fs::remove(folder_ / name, ignored);
  }
  old_.clear();
  for (const std::string& name : staged_) {
    std::error_code failure;
    fs::rename(temporary(name), folder_ / name, failure);
    if (failure) fail(folder_ / name, "cannot be put in place (" + failure.message() + ")");
  }
  staged_.clear();
  is_new_ = false;
}

}  // namespace skycap::geometry
