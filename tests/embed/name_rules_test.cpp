#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace viscera::test {
namespace {

namespace fs = std::filesystem;

/// A declaration that begins in a file's first column, as the formatter leaves those of a namespace.
struct Declared {
    std::string name;
    std::string space;  ///< its named namespaces
    bool is_unnamed = false;
    std::string place;
};

/// The name that a line declares; empty when none. Arguments of templates are taken out first.
std::string name_in(std::string line) {
    static const std::regex attribute(R"re(\[\[\w+\]\] )re");
    static const std::regex arguments(R"re(<[^<>]*>)re");
    static const std::regex other(
        R"re(^(using|template|return|static_assert|extern|public|private|TEST|#).*)re");
    static const std::regex type(R"re(^(?:struct|class|enum class|enum) (\w+).*)re");
    static const std::regex value(R"re(^[\w:*& ]*?[ *&]([A-Za-z_]\w*)\s*(?:[({=\[;].*)?$)re");
    if (line.empty() || (std::isalpha(static_cast<unsigned char>(line[0])) == 0 && line[0] != '[') ||
        std::regex_match(line, other)) {
        return {};
    }
    line = std::regex_replace(line, attribute, "");
    for (std::string before; before != line;) {
        before = line;
        line = std::regex_replace(line, arguments, "");
    }
    std::smatch match;
    return std::regex_match(line, match, type) || std::regex_match(line, match, value) ? match.str(1) : "";
}

std::vector<Declared> declared_in(const fs::path& file) {
    static const std::regex opens(R"re(^namespace ([\w:]+) \{$)re");
    std::vector<Declared> found;
    std::vector<std::string> spaces;
    bool unnamed = false;
    std::ifstream stream(file);
    int number = 0;
    for (std::string line; std::getline(stream, line);) {
        ++number;
        std::smatch match;
        if (line == "namespace {") {
            unnamed = true;
        } else if (line == "}  // namespace") {
            unnamed = false;
        } else if (line.starts_with("}  // namespace ")) {
            spaces.pop_back();
        } else if (std::regex_match(line, match, opens)) {
            spaces.push_back((spaces.empty() ? "" : spaces.back() + "::") + match.str(1));
        } else if (const std::string name = name_in(line); !name.empty() && !spaces.empty()) {
            found.push_back({name, spaces.back(), unnamed,
                             fs::relative(file, VISCERA_SOURCE_DIR).string() + ":" + std::to_string(number)});
        }
    }
    return found;
}

/// Of the headers and of the sources under these folders.
std::vector<Declared> declared_under(const std::vector<std::string>& folders, const char* extension) {
    std::vector<Declared> found;
    for (const std::string& folder : folders) {
        for (const auto& entry : fs::recursive_directory_iterator(fs::path(VISCERA_SOURCE_DIR) / folder)) {
            if (entry.path().extension() == extension) {
                const std::vector<Declared> here = declared_in(entry.path());
                found.insert(found.end(), here.begin(), here.end());
            }
        }
    }
    return found;
}

// Sources are compiled several as one. In there a name of one source's unnamed namespace would be found by
// its neighbours before the one that a header gives them, and what they call would be another function.
TEST(NameRules, UnnamedNamespacesHideNothingThatAHeaderDeclares) {
    const std::vector<std::string> rooms{"engine", "effects", "samples"};
    std::multimap<std::string, Declared> public_names;
    for (const Declared& one : declared_under(rooms, ".h")) {
        public_names.emplace(one.name, one);
    }
    int checked = 0;
    for (const Declared& one : declared_under(rooms, ".cpp")) {
        if (!one.is_unnamed) {
            continue;
        }
        ++checked;
        const auto [from, to] = public_names.equal_range(one.name);
        for (auto other = from; other != to; ++other) {
            const std::string& space = other->second.space;
            EXPECT_FALSE(one.space == space || one.space.starts_with(space + "::"))
                << one.place << ": '" << one.name << "' is declared in " << other->second.place << ", too";
        }
    }
    EXPECT_GT(public_names.size(), 800U);
    EXPECT_GT(checked, 1000);
}

TEST(NameRules, AreReadFromDeclarations) {
    EXPECT_EQ(name_in("float skin_distance(const glm::vec3& p) {"), "skin_distance");
    EXPECT_EQ(name_in("[[nodiscard]] std::map<std::string, std::vector<int>> all(int a,"), "all");
    EXPECT_EQ(name_in("constexpr double most = 1.0;"), "most");
    EXPECT_EQ(name_in("constexpr std::array rows{"), "rows");
    EXPECT_EQ(name_in("class Segment {"), "Segment");
    EXPECT_EQ(name_in("struct Box : Shape {"), "Box");
    EXPECT_EQ(name_in("    return nothing(1);"), "");
    EXPECT_EQ(name_in("using std::numbers::pi;"), "");
    EXPECT_EQ(name_in("}"), "");
}

}  // namespace
}  // namespace viscera::test
