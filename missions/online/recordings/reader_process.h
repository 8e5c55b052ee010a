/// A reader of rawlogs in a process of its own. MRPT believes the counts that a file states: a
/// hostile one makes it run out of memory or of its arrays. There that ends the reader, in a
/// message, and not the program that keeps a survey.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "missions/online/recordings/rawlog_reader.h"

namespace skycap::missions::online {

/// What `make` makes, and what that reads, in a child process that may take 2 GiB of memory more
/// than this one has. `name` opens the message if the child dies. Throws Error{bad_file}.
std::unique_ptr<RawlogReader> read_apart(
    const std::string& name, const std::function<std::unique_ptr<RawlogReader>()>& make);

}  // namespace skycap::missions::online
