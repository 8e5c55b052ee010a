/// Lines of Markdown tables in reports.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace skycap::missions::batch {

/// Returns a row of a Markdown table.
inline std::string table_row(const std::vector<std::string>& cells) {
  std::string text = "|";
  for (const std::string& cell : cells) text += " " + cell + " |";
  return text + "\n";
}

/// Returns the line below the header of a table, whose columns after the first one contain numbers.
inline std::string table_rule(std::size_t columns) {
  std::string text = "| --- |";
  for (std::size_t i = 1; i < columns; ++i) text += " ---: |";
  return text + "\n";
}

}  // namespace skycap::missions::batch
