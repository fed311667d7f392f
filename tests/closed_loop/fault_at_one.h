#pragma once

#include "hil/fault.h"

namespace armada {

/// A fault of arm 1 unless said, from 1 s to 3 s.
inline FaultConfig FaultAtOne(FaultKind kind, double value = 0.0, int arm = 1) {
  FaultConfig fault;
  fault.kind = kind;
  fault.at_s = 1.0;
  fault.until_s = 3.0;
  fault.arm = arm;
  fault.value = value;
  return fault;
}

}  // namespace armada
