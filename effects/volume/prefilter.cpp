#include "effects/volume/prefilter.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <thread>
#include <vector>

#include "effects/volume/derived_source.h"
#include "effects/volume/gpu_volume.h"
#include "engine/core/content_hash.h"
#include "engine/core/error.h"
#include "engine/core/hash.h"

namespace viscera::volume {
namespace {

constexpr int fade_reach = 16;  // a change fades by 0.268 per voxel

/// Factors of the elimination for a line of n: 1 / (diagonal - the factor before).
std::vector<double> elimination(int n) {
    std::vector<double> factors(static_cast<std::size_t>(n));
    double before = 0.0;
    for (int i = 0; i < n; ++i) {
        const double diagonal = 4.0 + (i == 0 ? 1.0 : 0.0) + (i == n - 1 ? 1.0 : 0.0);
        before = 1.0 / (diagonal - before);
        factors[static_cast<std::size_t>(i)] = before;
    }
    return factors;
}

/// Solves `width` lines that lie side by side: row i of `rows` holds element i of each.
void solve(std::span<const double> factors, std::size_t width, double* rows) {
    const std::size_t n = factors.size();
    for (std::size_t x = 0; x < width; ++x) {
        rows[x] *= 6.0 * factors[0];
    }
    for (std::size_t i = 1; i < n; ++i) {
        double* row = rows + i * width;
        const double* before = row - width;
        for (std::size_t x = 0; x < width; ++x) {
            row[x] = (6.0 * row[x] - before[x]) * factors[i];
        }
    }
    for (std::size_t i = n - 1; i-- > 0;) {
        double* row = rows + i * width;
        const double* behind = row + width;
        for (std::size_t x = 0; x < width; ++x) {
            row[x] -= factors[i] * behind[x];
        }
    }
}

/// Solves lines whose ends are neighbours. The two corners of that matrix are taken off as a product of two
/// vectors (Sherman and Morrison): a line more to solve, once.
class RingSolver {
  public:
    explicit RingSolver(int n) : n_(static_cast<std::size_t>(n)) {
        if (n < 3) {
            return;  // solved directly
        }
        // A' = A - u v^T, u = (-4, 0, .., 0, 1), v = (1, 0, .., 0, -1/4): tridiagonal with the diagonal 8, 4,
        // .., 4, 4 + 1/4.
        factors_.resize(n_);
        double before = 0.0;
        for (std::size_t i = 0; i < n_; ++i) {
            const double diagonal = i == 0 ? 8.0 : (i == n_ - 1 ? 4.25 : 4.0);
            before = 1.0 / (diagonal - before);
            factors_[i] = before;
        }
        correction_.assign(n_, 0.0);
        correction_.front() = -4.0 / 6.0;  // solve() multiplies by 6
        correction_.back() = 1.0 / 6.0;
        solve(factors_, 1, correction_.data());
        share_ = 1.0 / (1.0 + correction_.front() - 0.25 * correction_.back());
    }

    void operator()(std::size_t width, double* rows) const {
        if (n_ == 1) {
            return;  // (1 + 4 + 1) / 6: itself
        }
        if (n_ == 2) {  // each is both neighbours of the other: (4 a + 2 b) / 6
            for (std::size_t x = 0; x < width; ++x) {
                const double a = rows[x];
                const double b = rows[width + x];
                rows[x] = 2.0 * a - b;
                rows[width + x] = 2.0 * b - a;
            }
            return;
        }
        solve(factors_, width, rows);
        const double* const last = rows + (n_ - 1) * width;
        for (std::size_t x = 0; x < width; ++x) {
            const double off = (rows[x] - 0.25 * last[x]) * share_;
            for (std::size_t i = 0; i < n_; ++i) {
                rows[i * width + x] -= off * correction_[i];
            }
        }
    }

  private:
    std::size_t n_;
    std::vector<double> factors_;
    std::vector<double> correction_;
    double share_ = 0.0;
};

/// Calls work(begin, end) for parts of [0, count) on several threads.
template <class Work>
void in_parts(int count, int threads, const Work& work) {
    const int wanted = threads > 0 ? threads : static_cast<int>(std::thread::hardware_concurrency());
    const int parts = std::clamp(wanted, 1, count);
    std::vector<std::jthread> others;
    for (int part = 1; part < parts; ++part) {
        others.emplace_back([&, part] {
            work(static_cast<int>(static_cast<std::int64_t>(count) * part / parts),
                 static_cast<int>(static_cast<std::int64_t>(count) * (part + 1) / parts));
        });
    }
    work(0, count / parts);
}

/// One channel of a box in stored units.
std::vector<float> stored_values(const Volume& volume, int channel, const VoxelBox& box, float empty) {
    std::vector<float> result;
    result.reserve(static_cast<std::size_t>(box.size.x) * static_cast<std::size_t>(box.size.y) *
                   static_cast<std::size_t>(box.size.z));
    for (int z = 0; z < box.size.z; ++z) {
        for (int y = 0; y < box.size.y; ++y) {
            for (int x = 0; x < box.size.x; ++x) {
                const auto stored =
                    static_cast<float>(volume.stored(box.first + glm::ivec3(x, y, z), channel));
                result.push_back(is_number(stored) ? stored : empty);
            }
        }
    }
    return result;
}

/// A box grown by some voxels to all sides, cut at the volume's faces.
VoxelBox grown(const VoxelBox& box, int by, const glm::ivec3& dims) {
    const glm::ivec3 first = glm::clamp(box.first - by, glm::ivec3(0), dims);
    return {first, glm::clamp(box.first + box.size + by, glm::ivec3(0), dims) - first};
}

/// The voxels of `inner` out of those of `outer`, which holds it.
std::vector<float> cut_out(const std::vector<float>& voxels, const VoxelBox& outer, const VoxelBox& inner) {
    std::vector<float> result;
    const glm::ivec3 first = inner.first - outer.first;
    for (int z = 0; z < inner.size.z; ++z) {
        for (int y = 0; y < inner.size.y; ++y) {
            const auto row = voxels.begin() +
                             (static_cast<std::ptrdiff_t>(first.z + z) * outer.size.y + first.y + y) *
                                 static_cast<std::ptrdiff_t>(outer.size.x) +
                             first.x;
            result.insert(result.end(), row, row + inner.size.x);
        }
    }
    return result;
}

/// What the disk cache calls coefficients; another number when they are made in another way.
constexpr std::string_view cached_kind = "bspline-1";

/// The coefficients of all voxels of one channel, as bytes of f32; those of a file from the disk cache, if
/// they are there.
std::vector<std::byte> all_coefficients(Assets& assets, const Source& source, int channel, float empty) {
    const Volume& volume = source.volume();
    const glm::ivec3 dims = volume.grid.dims;
    // What a host gives may change with each frame and would fill the disk.
    const bool keep = source.live == nullptr && assets.disk_cache().enabled();
    const std::uint64_t key = keep ? Hash()
                                         .add(dims)
                                         .add(volume.grid.shape.wrap_axis())
                                         .add(volume.type)
                                         .add(volume.channels)
                                         .add(channel)
                                         .add(empty)
                                         .add(volume.grid.shape.wrap_axis())
                                         .add(content_hash(volume.voxels))
                                         .value()
                                   : 0;
    if (keep) {
        auto kept = assets.disk_cache().load(cached_kind, key);
        if (kept && kept->size() == volume.grid.voxel_count() * sizeof(float)) {
            return std::move(*kept);
        }
    }
    std::vector<float> values = stored_values(volume, channel, {glm::ivec3(0), dims}, empty);
    if (!make_coefficients(
            dims, values, 0,
            assets.progress("prefiltering " + std::filesystem::path(volume.source).filename().string()),
            volume.grid.shape.wrap_axis())) {
        throw Error(ErrorCode::usage, volume.source, "cancelled");
    }
    const auto bytes = std::as_bytes(std::span(values));
    if (keep) {
        assets.disk_cache().store(cached_kind, key, bytes);
    }
    return {bytes.begin(), bytes.end()};
}

/// f32 channels beside each other.
std::vector<std::byte> interleaved(std::vector<std::vector<std::byte>> channels) {
    if (channels.size() == 1) {
        return std::move(channels.front());
    }
    std::vector<std::byte> result(channels.size() * channels.front().size());
    std::byte* to = result.data();
    for (std::size_t at = 0; at < channels.front().size(); at += sizeof(float)) {
        for (const std::vector<std::byte>& channel : channels) {
            std::memcpy(to, channel.data() + at, sizeof(float));
            to += sizeof(float);
        }
    }
    return result;
}

void follow(Assets& assets, DerivedSource& coefficients, const Source& voxels, int wanted) {
    const Volume& volume = voxels.volume();
    const auto empty = static_cast<float>(voxels.filler());
    const glm::ivec3 dims = volume.grid.dims;
    const int first = wanted == all_channels ? 0 : wanted;
    const int end = wanted == all_channels ? volume.channels : wanted + 1;
    const auto of_each = [&](const auto& make) {
        std::vector<std::vector<std::byte>> made;
        for (int channel = first; channel < end; ++channel) {
            made.push_back(make(channel));
        }
        return interleaved(std::move(made));
    };
    bool everything = true;
    const std::vector<VoxelBox> changed = coefficients.changes(voxels, everything);
    if (everything) {
        coefficients.replace(
            {.grid = volume.grid,
             .type = ScalarType::f32,
             .channels = end - first,
             .voxels = of_each([&](int channel) { return all_coefficients(assets, voxels, channel, empty); }),
             .slope = volume.slope,
             .intercept = volume.intercept,
             .unit = volume.unit,
             .narrowing_error = volume.narrowing_error,
             .source = volume.source});
    }
    for (VoxelBox box : changed) {
        const int ring = volume.grid.shape.wrap_axis();
        if (ring >= 0) {
            box.first[ring] = 0;
            box.size[ring] = dims[ring];
        }
        const VoxelBox reached = grown(box, fade_reach, dims);
        const VoxelBox needed = grown(box, 2 * fade_reach, dims);
        coefficients.update(reached, of_each([&](int channel) {
                                std::vector<float> values = stored_values(volume, channel, needed, empty);
                                // A few voxels: nobody waits.
                                static_cast<void>(make_coefficients(needed.size, values, 0, {}, ring));
                                values = cut_out(values, needed, reached);
                                const auto bytes = std::as_bytes(std::span(values));
                                return std::vector<std::byte>(bytes.begin(), bytes.end());
                            }));
    }
    coefficients.settle(voxels, voxels.statistics);
}

}  // namespace

bool make_coefficients(const glm::ivec3& dims, std::span<float> voxels, int threads, const Progress& progress,
                       int ring) {
    const auto nx = static_cast<std::size_t>(dims.x);
    const auto ny = static_cast<std::size_t>(dims.y);
    const auto nz = static_cast<std::size_t>(dims.z);
    const std::vector<double> along_x = elimination(dims.x);
    const std::vector<double> along_y = elimination(dims.y);
    const std::vector<double> along_z = elimination(dims.z);
    const RingSolver around(ring == 0 ? dims.x : dims.y);
    // The calling thread does the first part, and as fast as it the others do theirs.
    std::atomic<bool> stopped{false};
    const auto goes_on = [&](int begin, int at, int end, double done_before) {
        if (begin == 0 && !stopped && progress && !progress(done_before + 0.5 * at / end)) {
            stopped = true;
        }
        return !stopped;
    };
    in_parts(dims.z, threads, [&](int begin, int end) {
        std::vector<double> plane(nx * ny);
        for (int z = begin; z < end && goes_on(begin, z, end, 0.0); ++z) {
            float* slice = voxels.data() + static_cast<std::size_t>(z) * nx * ny;
            std::copy(slice, slice + nx * ny, plane.begin());
            for (std::size_t y = 0; y < ny; ++y) {
                ring == 0 ? around(1, plane.data() + y * nx) : solve(along_x, 1, plane.data() + y * nx);
            }
            ring == 1 ? around(nx, plane.data()) : solve(along_y, nx, plane.data());
            std::transform(plane.begin(), plane.end(), slice, [](double c) { return static_cast<float>(c); });
        }
    });
    in_parts(dims.y, threads, [&](int begin, int end) {
        std::vector<double> plane(nx * nz);
        for (int y = begin; y < end && goes_on(begin, y, end, 0.5); ++y) {
            const auto row = [&](std::size_t z) {
                return voxels.data() + (z * ny + static_cast<std::size_t>(y)) * nx;
            };
            for (std::size_t z = 0; z < nz; ++z) {
                std::copy(row(z), row(z) + nx, plane.begin() + static_cast<std::ptrdiff_t>(z * nx));
            }
            solve(along_z, nx, plane.data());
            for (std::size_t z = 0; z < nz; ++z) {
                std::transform(plane.data() + z * nx, plane.data() + (z + 1) * nx, row(z),
                               [](double c) { return static_cast<float>(c); });
            }
        }
    });
    return goes_on(0, 1, 1, 0.5);
}

std::shared_ptr<const Source> load_coefficients(Assets& assets, const Source& source, int channel) {
    const std::uint64_t key = Hash().add("coefficients").add(source.key).add(channel).value();
    return load_derived<DerivedSource>(assets, key, source, [&](DerivedSource& coefficients) {
        follow(assets, coefficients, source, channel);
    });
}

}  // namespace viscera::volume
