// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace holdfast {

/// What the headers of a PNG or JPEG file say about its image.
struct ImageStructure {
  enum class Format { png, jpeg };

  Format format = Format::png;
  int width = 0;         ///< [px]
  int height = 0;        ///< [px]
  int channels = 0;      ///< as stored; 3 for a palette image
  int bits = 0;          ///< of a channel; 8 for a palette image
  bool palette = false;  ///< a PNG whose pixels are indices into a palette
  int index_bits = 8;    ///< of such an index
  std::string problem;   ///< why the file cannot be decoded to its end; empty when it can

  /// "640x480, 3 channels of 8 bits".
  std::string to_string() const;
};

/// Walks through a whole PNG (ISO/IEC 15948: signature, chunks with their checksums, IEND) or JPEG file (ITU-T T.81:
/// markers, scans, EOI) without decoding it. The decoding libraries fill what is missing from a truncated file with
/// grey and carry on, or print; this finds it first. Bytes after the end of the image are allowed. Reads nothing but
/// `bytes`.
ImageStructure examine_image(std::span<const std::uint8_t> bytes);

/// A palette PNG of 8 bits that examine_image() found whole, as the grey PNG whose pixels are the indices: the decoding
/// libraries only give the palette's colours, from which an index cannot be told where two entries look alike.
std::vector<std::uint8_t> palette_indices_as_grey(std::span<const std::uint8_t> bytes);

}  // namespace holdfast
