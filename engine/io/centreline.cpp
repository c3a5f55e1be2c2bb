#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <tuple>

#include "engine/core/error.h"
#include "engine/core/finite.h"
#include "engine/io/file_bytes.h"
#include "engine/io/mesh.h"
#include "engine/io/vtp.h"

namespace viscera::io {

namespace {

using Json = nlohmann::json;
using Node = CentrelineGraph::Node;

constexpr std::uint32_t dropped_node = std::numeric_limits<std::uint32_t>::max();

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& key,
                       const std::string& message) {
    throw Error(ErrorCode::file, file.string(), key.empty() ? message : key + ": " + message);
}

/// Collects nodes and edges, counts what has to be dropped, and joins nodes at one place where asked.
class Builder {
  public:
    explicit Builder(bool join) : join_(join) {}

    /// Adds the next point of the file; later edges name it by its place in that order.
    void add_node(const glm::dvec3& position, double radius) {
        if (!finite(position)) {
            ++bad_nodes_;
            node_of_.push_back(dropped_node);
            return;
        }
        if (!(finite(radius) && radius >= 0.0)) {
            ++bad_radii_;
            radius = 0.0;
        }
        const auto next = static_cast<std::uint32_t>(graph_.nodes.size());
        if (join_) {
            const auto [known, is_new] = at_.try_emplace({position.x, position.y, position.z}, next);
            if (!is_new) {
                node_of_.push_back(known->second);
                return;
            }
        }
        graph_.nodes.push_back({position, radius});
        node_of_.push_back(next);
    }

    void add_edge(std::uint64_t a, std::uint64_t b) {
        if (a >= node_of_.size() || b >= node_of_.size() || node_of_[a] == dropped_node ||
            node_of_[b] == dropped_node) {
            ++bad_edges_;
            return;
        }
        const auto [low, high] = std::minmax(node_of_[a], node_of_[b]);
        const bool without_length = low == high;
        if (without_length || !edges_.insert({low, high}).second) {
            // A .vtp repeats its trunk in every line: nothing is lost, nothing to report.
            repeated_edges_ += join_ ? 0 : 1;
            return;
        }
        graph_.edges.push_back({node_of_[a], node_of_[b]});
    }

    CentrelineGraph finish(const std::filesystem::path& file, Log& log) {
        const auto count = [&](const char* what, std::size_t number) {
            if (number > 0) {
                log.fault(std::string("centreline: ") + what,
                          file.string() + ": " + std::to_string(number) + " " + what, number);
            }
        };
        count("nodes that are not finite dropped", bad_nodes_);
        count("radii that are negative or not finite set to 0", bad_radii_);
        count("edges to nodes that are not there dropped", bad_edges_);
        count("repeated edges and edges from a node to itself dropped", repeated_edges_);
        graph_.name = file.string();
        if (graph_.edges.empty()) {
            log.fault("centreline: without edges", file.string() + ": no edge is left");
        }
        return std::move(graph_);
    }

  private:
    bool join_;
    CentrelineGraph graph_;
    std::vector<std::uint32_t> node_of_;  ///< for each point of the file
    std::map<std::tuple<double, double, double>, std::uint32_t> at_;
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges_;
    std::size_t bad_nodes_ = 0;
    std::size_t bad_radii_ = 0;
    std::size_t bad_edges_ = 0;
    std::size_t repeated_edges_ = 0;
};

const VtkArray& radii_of(const VtpPiece& piece, const std::filesystem::path& file) {
    for (const std::string_view name : {"MaximumInscribedSphereRadius", "radius", "Radius"}) {
        const auto found = std::ranges::find(piece.point_data, name, &VtkArray::name);
        if (found != piece.point_data.end() && found->components == 1) {
            return *found;
        }
    }
    std::string names;
    for (const VtkArray& array : piece.point_data) {
        names += (names.empty() ? "" : ", ") + array.name;
    }
    fail(file, "PointData",
         "has neither 'MaximumInscribedSphereRadius' nor 'radius'" +
             (names.empty() ? std::string() : "; it has " + names));
}

CentrelineGraph read_vtp_lines(const std::filesystem::path& file, Log& log) {
    Builder builder(true);
    std::size_t base = 0;
    bool any = false;
    for (const VtpPiece& piece : read_vtp(file)) {
        if (piece.lines.offsets.empty()) {
            continue;
        }
        any = true;
        const VtkArray& radii = radii_of(piece, file);
        for (std::size_t v = 0; v < piece.points; ++v) {
            builder.add_node({piece.positions[3 * v], piece.positions[3 * v + 1], piece.positions[3 * v + 2]},
                             radii.values[v]);
        }
        std::size_t begin = 0;
        for (const std::size_t end : piece.lines.offsets) {
            for (std::size_t i = begin + 1; i < end; ++i) {
                builder.add_edge(base + piece.lines.connectivity[i - 1], base + piece.lines.connectivity[i]);
            }
            begin = end;
        }
        base += piece.points;
    }
    if (!any) {
        fail(file, "Lines", "holds no lines, so it is no centreline");
    }
    return builder.finish(file, log);
}

double number_at(const Json& array, std::size_t i, const std::filesystem::path& file,
                 const std::string& key) {
    if (!array[i].is_number()) {
        fail(file, key + "/" + std::to_string(i), "must be a number");
    }
    return array[i].get<double>();
}

/// The list under `name`, each item of it a list of `length`.
const Json& list_at(const Json& root, const std::string& name, std::size_t length, const char* form,
                    const std::filesystem::path& file) {
    const auto found = root.find(name);
    if (found == root.end() || !found->is_array()) {
        fail(file, "/" + name, std::string("must be a list of ") + form);
    }
    for (std::size_t i = 0; i < found->size(); ++i) {
        if (!(*found)[i].is_array() || (*found)[i].size() != length) {
            fail(file, "/" + name + "/" + std::to_string(i), std::string("must be ") + form);
        }
    }
    return *found;
}

CentrelineGraph read_json(const std::filesystem::path& file, Log& log) {
    Json root;
    try {
        root = Json::parse(read_file(file));
    } catch (const Json::exception& error) {
        fail(file, "", std::string("is no JSON: ") + error.what());
    }
    if (!root.is_object()) {
        fail(file, "", "must be an object with unit, nodes and edges");
    }
    for (const auto& [key, value] : root.items()) {
        if (key != "unit" && key != "nodes" && key != "edges" && key != "$schema") {
            fail(file, "/" + key, "is unknown; a centreline has unit, nodes and edges");
        }
    }
    if (root.value("unit", Json()) != "mm") {
        fail(file, "/unit", "must be \"mm\"");
    }
    Builder builder(false);
    const Json& nodes = list_at(root, "nodes", 4, "[x, y, z, radius]", file);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const std::string key = "/nodes/" + std::to_string(i);
        const auto number = [&](std::size_t k) { return number_at(nodes[i], k, file, key); };
        builder.add_node({number(0), number(1), number(2)}, number(3));
    }
    const Json& edges = list_at(root, "edges", 2, "[a, b], two node indices", file);
    for (std::size_t i = 0; i < edges.size(); ++i) {
        for (std::size_t k = 0; k < 2; ++k) {
            if (!edges[i][k].is_number_unsigned()) {
                fail(file, "/edges/" + std::to_string(i) + "/" + std::to_string(k),
                     "must be the index of a node, 0 or above");
            }
        }
        builder.add_edge(edges[i][0].get<std::uint64_t>(), edges[i][1].get<std::uint64_t>());
    }
    return builder.finish(file, log);
}

}  // namespace

CentrelineGraph load_centreline(const std::filesystem::path& file, Log& log) {
    const std::string extension = lower_extension(file);
    if (extension == ".vtp") {
        return read_vtp_lines(file, log);
    }
    if (extension == ".json") {
        return read_json(file, log);
    }
    fail(file, "", "is no centreline that can be read: .vtp and .json can");
}

}  // namespace viscera::io
