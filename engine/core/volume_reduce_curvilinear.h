#pragma once

#include "engine/core/volume.h"

namespace viscera {

/// reduced() of a curvilinear volume: its shape stays as it is, so the ends of each extent stay samples and a
/// ring stays evenly divided, and between them there are about `factor` times fewer, each the mean over the
/// way from half its interval before to half behind it. At an end that is the end's own value: r_min, the
/// poles and the faces of a gap do not blur into what lies beside them. Labels: the sample nearest.
[[nodiscard]] Volume reduced_curvilinear(const Volume& volume, int factor, bool labels);

}  // namespace viscera
