#pragma once

#include <iosfwd>

#include "host/can/scan.h"

namespace armada {

void PrintText(const ScanResult& result, std::ostream& out);
void PrintJson(const ScanResult& result, std::ostream& out);

}  // namespace armada
