// Runs all examples. Exit code 0 if all results are correct.
#include <cstdio>
#include <exception>

#include "example.h"

int main() {
  std::size_t failed = 0;
  for (const Example::Named& example : Example::all()) {
    try {
      if (example.holds()) continue;
      std::printf("%s: unexpected result\n", example.name);
    } catch (const std::exception& error) {
      std::printf("%s: %s\n", example.name, error.what());
    }
    ++failed;
  }
  std::printf("%zu of %zu examples passed\n", Example::all().size() - failed,
              Example::all().size());
  return failed == 0 ? 0 : 1;
}
