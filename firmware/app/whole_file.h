#pragma once

#include <functional>
#include <ostream>
#include <string>

namespace armada {

/// Writes a file through a temporary one beside it, so that neither a reader nor a loss of power ever leaves
/// half of it. Missing folders are made. False with *error set.
bool WriteWhole(const std::string& path, const std::function<void(std::ostream&)>& write, std::string* error);

/// Whether WriteWhole could write there: to be asked before long work whose result goes there. False with
/// *error set.
bool CanWriteWhole(const std::string& path, std::string* error);

}  // namespace armada
