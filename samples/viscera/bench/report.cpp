#include "samples/viscera/bench/report.h"

#include <cmath>
#include <iomanip>
#include <ostream>
#include <sstream>

namespace viscera::app {
namespace {

std::string fixed(double value, int digits) {
    std::ostringstream text;
    text << std::fixed << std::setprecision(digits) << value;
    return text.str();
}

std::string significant(double value) {
    std::ostringstream text;
    text << std::setprecision(3) << value;
    return text.str();
}

/// Other programs on the machine stretch the wall clock, but not this process's own work.
double judged_ratio(const Row& row, bool hardware) {
    const double by_work = hardware ? std::nan("") : ratio(row.samples, row.base, &Sample::work_ms);
    return std::isnan(by_work) ? ratio(row.samples, row.base, &Sample::time_ms) : by_work;
}

}  // namespace

void print_table(std::ostream& out, std::span<const Row> rows, bool hardware) {
    std::string group;
    for (const Row& row : rows) {
        if (row.group != group) {
            group = row.group;
            out << '\n'
                << std::left << std::setw(38) << group << std::right << std::setw(10) << "ms" << std::setw(21)
                << "quartiles" << std::setw(10) << "cpu ms" << std::setw(9) << "ratio" << std::setw(9)
                << "by cpu" << std::setw(7) << "goal" << std::setw(11) << "error" << std::setw(11) << "rms"
                << "  of what\n";
        }
        const Spread time = times(row.samples);
        const Spread work = works(row.samples);
        const double by_time = ratio(row.samples, row.base, &Sample::time_ms);
        const double by_work = ratio(row.samples, row.base, &Sample::work_ms);
        out << "  " << std::left << std::setw(36) << row.name << std::right;
        out << std::setw(10) << (row.samples.empty() ? "" : fixed(time.median, 4)) << std::setw(21)
            << (row.samples.empty() ? "" : fixed(time.lower, 4) + " " + fixed(time.upper, 4));
        out << std::setw(10) << (work.median > 0.0 ? fixed(work.median, 3) : "");
        out << std::setw(9) << (std::isnan(by_time) ? "" : fixed(by_time, 3)) << std::setw(9)
            << (std::isnan(by_work) || hardware ? "" : fixed(by_work, 3));
        out << std::setw(7) << (row.goal ? fixed(*row.goal, 2) : "");
        out << std::setw(11) << (row.error ? significant(*row.error) : "") << std::setw(11)
            << (row.rms ? significant(*row.rms) : "") << "  ";
        if (row.value) {
            out << significant(*row.value) << ' ' << row.unit << "; ";
        }
        out << (row.ceiling.empty() ? "" : "ratio to " + row.ceiling);
        out << (row.error_of.empty() ? "" : "; error against " + row.error_of);
        if (row.goal) {
            out << (judged_ratio(row, hardware) <= *row.goal ? "; met" : "; MISSED");
        }
        out << '\n';
    }
}

nlohmann::json to_json(std::span<const Row> rows, bool hardware) {
    nlohmann::json list = nlohmann::json::array();
    const auto spread_json = [](const Spread& s) {
        return nlohmann::json{{"median", s.median}, {"lower", s.lower}, {"upper", s.upper}};
    };
    for (const Row& row : rows) {
        nlohmann::json entry{{"case", row.group}, {"name", row.name}};
        if (!row.samples.empty()) {
            entry["time_ms"] = spread_json(times(row.samples));
            if (works(row.samples).median > 0.0) {
                entry["cpu_ms"] = spread_json(works(row.samples));
            }
        }
        if (row.value) {
            entry["value"] = *row.value;
            entry["unit"] = row.unit;
        }
        if (row.error) {
            entry["error"] = *row.error;
            entry["error_against"] = row.error_of;
        }
        if (row.rms) {
            entry["rms"] = *row.rms;
        }
        if (!row.base.empty()) {
            entry["ceiling"] = row.ceiling;
            entry["ratio"] = ratio(row.samples, row.base, &Sample::time_ms);
            const double by_work = ratio(row.samples, row.base, &Sample::work_ms);
            if (!hardware && !std::isnan(by_work)) {
                entry["cpu_ratio"] = by_work;
            }
        }
        if (row.goal) {
            entry["goal"] = *row.goal;
            entry["met"] = judged_ratio(row, hardware) <= *row.goal;
        }
        list.push_back(std::move(entry));
    }
    return list;
}

}  // namespace viscera::app
