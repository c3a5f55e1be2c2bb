#include "engine/core/finite.h"

#include <gtest/gtest.h>
#include <glm/glm.hpp>

#include "engine/core/mesh_data.h"
#include "tests/core/not_finite.h"

namespace viscera {
namespace {

TEST(Finite, LooksAtEveryNumber) {
    EXPECT_TRUE(finite(-1e300));
    EXPECT_TRUE(finite(glm::dvec4(0.0)));
    EXPECT_TRUE(finite(glm::dmat4(1.0)));
    for (const double bad : {nan, infinity, -infinity}) {
        EXPECT_FALSE(finite(bad));
        for (int i = 0; i < 3; ++i) {
            glm::vec3 v(1.0F);
            v[i] = static_cast<float>(bad);
            EXPECT_FALSE(finite(v)) << i;
            for (int column = 0; column < 4; ++column) {
                glm::dmat4x3 m(1.0);
                m[column][i] = bad;
                EXPECT_FALSE(finite(m)) << column << ", " << i;
            }
        }
    }
}

TEST(Finite, EdgesOfACentrelineJoinTwoSoundNodes) {
    const CentrelineGraph graph{.nodes = {{glm::dvec3(0.0), 1.0},
                                          {glm::dvec3(1.0), 0.0},
                                          {glm::dvec3(0.0, nan, 0.0), 1.0},
                                          {glm::dvec3(2.0), infinity}},
                                .edges = {}};
    EXPECT_TRUE(graph.joins({0, 1}));
    EXPECT_FALSE(graph.joins({1, 1})) << "one node";
    EXPECT_FALSE(graph.joins({0, 2})) << "no place";
    EXPECT_FALSE(graph.joins({3, 0})) << "no radius";
    EXPECT_FALSE(graph.joins({0, 4})) << "no node";
}

}  // namespace
}  // namespace viscera
