/// Simulates Ctrl-C at a defined moment of a command.
#pragma once

#include <sstream>
#include <stop_token>
#include <string>
#include <utility>

namespace skycap::tests {

/// Terminal that sends Ctrl-C when the progress line contains a text.
class CtrlC : public std::stringbuf {
 public:
  explicit CtrlC(std::string at) : at_(std::move(at)) {}
  std::stop_token token() const { return stop_.get_token(); }

 protected:
  int sync() override {
    if (str().find(at_) != std::string::npos) stop_.request_stop();
    return 0;
  }

 private:
  std::string at_;
  std::stop_source stop_;
};

}  // namespace skycap::tests
