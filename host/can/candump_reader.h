#pragma once

#include <string>
#include <string_view>

#include "firmware/can/frame.h"

namespace armada {

/// One line of a candump log.
struct CandumpLine {
  int64_t time_ns = 0;  ///< as logged, of the wall clock as a rule
  std::string channel;
  CanFrame frame;
};

/// Reads `(seconds.fraction) channel ID#DATA`, ID#R<length> and ID##<flags>DATA, as `candump -l` and
/// armada-hil write them; a direction T or R at the end is skipped. False when the line is not one.
bool ParseCandumpLine(std::string_view text, CandumpLine* line);

}  // namespace armada
