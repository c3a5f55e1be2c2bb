#include "engine/io/volume_itk.h"

#include <gdcmTrace.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace viscera::io {

namespace {

itk::ImageIOBase::Pointer make_io(ItkFormat format) {
    switch (format) {
        case ItkFormat::meta:
            return itk::MetaImageIO::New().GetPointer();
        case ItkFormat::nifti:
            return itk::NiftiImageIO::New().GetPointer();
        case ItkFormat::nrrd:
            return itk::NrrdImageIO::New().GetPointer();
    }
    throw std::runtime_error("is of no format that ITK reads");
}

itk::ImageIOBase::Pointer open(ItkFormat format, const std::filesystem::path& file) {
    const itk::ImageIOBase::Pointer io = make_io(format);
    io->SetFileName(file.string());
    io->ReadImageInformation();
    return io;
}

/// Unit columns, their lengths moved into the spacing unless they are rounding.
void normalise(VolumeGrid& grid) {
    constexpr double rounding = 1e-4;
    for (int axis = 0; axis < 3; ++axis) {
        const double length = glm::length(grid.direction[axis]);
        if (length > 0.0 && std::isfinite(length)) {
            grid.direction[axis] /= length;
            grid.spacing_mm[axis] *= std::abs(length - 1.0) < rounding ? 1.0 : length;
        }
    }
}

ItkHeader header_of(const itk::ImageIOBase& io) {
    ItkHeader header;
    const unsigned int axes = io.GetNumberOfDimensions();
    for (unsigned int axis = 0; axis < axes; ++axis) {
        header.dims.push_back(io.GetDimensions(axis));
    }
    const unsigned int spatial = std::min(axes, 3U);
    for (unsigned int axis = 0; axis < spatial; ++axis) {
        const auto a = static_cast<int>(axis);
        header.grid.spacing_mm[a] = io.GetSpacing(axis);
        header.grid.origin_mm[a] = io.GetOrigin(axis);
        const std::vector<double> column = io.GetDirection(axis);
        for (unsigned int row = 0; row < spatial && row < column.size(); ++row) {
            header.grid.direction[a][static_cast<int>(row)] = column[row];
        }
    }
    normalise(header.grid);
    header.components = static_cast<int>(io.GetNumberOfComponents());
    return header;
}

}  // namespace

QuietItk::QuietItk()
    : itk_warns_(itk::Object::GetGlobalWarningDisplay()),
      gdcm_warns_(gdcm::Trace::GetWarningFlag()),
      gdcm_tells_errors_(gdcm::Trace::GetErrorFlag()) {
    itk::Object::GlobalWarningDisplayOff();
    gdcm::Trace::WarningOff();
    gdcm::Trace::ErrorOff();
}

QuietItk::~QuietItk() {
    itk::Object::SetGlobalWarningDisplay(itk_warns_);
    gdcm::Trace::SetWarning(gdcm_warns_);
    gdcm::Trace::SetError(gdcm_tells_errors_);
}

std::string words_of(const std::exception& error) {
    const auto* const of_itk = dynamic_cast<const itk::ExceptionObject*>(&error);
    std::string text = of_itk == nullptr ? error.what() : of_itk->GetDescription();
    if (const std::size_t place = text.find("): "); text.starts_with("ITK ERROR") && place != text.npos) {
        text.erase(0, place + 3);
    }
    std::ranges::replace(text, '\n', ' ');
    return text.substr(0, text.find_last_not_of(' ') + 1);
}

ItkHeader read_itk_header(ItkFormat format, const std::filesystem::path& file) {
    const QuietItk quiet;
    try {
        return header_of(*open(format, file));
    } catch (const itk::ExceptionObject& error) {
        throw std::runtime_error(words_of(error));
    }
}

std::vector<std::byte> read_itk_voxels(ItkFormat format, const VolumeHead& head, const Reading& reading) {
    const QuietItk quiet;
    try {
        const itk::ImageIOBase::Pointer io = open(format, reading.file);
        itk::ImageIORegion region(io->GetNumberOfDimensions());
        for (unsigned int axis = 0; axis < io->GetNumberOfDimensions(); ++axis) {
            region.SetSize(axis, io->GetDimensions(axis));
        }
        io->SetIORegion(region);
        const auto size = static_cast<std::uint64_t>(io->GetImageSizeInBytes());
        if (size < head.bytes(reading)) {
            reading.fail("has a header that contradicts itself");
        }
        std::vector<std::byte> voxels(size);
        io->Read(voxels.data());
        return voxels;
    } catch (const itk::ExceptionObject& error) {
        reading.fail(words_of(error));
    } catch (const std::bad_alloc&) {
        reading.fail("asks for more memory than there is");
    }
}

VolumeGrid grid_of_affine(const glm::dmat4& index_to_world, const glm::ivec3& dims) {
    VolumeGrid grid{.dims = dims, .spacing_mm = {}, .origin_mm = glm::dvec3(index_to_world[3])};
    for (int axis = 0; axis < 3; ++axis) {
        const glm::dvec3 column(index_to_world[axis]);
        grid.spacing_mm[axis] = glm::length(column);
        grid.direction[axis] = column / grid.spacing_mm[axis];
    }
    return grid;
}

}  // namespace viscera::io
