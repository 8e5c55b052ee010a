/// Rawlog reader in a separate process. MRPT does not validate the element counts in a file, so
/// that a malicious file can exhaust memory or exceed array bounds. In a separate process this ends
/// the reader with an error message, not the program that runs a survey.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "missions/online/recordings/rawlog_reader.h"

namespace skycap::missions::online {

/// Runs the reader created by `make` in a child process and returns its entries. The child may use
/// up to 2 GiB more memory than this process. `name` is the prefix of the message if the child
/// crashes. Throws Error{bad_file}.
std::unique_ptr<RawlogReader> read_apart(
    const std::string& name, const std::function<std::unique_ptr<RawlogReader>()>& make);

}  // namespace skycap::missions::online
