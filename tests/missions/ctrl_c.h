/// Ctrl-C at a certain moment of a verb.
#pragma once

#include <sstream>
#include <stop_token>
#include <string>
#include <utility>

namespace skycap::tests {

/// A terminal at which somebody types Ctrl-C when the progress line shows a text.
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
