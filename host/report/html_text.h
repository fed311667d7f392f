#pragma once

#include <filesystem>
#include <string>

namespace armada {

/// `text` with the characters that HTML gives a meaning replaced.
std::string HtmlEscaped(const std::string& text);

/// The drawing of an SVG file by gnuplot, to stand within an HTML page: it scales with the page, carries
/// `title` for screen readers, its black is the page's colour of text, and its ids start with `name` so that
/// several drawings do not clash. Throws ReportError where the file cannot be read or is not SVG.
std::string InlineSvg(const std::filesystem::path& path, const std::string& name, const std::string& title);

}  // namespace armada
