#pragma once

#include <cstddef>
#include <vector>

namespace viscera::app {

/// One measurement.
struct Sample {
    double time_ms = 0.0;  ///< wall clock up to glFinish, or the GPU's own clock
    double work_ms = 0.0;  ///< processor time of all threads of this process; software renderers only
};
using Samples = std::vector<Sample>;

struct Spread {
    double lower = 0.0;  ///< first quartile
    double median = 0.0;
    double upper = 0.0;  ///< third quartile
};

/// Quartiles, linearly interpolated; zeros for no values.
[[nodiscard]] Spread spread(std::vector<double> values);
[[nodiscard]] Spread times(const Samples& samples);
[[nodiscard]] Spread works(const Samples& samples);
/// Median over pairs measured in the same frame. NaN when one of them is empty.
[[nodiscard]] double ratio(const Samples& samples, const Samples& base, double Sample::*what);
/// Sample by sample.
[[nodiscard]] Samples operator+(const Samples& a, const Samples& b);
/// Means of `parts` over `count` samples in a row each; what is left over is dropped.
[[nodiscard]] Samples means(const Samples& samples, std::size_t count, double parts);

}  // namespace viscera::app
