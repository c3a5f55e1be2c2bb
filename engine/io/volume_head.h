#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "engine/io/volume.h"

namespace viscera::io {

/// How a number lies in a file; narrowed to a ScalarType in memory.
enum class FileScalar { u8, i8, u16, i16, u32, i32, u64, i64, f32, f64 };
[[nodiscard]] std::size_t bytes_of(FileScalar type);

/// What one call of load_volume works on. `file` is what the caller named, and what every error names.
struct Reading {
    const std::filesystem::path& file;
    const VolumeOptions& options;
    Log& log;

    [[noreturn]] void fail(const std::string& message) const;
    /// Tells the host how far the work is. Throws Error(usage) "cancelled".
    void progress(double fraction) const;
};

/// What the header of a file says.
struct VolumeHead {
    Volume volume;  ///< all but type and voxels
    FileScalar type = FileScalar::u8;
    bool big_endian = false;
    bool planar = false;  ///< channels one after another, each a volume, rather than beside each other

    [[nodiscard]] std::uint64_t voxel_bytes() const;
    /// Bytes of the voxels in the file, unpacked. Throws Error(file) for a grid or channels that do not hold.
    [[nodiscard]] std::uint64_t bytes(const Reading& reading) const;
};

/// Fills the span with the next bytes of the voxels, or throws.
using ReadBytes = std::function<void(std::span<std::byte>)>;

enum class Packing { none, zlib };  ///< zlib: zlib or gzip, told apart by their first bytes

/// Where the voxels lie.
struct Payload {
    std::filesystem::path file;
    std::uint64_t offset = 0;
    Packing packing = Packing::none;
};

/// Bytes of a payload in order. Throws Error(file) at once when the file cannot hold `due` bytes from its
/// offset on, so that nothing is allocated for a size that is a lie.
[[nodiscard]] ReadBytes open_payload(const Payload& payload, std::uint64_t due, const Reading& reading);
/// Bytes that are in memory already; they must outlive the reader.
[[nodiscard]] ReadBytes read_from_memory(std::span<const std::byte> bytes, const Reading& reading);

/// Bytes of slices that are made one by one, each when its turn comes.
[[nodiscard]] ReadBytes read_slice_by_slice(
    std::function<std::vector<std::byte>(std::size_t slice)> make_slice);

/// Numbers as the bytes of a file of that type, native order. Throws Error(file) for numbers beyond its
/// range.
[[nodiscard]] std::vector<std::byte> encode(std::span<const double> numbers, FileScalar type,
                                            const Reading& reading);

/// Size of a regular file. Throws Error(file) naming reading.file when it is missing.
[[nodiscard]] std::uint64_t size_of(const std::filesystem::path& file, const Reading& reading);

/// Reads the voxels slab by slab: swapped, narrowed and reduced on the way. Throws Error(limit) before it
/// allocates when memory does not suffice.
[[nodiscard]] Volume read_voxels(VolumeHead head, const ReadBytes& read, const Reading& reading);

/// Bytes of memory that reading may take: the option, or what the machine has available now.
[[nodiscard]] std::uint64_t memory_of(const Reading& reading);

/// Throws Error(limit) when a volume of this head does not fit into memory, reduced as the options say;
/// `beside` are bytes that reading takes on top of it.
void require_memory(const VolumeHead& head, std::uint64_t beside, const Reading& reading);

}  // namespace viscera::io
