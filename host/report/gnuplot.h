#pragma once

#include <filesystem>

namespace armada {

/// Runs gnuplot on `folder`/`script`, in that folder and without the user's own gnuplot settings.
/// Throws ReportError with gnuplot's own message where it cannot be started or fails.
void RunGnuplot(const std::filesystem::path& folder, const std::string& script);

}  // namespace armada
