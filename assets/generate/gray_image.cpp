#include "assets/generate/gray_image.h"

#include <algorithm>
#include <cmath>

namespace viscera::assets {

void blur(GrayImage& image, double sigma) {
    const int reach = static_cast<int>(std::ceil(3.0 * sigma));
    std::vector<float> kernel;
    double sum = 0.0;
    for (int k = -reach; k <= reach; ++k) {
        kernel.push_back(static_cast<float>(sigma > 0.0 ? std::exp(-0.5 * k * k / (sigma * sigma)) : 1.0));
        sum += static_cast<double>(kernel.back());
    }
    for (float& weight : kernel) {
        weight /= static_cast<float>(sum);
    }
    const auto pass = [&](const GrayImage& in, GrayImage& out, int dx, int dy) {
        for (int y = 0; y < in.height; ++y) {
            for (int x = 0; x < in.width; ++x) {
                float value = 0.0F;
                for (int k = -reach; k <= reach; ++k) {
                    value += kernel[static_cast<std::size_t>(k + reach)] *
                             in.at(std::clamp(x + k * dx, 0, in.width - 1),
                                   std::clamp(y + k * dy, 0, in.height - 1));
                }
                out.at(x, y) = value;
            }
        }
    };
    GrayImage rows(image.width, image.height);
    pass(image, rows, 1, 0);
    pass(rows, image, 0, 1);
}

}  // namespace viscera::assets
