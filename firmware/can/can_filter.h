#pragma once

#include <cstdint>

#include "firmware/can/frame.h"

namespace armada {

/// Lets frames pass whose identifier equals `id` in the bits of `mask`, of one of the two identifier lengths.
struct CanFilter {
  uint32_t id = 0;
  uint32_t mask = 0;
  bool extended = false;
};

constexpr bool Passes(const CanFilter& filter, const CanFrame& frame) {
  return frame.extended == filter.extended && ((frame.id ^ filter.id) & filter.mask) == 0;
}

}  // namespace armada
