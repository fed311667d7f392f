#pragma once

#include <iosfwd>

namespace armada {

/// docs/states.md: states, transitions and causes, from the tables that the supervisor runs on.
void WriteStatesReference(std::ostream& out);

}  // namespace armada
