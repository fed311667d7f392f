#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "firmware/app/config/effective_values.h"

namespace armada {

/// Prints each parameter whose key has `part` in it: its value, default, unit, legal values and meaning.
/// Elements of a list that agree, such as all arms, are one entry with `*`. False when there is none.
bool Explain(const std::vector<EffectiveValue>& values, const std::string& part, std::ostream& out);

}  // namespace armada
