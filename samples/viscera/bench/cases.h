#pragma once

#include <span>
#include <string_view>

#include "samples/viscera/bench/lab.h"

namespace viscera::app {

/// One thing to measure.
struct Case {
    std::string_view name;
    std::string_view doc;
    void (*run)(Lab&);
};

/// All cases, the ceilings first.
[[nodiscard]] std::span<const Case> all_cases();

void run_ceilings(Lab& lab);
void run_read_back(Lab& lab);
void run_geometry(Lab& lab);
void run_overlap(Lab& lab);
void run_summarize(Lab& lab);
void run_composite(Lab& lab);
void run_gaussian(Lab& lab);
void run_sprites(Lab& lab);
void run_chain(Lab& lab);
void run_cached(Lab& lab);
void run_region(Lab& lab);
void run_cpu(Lab& lab);
void run_precision(Lab& lab);
void run_opacity(Lab& lab);
void run_density(Lab& lab);
void run_resolution(Lab& lab);
void run_volume(Lab& lab);
void run_steps(Lab& lab);
void run_skipping(Lab& lab);
void run_quality(Lab& lab);
void run_filters(Lab& lab);
void run_organ(Lab& lab);
void run_curvilinear(Lab& lab);
void run_blood(Lab& lab);
void run_tissue_bake(Lab& lab);
void run_tissue_energy(Lab& lab);
void run_mixed(Lab& lab);
void run_eyes(Lab& lab);
void run_fovea(Lab& lab);

}  // namespace viscera::app
