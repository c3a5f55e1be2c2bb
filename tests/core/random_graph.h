#pragma once

#include <random>
#include <string>

#include "tests/core/graph_builder.h"

namespace viscera::test {

using Random = std::mt19937;

inline std::size_t pick(Random& random, std::size_t count) {
    return random() % count;
}
inline bool chance(Random& random, unsigned percent) {
    return random() % 100 < percent;
}

/// A graph of all kinds of access that compile() mostly, but not always, accepts.
inline Graph random_graph(Random& random) {
    Graph graph;
    const std::vector<std::string> names{"a", "b", "c", "d", "e", "f"};
    for (const std::string& name : names) {
        graph.targets.push_back(target(name, chance(random, 80) ? PixelFormat::rgba16f : PixelFormat::r8));
    }
    graph.targets.back().format = PixelFormat::depth32f;
    if (chance(random, 50)) {
        graph.imported.push_back({"host", PixelFormat::rgba16f, 64, 64, chance(random, 50)});
    }
    const std::size_t count = 1 + pick(random, 9);
    for (std::size_t p = 0; p < count; ++p) {
        GraphPass pass{"p" + std::to_string(p), "effect", chance(random, 92), {}};
        const std::size_t ports = 1 + pick(random, 4);
        for (std::size_t i = 0; i < ports; ++i) {
            GraphPort port;
            port.port = "port" + std::to_string(i);
            const bool host = !graph.imported.empty() && chance(random, 12);
            port.target = host ? "host" : names[pick(random, names.size())];
            const std::size_t kind = pick(random, 20);
            port.access = kind < 8    ? Access::read
                          : kind < 16 ? Access::write
                          : kind < 19 ? Access::modify
                                      : Access::previous;
            port.optional = port.access != Access::write && chance(random, 85);
            if (port.access == Access::write && !pass.ports.empty() && chance(random, 40)) {
                const GraphPort& source = pass.ports[pick(random, pass.ports.size())];
                if (source.access == Access::read || source.access == Access::previous) {
                    port.passthrough = source.port;
                }
            }
            pass.ports.push_back(port);
        }
        graph.passes.push_back(pass);
    }
    for (const std::string& name : names) {
        if (chance(random, 25)) {
            graph.outputs.push_back(name);
        }
    }
    if (!graph.imported.empty() && graph.imported[0].writable && chance(random, 30)) {
        graph.outputs.push_back("host");
    }
    return graph;
}

}  // namespace viscera::test
