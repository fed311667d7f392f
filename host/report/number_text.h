#pragma once

#include <string>

namespace armada {

/// A number for readers: `digits` significant digits, "–" where it is not finite, a power of ten where it is
/// very small or very large ("2.1×10⁻⁶").
std::string NumberText(double value, int digits = 3);

/// The same with three digits and without trailing zeros, for running text: "6", "0.25".
std::string ShortNumber(double value);

/// A number for gnuplot: in no locale, with more digits than a picture shows.
std::string GnuplotNumber(double value);

}  // namespace armada
