#include "effects/register_all.h"

#include "effects/contrast/composite_effect.h"
#include "effects/contrast/distance_view_effect.h"
#include "effects/contrast/geometry_effect.h"
#include "effects/contrast/silhouette_effect.h"
#include "effects/contrast/sprite_effect.h"
#include "effects/contrast/summarize_effect.h"
#include "effects/filter/gaussian_effect.h"
#include "effects/mesh/surface_effect.h"
#include "effects/organ/depth_of_field_effect.h"
#include "effects/organ/surface_effect.h"
#include "effects/picture/image_effect.h"
#include "effects/tissue/bake_effect.h"
#include "effects/tissue/bipolar_effect.h"
#include "effects/tissue/blood_account_effect.h"
#include "effects/tissue/blood_effect.h"
#include "effects/tissue/coagulate_effect.h"
#include "effects/tissue/gravity_effect.h"
#include "effects/tissue/jet_effect.h"
#include "effects/volume/limits_effect.h"
#include "effects/volume/ray_cast_effect.h"
#include "effects/volume/slice_effect.h"

namespace viscera {

void register_all(Registry& registry) {
    using namespace contrast;
    using Outputs = GeometryEffect::Outputs;
    registry.add("contrast.geometry",
                 "Vessels, injection cloud and distance map in one pass over the vessel surface.",
                 [] { return std::make_unique<GeometryEffect>(Outputs{}); });
    registry.add("contrast.main", "The vessels alone.",
                 [] { return std::make_unique<GeometryEffect>(Outputs{.cloud = false, .distance = false}); });
    registry.add("contrast.cloud", "The injection cloud alone.",
                 [] { return std::make_unique<GeometryEffect>(Outputs{.main = false, .distance = false}); });
    registry.add("contrast.distance", "The distance map alone.",
                 [] { return std::make_unique<GeometryEffect>(Outputs{.main = false, .cloud = false}); });
    registry.add("contrast.summarize", "Joins the vessels with the injection cloud.",
                 [] { return std::make_unique<SummarizeEffect>(); });
    registry.add("contrast.silhouette", "Where a mesh is seen: a mask for smoke.",
                 [] { return std::make_unique<SilhouetteEffect>(); });
    registry.add("contrast.reflux", "Contrast that flows back out of a vessel's mouth, as smoke.",
                 [] { return std::make_unique<SpriteEffect>("contrast.reflux"); });
    registry.add("contrast.extravasate", "Contrast that leaves a ruptured vessel, as smoke.",
                 [] { return std::make_unique<SpriteEffect>("contrast.extravasate"); });
    registry.add("contrast.composite", "Contrast over the background X-ray: the picture on the detector.",
                 [] { return std::make_unique<CompositeEffect>(); });
    registry.add("contrast.distance_view", "The distance map in colours for inspection.",
                 [] { return std::make_unique<DistanceViewEffect>(); });
    registry.add("volume.ray_cast", "A volume, by a ray for each pixel.",
                 [] { return std::make_unique<volume::RayCastEffect>(); });
    registry.add("volume.entry", "Where rays enter a volume, for volume.ray_cast.",
                 [] { return std::make_unique<volume::LimitsEffect>(volume::LimitsEffect::Side::entry); });
    registry.add("volume.exit", "Where rays leave a volume, for volume.ray_cast.",
                 [] { return std::make_unique<volume::LimitsEffect>(volume::LimitsEffect::Side::exit); });
    registry.add("volume.inner_entry", "Where rays enter a volume's mesh for the last time.", [] {
        return std::make_unique<volume::LimitsEffect>(volume::LimitsEffect::Side::inner_entry);
    });
    registry.add("volume.inner_exit", "Where rays leave a volume's mesh for the first time.", [] {
        return std::make_unique<volume::LimitsEffect>(volume::LimitsEffect::Side::inner_exit);
    });
    registry.add("volume.slice", "A volume's values on a plane or a mesh that cuts it.",
                 [] { return std::make_unique<volume::SliceEffect>(); });
    registry.add("mesh.surface", "Opaque meshes, with their depth.",
                 [] { return std::make_unique<mesh::SurfaceEffect>(); });
    registry.add("tissue.bake", "A surface in texture space: places, normals, scale and seams.",
                 [] { return std::make_unique<tissue::BakeEffect>(); });
    registry.add("tissue.coagulate", "Energy that tissue takes up around monopolar contacts.",
                 [] { return std::make_unique<tissue::CoagulateEffect>(); });
    registry.add("tissue.coagulate_bipolar",
                 "Tissue that a bipolar tool holds, burnt within the tool's shape.",
                 [] { return std::make_unique<tissue::BipolarEffect>(); });
    registry.add("organ.surface", "An organ with burns, blood, cuts and relief, or a membrane before it.",
                 [] { return std::make_unique<organ::SurfaceEffect>(); });
    registry.add("organ.depth_of_field", "Blurs a picture by the blurriness that organs leave in its alpha.",
                 [] { return std::make_unique<organ::DepthOfFieldEffect>(); });
    registry.add("tissue.gravity", "Which way things run down a surface, and what drives a film over it.",
                 [] { return std::make_unique<tissue::GravityEffect>(); });
    registry.add("tissue.blood", "Blood that runs down a surface as drops and as a film.",
                 [] { return std::make_unique<tissue::BloodEffect>(); });
    registry.add("tissue.jet", "Blood in the air, drawn over a picture.",
                 [] { return std::make_unique<tissue::JetEffect>(); });
    registry.add("tissue.blood_account", "How much blood the wounds gave, and where it is.",
                 [] { return std::make_unique<tissue::BloodAccountEffect>(); });
    registry.add("filter.gaussian", "One direction of a Gaussian blur.",
                 [] { return std::make_unique<filter::GaussianEffect>(); });
    registry.add("picture.image", "A picture file as a target.",
                 [] { return std::make_unique<picture::ImageEffect>(); });
}

}  // namespace viscera
