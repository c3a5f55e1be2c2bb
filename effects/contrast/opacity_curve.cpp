#include "effects/contrast/opacity_curve.h"

#include <algorithm>

namespace viscera::contrast {

std::vector<OpacityLine> opacity_lines(int n) {
    const int terms = std::clamp(n, 1, 4096);
    std::vector<OpacityLine> lines;
    OpacityLine sum;
    for (int i = 0; i < terms; ++i) {
        const double rest = terms - i;
        sum.slope += 2.0 * terms / rest;
        sum.offset += 2.0 * i / rest;
        lines.push_back(sum);
        const double next_knot = static_cast<double>(i + 1) / terms;
        if (sum.slope * next_knot - sum.offset >= 1.0) {
            break;
        }
    }
    return lines;
}

double opacity_saturation(int n) {
    const OpacityLine last = opacity_lines(n).back();
    return (1.0 + last.offset) / last.slope;
}

double opacity(double a, int n) {
    if (!(a > 0.0)) {
        return 0.0;
    }
    const double density = std::min(a, 1.0);
    double sum = 0.0;
    for (const OpacityLine& line : opacity_lines(n)) {
        sum = std::max(sum, line.slope * density - line.offset);
    }
    return std::min(1.0, sum);
}

float opacity_float(float a) {
    float sum = 0.0F;
    for (const OpacityLineFloat& line : opacity_lines_float) {
        sum = std::max(sum, line.slope * a - line.offset);
    }
    return std::min(1.0F, sum);
}

}  // namespace viscera::contrast
