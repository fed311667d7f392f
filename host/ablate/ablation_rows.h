#pragma once

#include <vector>

namespace armada {

/// One component of the law or of the estimator, and how to do without it.
struct AblationRow {
  const char* component;
  const char* purpose;                 ///< what it is for, in a few words
  std::vector<const char*> overrides;  ///< key=value, as for --set, that take it out
};

/// The rows of the ablation table: one component taken out each.
const std::vector<AblationRow>& AblationRows();

}  // namespace armada
