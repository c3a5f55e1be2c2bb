#include "effects/volume/ray_cast_effect.h"

// Which programs the parameters ask for: one for each thing that only the data or the frame decide.
namespace viscera::volume {

/// What the volume may be: what the scene says, else what the file or the host turns out to give.
std::vector<VolumeKind> RayCastEffect::kinds() const {
    if (params_.volume.geometry) {
        return {params_.volume.geometry->kind};
    }
    if (params_.sampling.scheme == Scheme::cell) {
        return {VolumeKind::cartesian};
    }
    return {VolumeKind::cartesian, VolumeKind::cylindrical, VolumeKind::spherical};
}

std::span<const ProgramDesc> RayCastEffect::programs() const {
    programs_.clear();
    variants_.clear();
    // What a file's preset asks for is known when the file is read.
    const bool by_file = !params_.function && !params_.transfer_function.file.empty();
    const RayFunction given = params_.function ? marched_as(*params_.function) : RayFunction::composite;
    for (const RayFunction function : {RayFunction::composite, RayFunction::mip, RayFunction::minip,
                                       RayFunction::average, RayFunction::xray, RayFunction::isosurface}) {
        if (!by_file && function != given) {
            continue;
        }
        for (const Skipping skipping : {Skipping::none, Skipping::empty, Skipping::adaptive}) {
            if (skipping == Skipping::adaptive &&
                (params_.sampling.tolerance == 0.0 || function != RayFunction::composite)) {
                continue;
            }
            ProgramDesc program{"common/fullscreen.vert", "volume/ray_cast.frag", {}};
            if (function == RayFunction::composite) {
                program.defines.emplace_back("COMPOSITE");
                if (shows_colours()) {
                    program.defines.emplace_back("COLOURS");
                }
            } else if (function == RayFunction::isosurface) {
                add_defines(params_.isosurface, params_.sampling.reconstruction.is_tricubic(),
                            program.defines);
            } else {
                program.defines.push_back("PROJECTION " + std::to_string(static_cast<int>(function) - 1));
                if (params_.threshold) {
                    program.defines.emplace_back("THRESHOLD");
                }
            }
            add_defines(params_.sampling, program.defines);
            const std::vector<std::string> filter = params_.sampling.reconstruction.defines();
            program.defines.insert(program.defines.end(), filter.begin(), filter.end());
            if (params_.transfer_function.interpolate) {
                program.defines.emplace_back("TRANSFER_LINEAR");
            }
            if (skipping != Skipping::none) {
                program.defines.emplace_back("SKIP");
            }
            if (skipping == Skipping::adaptive) {
                program.defines.emplace_back("ADAPTIVE");
            }
            if (params_.sampling.limits != Limits::analytic) {
                program.defines.push_back("LIMITS " +
                                          std::to_string(static_cast<int>(params_.sampling.limits)));
            }
            if (params_.sub_volume) {
                program.defines.emplace_back("SUB_VOLUME");
            }
            if (params_.mixed && params_.mixed->pass == MixedPass::coarse) {
                program.defines.emplace_back("MIXED_COARSE");
            }
            const std::vector<std::string> clip = clip_defines(params_.look.clip_planes);
            program.defines.insert(program.defines.end(), clip.begin(), clip.end());
            const std::vector<Look::Variant> looks =
                function == RayFunction::composite ? Look::variants(params_.look, params_.transfer_function)
                                                   : std::vector<Look::Variant>{Look::Variant{}};
            for (const Look::Variant& look : looks) {
                const std::vector<std::string> defines = Look::defines(params_.look, look);
                programs_.push_back(program);
                programs_.back().defines.insert(programs_.back().defines.end(), defines.begin(),
                                                defines.end());
                variants_.push_back({VolumeKind::cartesian, function, skipping, look});
            }
        }
    }
    // All of them again for what else may be in the picture, and as compute shaders.
    const auto again = [&](bool Variant::*what, std::string_view define) {
        const std::size_t count = programs_.size();
        for (std::size_t i = 0; i < count; ++i) {
            programs_.push_back(programs_[i]);
            variants_.push_back(variants_[i]);
            variants_.back().*what = true;
            if (what == &Variant::compute) {
                programs_.back() = {"", "", programs_[i].defines, "volume/ray_cast.comp"};
            } else {
                programs_.back().defines.emplace_back(define);
                if (what == &Variant::fills) {
                    programs_.back().vertex = "volume/mixed_tiles.vert";
                }
            }
        }
    };
    if (params_.sampling.limits == Limits::mesh) {
        again(&Variant::inner, "LIMITS_INNER");
    }
    // For each kind of volume that it may be.
    const std::vector<ProgramDesc> straight = std::move(programs_);
    const std::vector<Variant> straight_variants = std::move(variants_);
    programs_.clear();
    variants_.clear();
    for (const VolumeKind kind : kinds()) {
        for (std::size_t i = 0; i < straight.size(); ++i) {
            programs_.push_back(straight[i]);
            variants_.push_back(straight_variants[i]);
            variants_.back().kind = kind;
            const std::vector<std::string> defines = coordinate_defines(kind);
            programs_.back().defines.insert(programs_.back().defines.end(), defines.begin(), defines.end());
        }
    }
    again(&Variant::surface, "SURFACE");
    again(&Variant::background, "BACKGROUND");
    if (params_.mixed && params_.mixed->pass == MixedPass::fine) {
        again(&Variant::fills, "MIXED_FINE");
    }
    if (params_.volume.storage != Storage::texture_3d) {
        again(&Variant::atlas, "STORAGE_ATLAS");
    }
    again(&Variant::compute, "");
    if (params_.mixed && params_.mixed->pass == MixedPass::fine) {
        // What else such a pass draws, in the order in which mixed_program() counts.
        for (const auto& [file, define] :
             {std::pair{"volume/mixed_plan", "SURFACE"}, {"volume/mixed_fill", "BACKGROUND"}}) {
            for (const bool given : {false, true}) {
                const std::string name(file);
                std::vector<std::string> defines;
                if (given) {
                    defines.emplace_back(define);
                }
                programs_.push_back({"common/fullscreen.vert", name + ".frag", defines});
                programs_.push_back({"", "", defines, name + ".comp"});
            }
        }
    }
    return programs_;
}

}  // namespace viscera::volume
