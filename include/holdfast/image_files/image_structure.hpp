// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace holdfast {

/// Properties of an image from the headers of its PNG or JPEG file.
struct ImageStructure {
  enum class Format { png, jpeg };

  Format format = Format::png;
  int width = 0;         ///< [px]
  int height = 0;        ///< [px]
  int channels = 0;      ///< as stored; 3 for a palette image
  int bits = 0;          ///< of a channel; 8 for a palette image
  bool palette = false;  ///< a PNG whose pixels are indices into a palette
  int index_bits = 8;    ///< of such an index
  std::string problem;   ///< the reason why the file cannot be decoded completely; empty if it can

  /// Description such as "640x480, 3 channels of 8 bits".
  std::string to_string() const;

  /// Whether a camera may have taken the image: it has pixels, and not more than largest(). A small file can hold an
  /// image that takes gigabytes when it is decoded.
  bool has_camera_size() const;
  /// "32768 pixels in width and height, and 100 million pixels".
  static std::string largest();
};

/// Checks the structure of a complete PNG (ISO/IEC 15948: signature, chunks with their checksums, IEND) or JPEG file
/// (ITU-T T.81: markers, scans, EOI) without decoding it. This detects truncated files, which the decoding libraries
/// fill with grey, or for which they print messages. Bytes after the end of the image are allowed. Only `bytes` are
/// read.
ImageStructure examine_image(std::span<const std::uint8_t> bytes);

/// Examines only the begin and the end of a PNG or JPEG file, which detects truncated files and gives the size of the
/// image; damage between them is not detected. If the end marker is not found, the whole file is examined. Throws
/// InputError if the file cannot be read.
ImageStructure examine_image_ends(const std::filesystem::path& file);

/// Removes data that do not affect the pixels from a PNG accepted by examine_image(): ancillary chunks (colour profile,
/// background, text, times), a suggested palette, bytes after the end. Otherwise the decoding library prints messages,
/// for instance about faulty profiles. JPEG files are not changed.
void drop_png_annotations(std::vector<std::uint8_t>& bytes);

/// Converts an 8-bit palette PNG that examine_image() accepted to a grey PNG whose pixels are the indices, because the
/// decoding libraries only provide the palette's colours, which are ambiguous for identical entries.
std::vector<std::uint8_t> palette_indices_as_grey(std::span<const std::uint8_t> bytes);

}  // namespace holdfast
