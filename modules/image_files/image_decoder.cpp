// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/image_files/image_decoder.hpp"

#include <cstring>
#include <limits>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "holdfast/core/error.hpp"
#include "holdfast/core/input_file.hpp"
#include "holdfast/core/size_text.hpp"
#include "holdfast/image_files/image_structure.hpp"
#include "jpeg_pixels.hpp"
#include "png_plain.hpp"
#include "png_rows.hpp"

namespace holdfast {

namespace {

void require_decodable(const std::filesystem::path& file, const ImageStructure& image) {
  if (!image.problem.empty())
    throw InputError({file.string()},
                     image.problem + "; expected a complete PNG or JPEG image; copy or download the file again");
  if (!image.has_camera_size())
    throw InputError({file.string()}, "is an image of " + image.to_string() +
                                          "; expected at least one pixel and at most " + ImageStructure::largest());
}

[[noreturn]] void throw_damaged(const std::filesystem::path& file) {
  throw InputError({file.string()}, "is damaged: it cannot be decoded; copy or download the file again");
}

cv::Mat decode(const std::filesystem::path& file, std::span<const std::uint8_t> bytes, int flags, cv::Mat& target) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw InputError({file.string()},
                     "takes too much memory to decode; expected less than 2 GB; make the image smaller");
  cv::Mat image;
  try {
    const cv::Mat input(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<std::uint8_t*>(bytes.data()));
    image = cv::imdecode(input, flags, &target);
  } catch (const cv::Exception& error) {
    throw InputError({file.string()}, "cannot be decoded (" + error.err + "); copy or download the file again");
  }
  if (image.empty()) throw_damaged(file);
  return image;
}

cv::Mat decode_png(const std::filesystem::path& file, std::span<const std::uint8_t> bytes, int flags, cv::Mat& target) {
  const std::optional<std::vector<std::uint8_t>> plain = plain_png(bytes);
  if (!plain) throw_damaged(file);
  return decode(file, *plain, flags, target);
}

/// The decoded pixels as an image that shares their memory; `type` has their number of bytes.
cv::Mat as_image(const PngRows& png, int type) {
  return {png.height(), png.width(), type, const_cast<std::uint8_t*>(png.row(0)), png.bytes_to_next_row()};
}

/// How the 16 bits of a number are stored.
struct BigEndian {
  int operator()(const std::uint8_t* p) const { return p[0] << 8 | p[1]; }
};
struct Native {
  int operator()(const std::uint8_t* p) const {
    std::uint16_t value;
    std::memcpy(&value, p, sizeof(value));
    return value;
  }
};

/// Converts stored 16-bit depth to metres, each the float nearest to the true quotient, hence a division and no
/// multiplication by an inverse. Float arithmetic is exact in this sense where the factor is a float.
template <class Number>
cv::Mat metres(const cv::Mat& stored, Number number, const DepthEncoding& encoding) {
  cv::Mat depth(stored.size(), CV_32FC1);
  const int no_value = encoding.no_value;
  const auto convert = [&](auto factor) {
    for (int y = 0; y < depth.rows; ++y) {
      const auto* from = stored.ptr<std::uint8_t>(y);
      auto* to = depth.ptr<float>(y);
      for (int x = 0; x < depth.cols; ++x) {
        const int value = number(from + 2 * x);
        to[x] = static_cast<float>(static_cast<decltype(factor)>(value == no_value ? 0 : value) / factor);
      }
    }
  };
  if (const auto factor = static_cast<float>(encoding.factor); factor == encoding.factor)
    convert(factor);
  else
    convert(encoding.factor);
  return depth;
}

/// The upper 8 of the 16 bits of stored grey values.
template <class Number>
cv::Mat upper_bytes(const cv::Mat& stored, Number number) {
  cv::Mat grey(stored.size(), CV_8UC1);
  for (int y = 0; y < grey.rows; ++y) {
    const auto* from = stored.ptr<std::uint8_t>(y);
    auto* to = grey.ptr<std::uint8_t>(y);
    for (int x = 0; x < grey.cols; ++x) to[x] = static_cast<std::uint8_t>(number(from + 2 * x) >> 8);
  }
  return grey;
}

}  // namespace

ImageDecoder::ImageDecoder() : png_(std::make_unique<PngRows>()) {}
ImageDecoder::~ImageDecoder() = default;
ImageDecoder::ImageDecoder(ImageDecoder&&) noexcept = default;
ImageDecoder& ImageDecoder::operator=(ImageDecoder&&) noexcept = default;

void ImageDecoder::load(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::not_found)
    throw InputError({file.string()}, "is missing; expected a PNG or JPEG image; complete the recording");
  InputFile(file, largest_file::image, "a PNG or JPEG image").read_rest(bytes_);
}

cv::Mat ImageDecoder::read_colour(const std::filesystem::path& file, const SizeCheck& check_size) {
  load(file);
  const ImageStructure image = examine_image(bytes_);
  require_decodable(file, image);
  if (image.channels != 3 || image.bits != 8)
    throw InputError({file.string()}, "is an image of " + image.to_string() +
                                          "; expected a colour image, 3 channels of 8 bits; convert it");
  if (check_size) check_size({image.width, image.height});
  cv::Mat colour;
  if (image.format == ImageStructure::Format::png) {
    if (!png_->decode(bytes_)) return decode_png(file, bytes_, cv::IMREAD_COLOR, colour);
    cv::cvtColor(as_image(*png_, CV_8UC3), colour, cv::COLOR_RGB2BGR);
    return colour;
  }
  if (!decode_jpeg(bytes_, {image.width, image.height}, colour)) throw_damaged(file);
  return colour;
}

cv::Mat ImageDecoder::decode_grey_or_colour(const std::filesystem::path& file, const SizeCheck& check_size) {
  const ImageStructure image = examine_image(bytes_);
  require_decodable(file, image);
  const bool has_16_bits =
      image.format == ImageStructure::Format::png && image.channels == 1 && image.bits == 16 && accepts_16_bits_;
  if ((image.channels != 1 && image.channels != 3) || (image.bits != 8 && !has_16_bits))
    throw InputError({file.string()}, "is an image of " + image.to_string() +
                                          "; expected a grey or colour image, 1 or 3 channels of 8 bits" +
                                          (accepts_16_bits_ ? ", or 1 channel of 16 bits" : "") + "; convert it");
  if (check_size) check_size({image.width, image.height});
  cv::Mat decoded;
  if (has_16_bits) {
    if (png_->decode(bytes_)) return upper_bytes(as_image(*png_, CV_8UC2), BigEndian());
    return upper_bytes(decode_png(file, bytes_, cv::IMREAD_UNCHANGED, decoded), Native());
  }
  if (image.format == ImageStructure::Format::jpeg) {
    // A grey JPEG comes in three equal channels.
    if (!decode_jpeg(bytes_, {image.width, image.height}, decoded)) throw_damaged(file);
    return decoded;
  }
  if (!png_->decode(bytes_))
    return decode_png(file, bytes_, image.channels == 1 ? cv::IMREAD_GRAYSCALE : cv::IMREAD_COLOR, decoded);
  if (image.channels == 1) return as_image(*png_, CV_8UC1).clone();
  cv::cvtColor(as_image(*png_, CV_8UC3), decoded, cv::COLOR_RGB2BGR);
  return decoded;
}

cv::Mat ImageDecoder::read_grey(const std::filesystem::path& file, const SizeCheck& check_size) {
  load(file);
  const cv::Mat decoded = decode_grey_or_colour(file, check_size);
  if (decoded.channels() == 1) return decoded;
  cv::Mat grey;
  cv::cvtColor(decoded, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

cv::Mat ImageDecoder::read_widened(const std::filesystem::path& file, const SizeCheck& check_size) {
  load(file);
  return decode_widened(file, check_size);
}

cv::Mat ImageDecoder::decode_widened(std::span<const std::uint8_t> bytes, const std::string& name,
                                     const SizeCheck& check_size) {
  bytes_.assign(bytes.begin(), bytes.end());
  return decode_widened(std::filesystem::path(name), check_size);
}

cv::Mat ImageDecoder::decode_widened(const std::filesystem::path& file, const SizeCheck& check_size) {
  const cv::Mat decoded = decode_grey_or_colour(file, check_size);
  if (decoded.channels() == 3) return decoded;
  cv::Mat colour;
  cv::cvtColor(decoded, colour, cv::COLOR_GRAY2BGR);
  return colour;
}

cv::Mat ImageDecoder::read_depth(const std::filesystem::path& file, const DepthEncoding& encoding,
                                 const SizeCheck& check_size) {
  load(file);
  return decode_depth(file, encoding, check_size);
}

cv::Mat ImageDecoder::decode_depth(std::span<const std::uint8_t> bytes, const std::string& name,
                                   const DepthEncoding& encoding, const SizeCheck& check_size) {
  bytes_.assign(bytes.begin(), bytes.end());
  return decode_depth(std::filesystem::path(name), encoding, check_size);
}

cv::Mat ImageDecoder::decode_depth(const std::filesystem::path& file, const DepthEncoding& encoding,
                                   const SizeCheck& check_size) {
  const ImageStructure image = examine_image(bytes_);
  require_decodable(file, image);
  if (image.format != ImageStructure::Format::png || image.channels != 1 || image.bits != 16)
    throw InputError({file.string()}, std::string("is a ") +
                                          (image.format == ImageStructure::Format::png ? "PNG" : "JPEG") +
                                          " image of " + image.to_string() +
                                          "; expected a depth image, a PNG of 1 channel of 16 bits; export the depth "
                                          "without conversion");
  if (check_size) check_size({image.width, image.height});
  if (png_->decode(bytes_)) return metres(as_image(*png_, CV_8UC2), BigEndian(), encoding);
  raw_depth_ = decode_png(file, bytes_, cv::IMREAD_UNCHANGED, raw_depth_);
  return metres(raw_depth_, Native(), encoding);
}

cv::Mat ImageDecoder::read_labels(const std::filesystem::path& file, const SizeCheck& check_size) {
  load(file);
  const ImageStructure image = examine_image(bytes_);
  require_decodable(file, image);
  const bool is_png = image.format == ImageStructure::Format::png;
  const bool is_indexed = image.palette && image.index_bits == 8;
  const bool is_grey = image.channels == 1 && (image.bits == 8 || image.bits == 16);
  if (!is_png || !(is_indexed || is_grey))
    throw InputError(
        {file.string()},
        std::string("is a ") + (is_png ? "PNG" : "JPEG") + " image of " +
            (image.palette ? size_text(image.width, image.height) + ", indices of " + std::to_string(image.index_bits) +
                                 (image.index_bits == 1 ? " bit" : " bits") + " into a palette"
                           : image.to_string()) +
            "; expected a label image, a PNG of 1 channel of 8 or 16 bits, or with a palette of 8 bits; "
            "convert it without changing its values");
  if (check_size) check_size({image.width, image.height});
  if (is_indexed) bytes_ = palette_indices_as_grey(bytes_);
  cv::Mat labels;
  return decode_png(file, bytes_, cv::IMREAD_UNCHANGED, labels);
}

}  // namespace holdfast
