#pragma once

#include <iosfwd>

#include "host/check/check_result.h"

namespace armada {

/// A page for people.
void PrintText(const CheckResult& result, std::ostream& out);

/// The same for machines, SI units; what is infinite comes as null.
void PrintJson(const CheckResult& result, std::ostream& out);

}  // namespace armada
