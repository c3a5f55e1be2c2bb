#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

namespace viscera {
namespace {

const std::filesystem::path root = VISCERA_SOURCE_DIR;

std::string text_of(const std::filesystem::path& file) {
    std::ifstream stream(file);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

/// Code in the docs whose first line names a file ("// path" or "# path") must stand in that file.
TEST(Docs, code_blocks_stand_in_the_files_that_they_name) {
    int checked = 0;
    for (const auto& entry : std::filesystem::directory_iterator(root / "docs")) {
        if (entry.path().extension() != ".md") {
            continue;
        }
        std::istringstream lines(text_of(entry.path()));
        bool inside = false;
        std::string file;
        std::string block;
        for (std::string line; std::getline(lines, line);) {
            if (line.starts_with("```")) {
                if (inside && !file.empty()) {
                    ++checked;
                    EXPECT_NE(text_of(root / file).find(block), std::string::npos)
                        << entry.path() << ": not in " << file << ":\n"
                        << block;
                }
                inside = !inside;
                file.clear();
                block.clear();
                continue;
            }
            if (!inside) {
                continue;
            }
            const std::size_t name = line.starts_with("// ") ? 3 : line.starts_with("# ") ? 2 : 0;
            if (block.empty() && file.empty() && name > 0 &&
                std::filesystem::is_regular_file(root / line.substr(name))) {
                file = line.substr(name);
            } else {
                block += line + "\n";
            }
        }
        EXPECT_FALSE(inside) << entry.path() << ": a code block is not closed";
    }
    EXPECT_GE(checked, 8);
}

/// Links to files of the project lead somewhere.
TEST(Docs, links_lead_somewhere) {
    std::vector<std::filesystem::path> pages{root / "README.md", root / "CONTRIBUTING.md"};
    for (const auto& entry : std::filesystem::directory_iterator(root / "docs")) {
        if (entry.path().extension() == ".md") {
            pages.push_back(entry.path());
        }
    }
    for (const std::filesystem::path& page : pages) {
        const std::string text = text_of(page);
        for (std::size_t at = text.find("]("); at != std::string::npos; at = text.find("](", at + 2)) {
            const std::string link = text.substr(at + 2, text.find(')', at) - at - 2);
            if (!link.starts_with("http") && !link.starts_with("#")) {
                EXPECT_TRUE(std::filesystem::exists(page.parent_path() / link)) << page << ": " << link;
            }
        }
    }
}

}  // namespace
}  // namespace viscera
