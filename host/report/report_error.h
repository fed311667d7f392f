#pragma once

#include <stdexcept>

namespace armada {

/// What stops a report: the message names the file and what is wrong with it.
struct ReportError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace armada
